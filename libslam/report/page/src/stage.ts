import { make } from "./dom";
import { GrowingMap } from "./growing_map";
import { returnsOf, type Path, type Pose, type Replay, type Run } from "./replay_data";

export const kTruth = { name: "truth", colour: "#a5a5a5" };

/** Colours of the page's own theme, for canvases. */
export function themeColour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** A method's colour, seen on the page's ground: the palette's last is black. */
export function visible(colour: string, dark: boolean): string {
  return dark && colour === "#000000" ? "#ffffff" : colour;
}

/** Sized for the screen's pixels and cleared; units are those of the page. */
export function prepare(canvas: HTMLCanvasElement, aspect: number): CanvasRenderingContext2D {
  const scale = window.devicePixelRatio || 1;
  const width = Math.max(1, Math.round(canvas.clientWidth * scale));
  const height = Math.max(1, Math.round(width * aspect));
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  const context = canvas.getContext("2d")!;
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width / scale, height / scale);
  return context;
}

/** A picture of the page, light or dark as the page is. */
async function loadPicture(id: string, dark: boolean): Promise<HTMLCanvasElement | null> {
  const source = document.getElementById(id)?.getAttribute("href");
  if (!source) return null;
  const image = new Image();
  image.src = source;
  await image.decode();
  const canvas = make("canvas");
  canvas.width = image.width;
  canvas.height = image.height;
  const context = canvas.getContext("2d")!;
  context.drawImage(image, 0, 0);
  if (dark) {
    context.globalCompositeOperation = "difference";
    context.fillStyle = "#e8e8e8";
    context.fillRect(0, 0, canvas.width, canvas.height);
  }
  return canvas;
}

/** What may lie under the paths. */
export interface Ground {
  label: string;
  picture?: string; // an id of the page
  grows?: Path; // the map that the scans so far give from these poses
}

/** All grounds of a replay, the one to begin with first. */
export function groundsOf(replay: Replay): Ground[] {
  const grounds: Ground[] = [];
  if (replay.scans) {
    for (const run of replay.runs) {
      if (run.online) grounds.push({ label: `the map so far, placed as ${run.name} had it then`, grows: run.online });
      const how = run.online ? "has it finally" : "has it";
      grounds.push({ label: `the map so far, placed as ${run.name} ${how}`, grows: run.path });
    }
    if (replay.truth) grounds.push({ label: "the map so far, placed by the truth", grows: replay.truth });
  }
  const pictures: Ground[] = [];
  if (replay.ground.startsWith("plan")) pictures.push({ label: "the true plan", picture: replay.ground });
  for (const run of replay.runs) if (run.map) pictures.push({ label: `the final map of ${run.name}`, picture: run.map });
  // Who explores sees what the robot knew when it chose its goal.
  const all = replay.goals.length > 0 ? [...grounds, ...pictures] : [...pictures, ...grounds];
  return [...all, { label: "nothing" }];
}

export interface Shown {
  index: number;
  ground: Ground;
  runs: Set<Run>;
  truth: boolean;
  scan: boolean;
  scanFrom: Run | null;
  events: boolean;
  goal: boolean;
}

/** The robot on the map: paths so far, the scan, the goal, what happened where. */
export class Stage {
  readonly canvas = make("canvas", { class: "replay-map", role: "img", "aria-label": "The robot on the map" });
  private pictures = new Map<string, HTMLCanvasElement | null>();
  private growing: GrowingMap | null = null;

  constructor(private readonly replay: Replay) {}

  async load(dark: boolean): Promise<void> {
    const ids = new Set([this.replay.ground, ...this.replay.runs.map((run) => run.map)].filter((id) => id !== ""));
    for (const id of ids) this.pictures.set(id, await loadPicture(id, dark));
  }

  trueOrFirst(index: number): Pose | null {
    return this.replay.truth?.at(index) ?? this.replay.runs[0]?.path.at(index) ?? null;
  }

  goalAt(time_s: number): [number, number] | null {
    let goal: [number, number] | null = null;
    for (const [from_s, x, y] of this.replay.goals) {
      if (from_s > time_s + 1e-3) break;
      goal = x === null || y === null ? null : [x, y];
    }
    return goal;
  }

