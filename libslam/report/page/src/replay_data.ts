/** As page_replay.cpp writes it. Metres, radians, seconds since the first scan; frames as on the maps. */
interface Packed {
  name: string;
  group: number;
  window: [number, number, number, number];
  times: string;
  ground: string;
  truth?: string;
  scan?: { first: number; step: number; beams: number; mount: [number, number, number]; ranges: string };
  operations?: string[];
  runs: {
    name: string;
    colour: string;
    map: string;
    poses: string;
    online?: string;
    events: [number, string, number | null, number | null, number | null][];
  }[];
  goals: [number, number | null, number | null][];
  moments: [number, string, string, number | null, number | null][];
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
  /** The final one. */
  path: Path;
  /** As it was given at the time, where that differs. */
  online: Path | null;
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

/** Something that happened, to a method or (run null) to the robot. */
export interface Happening {
  time_s: number;
  run: Run | null;
  what: string;
  detail: string;
  place: [number, number] | null;
}

export interface Replay {
  name: string;
  /** Of the maps that show it. */
  group: number;
  window: { x0: number; y0: number; x1: number; y1: number };
  times: Float32Array;
  ground: string;
  truth: Path | null;
  scans: Scans | null;
  /** What the robot did before each scan, as in the operation log; "" for nothing. */
  operations: string[];
  runs: Run[];
  goals: [number, number | null, number | null][];
  /** In time. */
  happenings: Happening[];
}

const kNoReturnCode = 65534;
const kUsualShare = 0.98;

function bytesOf(base64: string): Uint8Array {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

function floatsOf(base64: string): Float32Array {
  const bytes = bytesOf(base64);
  const view = new DataView(bytes.buffer);
  return Float32Array.from({ length: bytes.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
}

function scansOf(packed: NonNullable<Packed["scan"]>): Scans {
  const bytes = bytesOf(packed.ranges);
  const code = (index: number): number => bytes[2 * index] | (bytes[2 * index + 1] << 8);
  const returns = Uint16Array.from({ length: bytes.length / 2 }, (_, i) => code(i)).filter((value) => value < kNoReturnCode);
  returns.sort();
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

function placeOf(x: number | null, y: number | null): [number, number] | null {
  return x === null || y === null ? null : [x, y];
}

function replayOf(packed: Packed): Replay {
  const [x0, y0, x1, y1] = packed.window;
  const happenings: Happening[] = packed.moments.map(([time_s, what, detail, x, y]) => ({
    time_s,
    run: null,
    what,
    detail,
    place: placeOf(x, y),
  }));
  const runs = packed.runs.map(({ name, colour, map, poses, online, events }) => {
    const path = new Path(floatsOf(poses));
    const run: Run = { name, colour, map, path, online: online === undefined ? null : new Path(floatsOf(online)) };
    for (const [time_s, what, value, x, y] of events)
      happenings.push({ time_s, run, what, detail: value ? String(Number(value.toPrecision(3))) : "", place: placeOf(x, y) });
    return run;
  });
  happenings.sort((a, b) => a.time_s - b.time_s);
  return {
    name: packed.name,
    group: packed.group,
    window: { x0, y0, x1, y1 },
    times: floatsOf(packed.times),
    ground: packed.ground,
    truth: packed.truth === undefined ? null : new Path(floatsOf(packed.truth)),
    scans: packed.scan === undefined || packed.scan.beams === 0 ? null : scansOf(packed.scan),
    operations: packed.operations ?? [],
    runs,
    goals: packed.goals,
    happenings,
  };
}

/** The names of all replays; each is unpacked when it is asked for. */
export class Replays {
  private readonly unpacked = new Map<number, Replay>();
  constructor(private readonly packed: Packed[]) {}
  get names(): string[] {
    return this.packed.map(({ name }) => name);
  }
  at(index: number): Replay {
    const there = this.unpacked.get(index);
    if (there) return there;
    const replay = replayOf(this.packed[index]);
    this.unpacked.set(index, replay);
    return replay;
  }
}

export function readReplays(): Replays | null {
  const text = document.getElementById("replay-data")?.textContent;
  return text ? new Replays(JSON.parse(text) as Packed[]) : null;
}

/** The places that a pose sees with the beams of a scan, and from where. */
export function originOf(scans: Scans, pose: Pose): Pose {
  const [mountX, mountY, mountYaw] = scans.mount;
  return {
    x: pose.x + Math.cos(pose.yaw) * mountX - Math.sin(pose.yaw) * mountY,
    y: pose.y + Math.sin(pose.yaw) * mountX + Math.cos(pose.yaw) * mountY,
    yaw: pose.yaw + mountYaw,
  };
}

export function* returnsOf(scans: Scans, index: number, pose: Pose): Generator<[number, number]> {
  const origin = originOf(scans, pose);
  for (let beam = 0; beam < scans.beams; ++beam) {
    const range = scans.range(index, beam);
    if (Number.isNaN(range)) continue;
    const angle = origin.yaw + scans.first + beam * scans.step;
    yield [origin.x + range * Math.cos(angle), origin.y + range * Math.sin(angle)];
  }
}
