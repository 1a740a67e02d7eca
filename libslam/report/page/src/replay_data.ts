/** As toHtml() writes it (html_report.cpp). Metres, radians, seconds since the first scan; frames as on the maps. */
interface Packed {
  window: [number, number, number, number];
  times: string;
  ground: string;
  truth?: string;
  scan?: { first: number; step: number; beams: number; allBeams: number; mount: [number, number, number]; ranges: string };
  runs: { name: string; colour: string; map: string; poses: string; events: [number, string, number, number][] }[];
  goals: [number, number | null, number | null][];
}

export interface Pose {
  x: number;
  y: number;
  yaw: number;
}

/** Poses of all times, x, y and yaw each; NaN where there is none. */
export class Path {
  constructor(private readonly numbers: Float32Array) {}
  at(index: number): Pose | null {
    const [x, y, yaw] = this.numbers.subarray(3 * index, 3 * index + 3);
    return Number.isNaN(x) ? null : { x, y, yaw };
  }
}

export interface Run {
  name: string;
  colour: string;
  map: string;
  path: Path;
  events: [number, string, number, number][];
}

export interface Scans {
  first: number;
  step: number;
  beams: number;
  mount: [number, number, number];
  /** Metres; most returns are nearer: what charts show; a multiple of 4. */
  usual: number;
  /** Metres; NaN: no return or lost. */
  range(scan: number, beam: number): number;
}

export interface Replay {
  window: { x0: number; y0: number; x1: number; y1: number };
  times: Float32Array;
  ground: string;
  truth: Path | null;
  scans: Scans | null;
  runs: Run[];
  goals: [number, number | null, number | null][];
}

const kNoReturnCode = 65534;
const kUsualShare = 0.98;

function bytesOf(base64: string): Uint8Array {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

function floatsOf(base64: string): Float32Array {
  const bytes = bytesOf(base64);
  const view = new DataView(bytes.buffer);
  return Float32Array.from({ length: bytes.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
}

function scansOf(packed: NonNullable<Packed["scan"]>): Scans {
  const bytes = bytesOf(packed.ranges);
  const code = (index: number): number => bytes[2 * index] | (bytes[2 * index + 1] << 8);
  const returns = Array.from({ length: bytes.length / 2 }, (_, i) => code(i)).filter((value) => value < kNoReturnCode);
  returns.sort((a, b) => a - b);
  return {
    first: packed.first,
    step: packed.step,
    beams: packed.beams,
    mount: packed.mount,
    usual: 4 * Math.max(1, Math.ceil((returns[Math.floor(kUsualShare * returns.length)] ?? 0) / 400)),
    range(scan, beam) {
      const value = code(scan * packed.beams + beam);
      return value >= kNoReturnCode ? NaN : value / 100;
    },
  };
}

export function readReplay(): Replay | null {
  const text = document.getElementById("replay-data")?.textContent;
  if (!text) return null;
  const packed = JSON.parse(text) as Packed;
  const [x0, y0, x1, y1] = packed.window;
  return {
    window: { x0, y0, x1, y1 },
    times: floatsOf(packed.times),
    ground: packed.ground,
    truth: packed.truth === undefined ? null : new Path(floatsOf(packed.truth)),
    scans: packed.scan === undefined ? null : scansOf(packed.scan),
    runs: packed.runs.map(({ poses, ...run }) => ({ ...run, path: new Path(floatsOf(poses)) })),
    goals: packed.goals,
  };
}