  draw(shown: Shown, dark: boolean): void {
    const { replay } = this;
    const { x0, y0, x1, y1 } = replay.window;
    const context = prepare(this.canvas, (y1 - y0) / (x1 - x0));
    const width = this.canvas.clientWidth;
    const scale = width / (x1 - x0);
    const px = (x: number): number => (x - x0) * scale;
    const py = (y: number): number => (y1 - y) * scale;
    const time_s = replay.times[shown.index];
    context.imageSmoothingEnabled = false;
    const picture = this.pictureOf(shown, dark);
    if (picture) context.drawImage(picture, 0, 0, width, (y1 - y0) * scale);

    const scanPose = shown.scanFrom ? shown.scanFrom.path.at(shown.index) : this.trueOrFirst(shown.index);
    if (shown.scan && replay.scans && scanPose) {
      context.fillStyle = dark ? "#ff9d6e" : "#d55e00";
      for (const [x, y] of returnsOf(replay.scans, shown.index, scanPose)) context.fillRect(px(x) - 1.5, py(y) - 1.5, 3, 3);
    }
    const trail = (path: Path, colour: string, lineWidth: number): void => {
      context.strokeStyle = colour;
      context.lineWidth = lineWidth;
      context.lineJoin = "round";
      context.beginPath();
      let open = false;
      for (let i = 0; i <= shown.index; ++i) {
        const pose = path.at(i);
        if (pose && open) context.lineTo(px(pose.x), py(pose.y));
        else if (pose) context.moveTo(px(pose.x), py(pose.y));
        open = pose !== null;
      }
      context.stroke();
    };
    const robot = (pose: Pose | null, colour: string): void => {
      if (!pose) return;
      // The original sign: a square within its circle, with its heading.
      context.save();
      context.translate(px(pose.x), py(pose.y));
      context.rotate(-pose.yaw);
      context.strokeStyle = themeColour("ink");
      context.fillStyle = colour;
      context.lineWidth = 1.5;
      const radius = Math.max(7, 0.25 * scale);
      const half = radius / Math.SQRT2;
      context.beginPath();
      context.arc(0, 0, radius, 0, 2 * Math.PI);
      context.stroke();
      context.beginPath();
      context.rect(-half, -half, 2 * half, 2 * half);
      context.fill();
      context.stroke();
      context.beginPath();
      context.moveTo(0, 0);
      context.lineTo(1.6 * radius, 0);
      context.stroke();
      context.restore();
    };
    const { truth } = replay;
    if (truth && shown.truth) trail(truth, kTruth.colour, 5);
    // The best lies on top.
    const runs = replay.runs.filter((run) => shown.runs.has(run)).reverse();
    for (const run of runs) trail(run.path, visible(run.colour, dark), 2);
    if (shown.events) this.drawHappenings(context, shown, px, py, dark);
    if (truth && shown.truth) robot(truth.at(shown.index), kTruth.colour);
    for (const run of runs) robot(run.path.at(shown.index), visible(run.colour, dark));
    const goal = shown.goal ? this.goalAt(time_s) : null;
    if (goal) {
      context.strokeStyle = themeColour("failure");
      context.lineWidth = 3;
      const [x, y] = [px(goal[0]), py(goal[1])];
      context.beginPath();
      context.moveTo(x + 9, y);
      context.arc(x, y, 9, 0, 2 * Math.PI);
      context.moveTo(x - 14, y);
      context.lineTo(x + 14, y);
      context.moveTo(x, y - 14);
      context.lineTo(x, y + 14);
      context.stroke();
    }
  }

  private pictureOf({ ground, index }: Shown, dark: boolean): HTMLCanvasElement | null {
    if (ground.picture) return this.pictures.get(ground.picture) ?? null;
    if (!ground.grows) return null;
    if (this.growing?.path !== ground.grows) this.growing = new GrowingMap(this.replay, ground.grows);
    return this.growing.at(index, dark);
  }

  /** Loops, losses and collisions until now, where they happened. */
  private drawHappenings(
    context: CanvasRenderingContext2D,
    shown: Shown,
    px: (x: number) => number,
    py: (y: number) => number,
    dark: boolean,
  ): void {
    const time_s = this.replay.times[shown.index];
    context.lineWidth = 2;
    for (const { time_s: at_s, run, what, place } of this.replay.happenings) {
      if (at_s > time_s + 1e-3) break;
      if (!isWeighty(what) || !place || (run && !shown.runs.has(run))) continue;
      const [x, y] = [px(place[0]), py(place[1])];
      context.strokeStyle = run ? visible(run.colour, dark) : themeColour("failure");
      context.beginPath();
      if (what === "accepted") context.arc(x, y, 6, 0, 2 * Math.PI);
      else {
        context.moveTo(x - 5, y - 5);
        context.lineTo(x + 5, y + 5);
        context.moveTo(x + 5, y - 5);
        context.lineTo(x - 5, y + 5);
      }
      context.stroke();
    }
  }
}

/** What a reader looks for first. */
export function isWeighty(what: string): boolean {
  return ["accepted", "lost", "recovered", "collision"].includes(what);
}
