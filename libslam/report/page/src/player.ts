import { button, make, makeSvg } from "./dom";
import type { Pose, Replay, Run } from "./replay_data";

const kTruth = { name: "truth", colour: "#a5a5a5" };
const kSpeeds = [1, 2, 5, 10, 20, 50];
const kGrowing = "growing";

/** Colours of the page's own theme, for canvases. */
function themeColour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

function prepare(canvas: HTMLCanvasElement, aspect: number): CanvasRenderingContext2D {
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

/** The places that a pose sees with the beams of a scan. */
function* returnsOf(replay: Replay, index: number, pose: Pose): Generator<[number, number]> {
  const { scans } = replay;
  if (!scans) return;
  const [mountX, mountY, mountYaw] = scans.mount;
  const x = pose.x + Math.cos(pose.yaw) * mountX - Math.sin(pose.yaw) * mountY;
  const y = pose.y + Math.sin(pose.yaw) * mountX + Math.cos(pose.yaw) * mountY;
  for (let beam = 0; beam < scans.beams; ++beam) {
    const range = scans.range(index, beam);
    if (Number.isNaN(range)) continue;
    const angle = pose.yaw + mountYaw + scans.first + beam * scans.step;
    yield [x + range * Math.cos(angle), y + range * Math.sin(angle)];
  }
}

export class Player {
  private index = 0;
  private playing = false;
  private lastFrame_ms = 0;
  private time_s = 0;
  private shownRuns: Set<Run>;
  private showTruth = true;
  private showScan = true;
  private scanFrom: Run | null;
  private background: string;
  private pictures = new Map<string, HTMLCanvasElement | null>();
  private growing: { canvas: HTMLCanvasElement; run: Run; drawn: number } | null = null;
  private dark = matchMedia("(prefers-color-scheme: dark)");

  private readonly map = make("canvas", { class: "replay-map", role: "img", "aria-label": "The robot on the map" });
  private readonly chart = make("canvas", {
    class: "scan-chart",
    role: "img",
    "aria-label": "The scan: range over angle",
  });
  private readonly polar = make("canvas", {
    class: "scan-polar",
    role: "img",
    "aria-label": "The scan from above, ahead up",
  });
  private readonly slider = make("input", { type: "range", min: "0", step: "1", "aria-label": "Scan" });
  private readonly output = make("output", { "aria-live": "off" });
  private readonly poses = make("p", { class: "note poses" });
  private readonly playButton = button("Play", "Play or pause (space)", () => this.toggle());
  private readonly speed = make("select", { "aria-label": "Speed" });
  private readonly cursors: { chart: SVGSVGElement; line: SVGLineElement }[] = [];
  private readonly marks: SVGCircleElement[] = [];

  constructor(
    private readonly replay: Replay,
    private readonly root: HTMLElement,
  ) {
    this.shownRuns = new Set(replay.runs);
    this.scanFrom = replay.truth ? null : (replay.runs[0] ?? null);
    this.background = replay.ground;
    this.slider.max = String(replay.times.length - 1);
    this.build();
    this.joinCharts();
    this.joinMaps();
    this.listen();
    void this.load();
    this.readAddress();
  }

  // --- controls

  private build(): void {
    for (const speed of kSpeeds) this.speed.append(make("option", { value: String(speed) }, `${speed} x`));
    this.speed.value = "10";
    const transport = make(
      "div",
      { class: "bar" },
      button("Start", "To the start (Home)", () => this.show(0)),
      button("◀", "One scan back (left arrow)", () => this.step(-1)),
      this.playButton,
      button("▶", "One scan on (right arrow)", () => this.step(1)),
      make("label", {}, "Speed ", this.speed),
      this.slider,
      this.output,
    );
    const views = make(
      "div",
      { class: "views" },
      this.map,
      ...(this.replay.scans ? [make("div", { class: "scans" }, this.chart, this.polar)] : []),
    );
    this.root.append(transport, views, this.poses, this.choices());
    this.root.append(
      make(
        "p",
        { class: "note" },
        "Keys: space plays, the arrows step (with shift by ten), Home and End. The page's address keeps the moment, as in #t=83.2.",
      ),
    );
  }

  private choices(): HTMLElement {
    const shown = make("fieldset", {}, make("legend", {}, "Show"));
    const addBox = (name: string, colour: string | null, onChange: (on: boolean) => void): void => {
      const box = make("input", { type: "checkbox" });
      box.checked = true;
      box.addEventListener("change", () => {
        onChange(box.checked);
        this.draw();
      });
      const label = make("label", {}, box);
      if (colour) {
        const swatch = makeSvg("svg", { class: "swatch", viewBox: "0 0 10 10", "aria-hidden": "true" });
        swatch.append(makeSvg("rect", { width: "10", height: "10", fill: colour }));
        label.append(swatch);
      }
      label.append(name);
      shown.append(label);
    };
    if (this.replay.truth) addBox(kTruth.name, kTruth.colour, (on) => (this.showTruth = on));
    for (const run of this.replay.runs)
      addBox(run.name, run.colour, (on) => (on ? this.shownRuns.add(run) : this.shownRuns.delete(run)));
    if (this.replay.scans) addBox("scan", null, (on) => (this.showScan = on));
    return make("div", { class: "bar" }, shown, this.backgroundChoice(), ...(this.replay.scans ? [this.scanChoice()] : []));
  }

  private backgroundChoice(): HTMLElement {
    const select = make("select");
    if (this.replay.ground === "plan") select.append(make("option", { value: "plan" }, "the true plan"));
    for (const run of this.replay.runs)
      if (run.map) select.append(make("option", { value: run.map }, `the final map of ${run.name}`));
    if (this.replay.scans)
      for (const run of this.replay.runs)
        select.append(make("option", { value: `${kGrowing}:${run.name}` }, `the scans so far, placed by ${run.name}`));
    select.append(make("option", { value: "" }, "nothing"));
    select.value = this.background;
    select.addEventListener("change", () => {
      this.background = select.value;
      this.draw();
    });
    return make("label", {}, "Under it ", select);
  }

  private scanChoice(): HTMLElement {
    const select = make("select");
    if (this.replay.truth) select.append(make("option", { value: "" }, "where the robot is"));
    for (const run of this.replay.runs) select.append(make("option", { value: run.name }, `where ${run.name} is`));
    select.addEventListener("change", () => {
      this.scanFrom = this.replay.runs.find((run) => run.name === select.value) ?? null;
      this.draw();
    });
    return make("label", {}, "Scan from ", select);
  }

  private listen(): void {
    this.slider.addEventListener("input", () => this.show(Number(this.slider.value)));
    this.slider.addEventListener("change", () => this.writeAddress());
    document.addEventListener("keydown", (event) => {
      const target = event.target as HTMLElement;
      if (event.ctrlKey || event.altKey || event.metaKey || target.closest("input, select, button, summary, a, .wide"))
        return;
      const step = event.shiftKey ? 10 : 1;
      const actions: Record<string, () => void> = {
        " ": () => this.toggle(),
        ArrowLeft: () => this.step(-step),
        ArrowRight: () => this.step(step),
        Home: () => this.show(0),
        End: () => this.show(this.replay.times.length - 1),
      };
      const action = actions[event.key];
      if (!action) return;
      event.preventDefault();
      action();
    });
    addEventListener("hashchange", () => this.readAddress());
    addEventListener("resize", () => this.draw());
    this.dark.addEventListener("change", () => void this.load());
  }

  private readAddress(): void {
    const time_s = Number(/[#&]t=([0-9.]+)/.exec(location.hash)?.[1] ?? NaN);
    this.showTime(Number.isFinite(time_s) ? time_s : this.time_s);
    if (Number.isFinite(time_s)) document.getElementById("replay")?.scrollIntoView();
  }

  private writeAddress(): void {
    const address = `#t=${this.replay.times[this.index].toFixed(1)}`;
    // Some browsers forbid it for files.
    try {
      history.replaceState(null, "", address);
    } catch {
      return;
    }
  }

  // --- time

  private toggle(): void {
    this.playing = !this.playing;
    this.playButton.textContent = this.playing ? "Pause" : "Play";
    if (!this.playing) {
      this.writeAddress();
      return;
    }
    if (this.index === this.replay.times.length - 1) this.show(0);
    this.lastFrame_ms = performance.now();
    requestAnimationFrame((now_ms) => this.frame(now_ms));
  }

  private frame(now_ms: number): void {
    if (!this.playing) return;
    const time_s = this.time_s + (Number(this.speed.value) * Math.max(0, now_ms - this.lastFrame_ms)) / 1000;
    this.lastFrame_ms = now_ms;
    this.showTime(time_s);
    if (this.index === this.replay.times.length - 1) this.toggle();
    else requestAnimationFrame((next_ms) => this.frame(next_ms));
  }

  private step(by: number): void {
    this.show(this.index + by);
    this.writeAddress();
  }

  private show(index: number): void {
    this.index = Math.min(this.replay.times.length - 1, Math.max(0, index));
    this.time_s = this.replay.times[this.index];
    this.draw();
  }

  /** The last scan at or before a time, with a little slack for addresses that are rounded to tenths. */
  showTime(time_s: number): void {
    const { times } = this.replay;
    let low = 0;
    let high = times.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= time_s + 0.0501) low = middle;
      else high = middle;
    }
    if (low === this.index && this.playing) {
      this.time_s = time_s;
      return;
    }
    this.show(low);
    this.time_s = Math.max(time_s, this.time_s);
  }

  // --- the page's other plots

  private joinCharts(): void {
    for (const chart of document.querySelectorAll<SVGSVGElement>("svg.chart")) {
      const { left, right, top, bottom, duration } = chart.dataset as Record<string, string>;
      const line = makeSvg("line", { class: "cursor", y1: top, y2: bottom });
      chart.append(line);
      this.cursors.push({ chart, line });
      const seek = (event: PointerEvent): void => {
        const box = chart.getBoundingClientRect();
        const x = ((event.clientX - box.left) / box.width) * chart.viewBox.baseVal.width;
        this.showTime((Number(duration) * (x - Number(left))) / (Number(right) - Number(left)));
      };
      chart.addEventListener("pointerdown", seek);
      chart.addEventListener("pointermove", (event) => {
        if (event.buttons === 1) seek(event);
      });
    }
  }

  private joinMaps(): void {
    const radius = Math.max(this.replay.window.x1 - this.replay.window.x0, 1) / 80;
    for (const map of document.querySelectorAll<SVGSVGElement>("svg.map")) {
      const mark = makeSvg("circle", { class: "cursor", r: String(radius) });
      map.append(mark);
      this.marks.push(mark);
    }
  }

  private markMoment(): void {
    for (const { chart, line } of this.cursors) {
      const { left, right, duration } = chart.dataset as Record<string, string>;
      const share = this.replay.times[this.index] / Number(duration);
      const x = String(Number(left) + (Number(right) - Number(left)) * share);
      line.setAttribute("x1", x);
      line.setAttribute("x2", x);
    }
    const pose = this.trueOrFirst();
    for (const mark of this.marks) {
      mark.setAttribute("visibility", pose ? "visible" : "hidden");
      if (!pose) continue;
      mark.setAttribute("cx", pose.x.toFixed(3));
      mark.setAttribute("cy", (-pose.y).toFixed(3));
    }
  }

  private trueOrFirst(): Pose | null {
    return this.replay.truth?.at(this.index) ?? this.replay.runs[0]?.path.at(this.index) ?? null;
  }

  // --- drawing

  private async load(): Promise<void> {
    const ids = new Set(["plan", ...this.replay.runs.map((run) => run.map)].filter((id) => id !== ""));
    for (const id of ids) this.pictures.set(id, await loadPicture(id, this.dark.matches));
    this.growing = null;
    this.draw();
  }

  private draw(): void {
    this.slider.value = String(this.index);
    const time_s = this.replay.times[this.index];
    const text = `${time_s.toFixed(1)} s of ${this.replay.times[this.replay.times.length - 1].toFixed(1)} s`;
    this.slider.setAttribute("aria-valuetext", text);
    this.output.textContent = text;
    this.drawMap();
    if (this.replay.scans) {
      this.drawChart();
      this.drawPolar();
    }
    this.sayPoses();
    this.markMoment();
  }

  private sayPoses(): void {
    const say = (name: string, pose: Pose | null): string =>
      pose
        ? `${name} ${pose.x.toFixed(2)}, ${pose.y.toFixed(2)} m, ${((pose.yaw * 180) / Math.PI).toFixed(1)}°`
        : `${name} nowhere`;
    const parts = this.replay.truth ? [say(kTruth.name, this.replay.truth.at(this.index))] : [];
    for (const run of this.replay.runs) if (this.shownRuns.has(run)) parts.push(say(run.name, run.path.at(this.index)));
    this.poses.textContent = parts.join(" · ");
    const pose = this.trueOrFirst();
    this.root.dataset.time = this.replay.times[this.index].toFixed(3);
    this.root.dataset.pose = pose ? [pose.x, pose.y, pose.yaw].map((v) => v.toFixed(4)).join(" ") : "";
  }

  private drawMap(): void {
    const { x0, y0, x1, y1 } = this.replay.window;
    const context = prepare(this.map, (y1 - y0) / (x1 - x0));
    const width = this.map.clientWidth;
    const scale = width / (x1 - x0);
    const px = (x: number): number => (x - x0) * scale;
    const py = (y: number): number => (y1 - y) * scale;
    const picture = this.background.startsWith(`${kGrowing}:`)
      ? this.grown(this.background.slice(kGrowing.length + 1))
      : this.pictures.get(this.background);
    context.imageSmoothingEnabled = false;
    if (picture) context.drawImage(picture, 0, 0, width, (y1 - y0) * scale);

    const scanPose = this.scanFrom ? this.scanFrom.path.at(this.index) : this.trueOrFirst();
    if (this.showScan && scanPose) {
      context.fillStyle = this.dark.matches ? "#ff9d6e" : "#d55e00";
      for (const [x, y] of returnsOf(this.replay, this.index, scanPose)) context.fillRect(px(x) - 1.5, py(y) - 1.5, 3, 3);
    }
    const goal = this.goalNow();
    if (goal) {
      context.strokeStyle = themeColour("failure");
      context.lineWidth = 3;
      context.beginPath();
      context.moveTo(px(goal[0]) - 7, py(goal[1]) - 7);
      context.lineTo(px(goal[0]) + 7, py(goal[1]) + 7);
      context.moveTo(px(goal[0]) + 7, py(goal[1]) - 7);
      context.lineTo(px(goal[0]) - 7, py(goal[1]) + 7);
      context.stroke();
    }
    const trail = (at: (index: number) => Pose | null, colour: string, lineWidth: number): void => {
      context.strokeStyle = colour;
      context.lineWidth = lineWidth;
      context.lineJoin = "round";
      context.beginPath();
      let open = false;
      for (let i = 0; i <= this.index; ++i) {
        const pose = at(i);
        if (pose && open) context.lineTo(px(pose.x), py(pose.y));
        else if (pose) context.moveTo(px(pose.x), py(pose.y));
        open = pose !== null;
      }
      context.stroke();
    };
    const robot = (pose: Pose | null, colour: string): void => {
      if (!pose) return;
      // The founding sign: a square within its circle, with its heading.
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
    const { truth } = this.replay;
    if (truth && this.showTruth) trail((i) => truth.at(i), kTruth.colour, 5);
    // The best lies on top.
    const runs = this.replay.runs.filter((run) => this.shownRuns.has(run)).reverse();
    for (const run of runs) trail((i) => run.path.at(i), run.colour, 2);
    if (truth && this.showTruth) robot(truth.at(this.index), kTruth.colour);
    for (const run of runs) robot(run.path.at(this.index), run.colour);
  }

  private goalNow(): [number, number] | null {
    const time_s = this.replay.times[this.index];
    let goal: [number, number] | null = null;
    for (const [from_s, x, y] of this.replay.goals) {
      if (from_s > time_s + 1e-3) break;
      goal = x === null || y === null ? null : [x, y];
    }
    return goal;
  }

  /** The returns of all scans so far, where a method has the robot in the end. */
  private grown(name: string): HTMLCanvasElement | null {
    const run = this.replay.runs.find((one) => one.name === name);
    if (!run) return null;
    const { x0, y0, x1, y1 } = this.replay.window;
    const width = 1600;
    const scale = width / (x1 - x0);
    if (!this.growing || this.growing.run !== run || this.growing.drawn > this.index + 1) {
      const canvas = make("canvas");
      canvas.width = width;
      canvas.height = Math.round((y1 - y0) * scale);
      this.growing = { canvas, run, drawn: 0 };
    }
    const context = this.growing.canvas.getContext("2d")!;
    context.fillStyle = themeColour("ink");
    for (; this.growing.drawn <= this.index; ++this.growing.drawn) {
      const pose = run.path.at(this.growing.drawn);
      if (!pose) continue;
      for (const [x, y] of returnsOf(this.replay, this.growing.drawn, pose))
        context.fillRect((x - x0) * scale - 0.5, (y1 - y) * scale - 0.5, 1.5, 1.5);
    }
    return this.growing.canvas;
  }

  private drawChart(): void {
    const scans = this.replay.scans!;
    const aspect = 0.6;
    const context = prepare(this.chart, aspect);
    const width = this.chart.clientWidth;
    const height = width * aspect;
    const [left, right, top, bottom] = [42, 12, 32, 34];
    const lastAngle = scans.first + (scans.beams - 1) * scans.step;
    const px = (angle: number): number =>
      left + ((width - left - right) * (angle - scans.first)) / (lastAngle - scans.first);
    const py = (range: number): number => height - bottom - ((height - top - bottom) * Math.min(range, scans.usual)) / scans.usual;
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = themeColour("ink");
    context.strokeStyle = themeColour("line");
    context.lineWidth = 1;
    const label = (text: string, x: number, y: number, align: CanvasTextAlign): void => {
      context.textAlign = align;
      context.fillText(text, x, y);
    };
    label("range (m)", 4, 14, "left");
    label("angle (°, left positive)", (left + width - right) / 2, height - 4, "center");
    for (let i = 0; i <= 4; ++i) {
      const range = (scans.usual * i) / 4;
      context.strokeRect(left, py(range), width - left - right, 0);
      label(range.toFixed(0), left - 5, py(range) + 4, "right");
      const angle = scans.first + ((lastAngle - scans.first) * i) / 4;
      label(((angle * 180) / Math.PI).toFixed(0), Math.min(px(angle), width - right - 10), height - bottom + 14, "center");
    }
    context.strokeStyle = this.dark.matches ? "#7cc0ff" : "#0072b2";
    context.lineWidth = 1.5;
    context.beginPath();
    let open = false;
    for (let beam = 0; beam < scans.beams; ++beam) {
      const range = scans.range(this.index, beam);
      if (Number.isNaN(range)) open = false;
      else if (open) context.lineTo(px(scans.first + beam * scans.step), py(range));
      else {
        context.moveTo(px(scans.first + beam * scans.step), py(range));
        open = true;
      }
    }
    context.stroke();
  }

  private drawPolar(): void {
    const scans = this.replay.scans!;
    const context = prepare(this.polar, 1);
    const half = this.polar.clientWidth / 2;
    const scale = (half - 10) / scans.usual;
    context.strokeStyle = themeColour("line");
    context.fillStyle = themeColour("ink");
    context.font = "12px system-ui, sans-serif";
    context.lineWidth = 1;
    for (const share of [0.5, 1]) {
      context.beginPath();
      context.arc(half, half, scans.usual * share * scale, 0, 2 * Math.PI);
      context.stroke();
      context.textAlign = "left";
      context.fillText(`${(scans.usual * share).toFixed(0)} m`, half + 3, half + scans.usual * share * scale - 4);
    }
    context.fillStyle = this.dark.matches ? "#ff9d6e" : "#d55e00";
    for (let beam = 0; beam < scans.beams; ++beam) {
      const range = scans.range(this.index, beam);
      if (Number.isNaN(range)) continue;
      const angle = scans.first + beam * scans.step;
      context.fillRect(half - range * scale * Math.sin(angle) - 1.5, half - range * scale * Math.cos(angle) - 1.5, 3, 3);
    }
    context.fillStyle = themeColour("ink");
    context.beginPath();
    context.moveTo(half, half - 9);
    context.lineTo(half - 6, half + 6);
    context.lineTo(half + 6, half + 6);
    context.fill();
  }
}
