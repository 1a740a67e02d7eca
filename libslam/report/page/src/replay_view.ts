import { button, make, swatch } from "./dom";
import { JoinedPlots } from "./joined_plots";
import { LongList } from "./lists";
import { playerChoices } from "./player_choices";
import type { Happening, Pose, Replay } from "./replay_data";
import { kScansAspect, ScanViews } from "./scan_views";
import { Stage, groundsOf, kTruth, type Ground, type Shown } from "./stage";
import { Timeline } from "./timeline";

const kLowMap = 0.45; // height over width
const kSpeeds = [1, 2, 5, 10, 20, 50];

/** "t 0.21" of the operation log in words. */
function operationWords(operation: string): string {
  const [kind, first, second] = operation.split(" ");
  if (kind === "t") return `turned ${((Number(first) * 180) / Math.PI).toFixed(1)}°`;
  if (kind !== "m") return "first look";
  // 0 stands for a reading that there was none of; the way is the mean of those that there are.
  const readings = [first, second].map(Number).filter((value) => value !== 0);
  const way_m = readings.reduce((sum, value) => sum + value, 0) / Math.max(1, readings.length);
  return `moved ${way_m.toFixed(3)} m`;
}

/** With so many decimals; no "-0.00". */
function decimals(value: number, count: number): string {
  const text = value.toFixed(count);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

/** What the page says of its events. */
function readMeanings(): Map<string, string> {
  const names = Array.from(document.querySelectorAll("#event-meanings dt"));
  return new Map(names.map((name) => [name.textContent ?? "", name.nextElementSibling?.textContent ?? ""]));
}

/** One replay: its controls, views and lists. */
export class ReplayView {
  private playing = false;
  private lastFrame_ms = 0;
  private time_s = 0;
  private readonly shown: Shown;
  private readonly grounds: Ground[];
  private readonly dark = matchMedia("(prefers-color-scheme: dark)");
  private readonly closing = new AbortController();

  private readonly stage: Stage;
  private readonly scanViews: ScanViews | null;
  private readonly timeline: Timeline;
  private readonly operations: LongList;
  private readonly events: LongList;
  private listed: Happening[];
  private readonly meanings = readMeanings();
  private readonly slider = make("input", { type: "range", min: "0", step: "1", "aria-label": "Scan" });
  private readonly output = make("output", { "aria-live": "off" });
  private readonly poses = make("p", { class: "note poses" });
  private readonly playButton = button("Play", "Play or pause (space)", () => this.toggle());
  private readonly speed = make("select", { "aria-label": "Speed" });
  private readonly plots: JoinedPlots;

  constructor(
    private readonly replay: Replay,
    private readonly root: HTMLElement,
    private readonly address: string,
    time_s: number,
  ) {
    this.grounds = groundsOf(replay);
    this.shown = {
      index: 0,
      ground: this.grounds[0],
      runs: new Set(replay.runs),
      truth: true,
      scan: true,
      scanFrom: replay.truth ? null : (replay.runs[0] ?? null),
      events: true,
      goal: true,
    };
    this.listed = replay.happenings;
    this.stage = new Stage(replay);
    this.scanViews = replay.scans ? new ScanViews(replay.scans) : null;
    this.timeline = new Timeline(replay, (at_s) => this.seek(at_s));
    this.operations = new LongList("Operation log", (row, index) => this.fillOperation(row, index), (index) => this.show(index));
    this.events = new LongList("Events", (row, index) => this.fillEvent(row, index), (index) => this.seek(this.listed[index].time_s));
    this.slider.max = String(replay.times.length - 1);
    this.build();
    this.operations.show(replay.operations.length);
    this.events.show(this.listed.length);
    const { x0, x1 } = replay.window;
    this.plots = new JoinedPlots(replay.group, x1 - x0, (at_s) => this.showTime(at_s), this.closing.signal);
    this.listen();
    this.showTime(time_s);
    void this.load();
  }

  close(): void {
    this.closing.abort();
    this.playing = false;
    this.plots.remove();
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
    const views = make("div", { class: "views" }, this.stage.canvas, ...(this.scanViews ? [this.scanViews.root] : []));
    if (this.scanViews) this.layOut(views);
    else views.classList.add("one");
    this.root.append(transport, this.timeline.canvas, playerChoices(this.replay, this.grounds, this.shown, () => this.draw()), views, this.poses, this.lists());
    this.root.append(
      make(
        "p",
        { class: "note" },
        "Keys: space plays, the arrows step (with shift by ten), Home and End. The page's address keeps the moment, as in #t=83.2.",
      ),
    );
  }

  /** The scan's views beside the map, as high as it is; under a map that is low, beside each other. */
  private layOut(views: HTMLElement): void {
    const { x0, y0, x1, y1 } = this.replay.window;
    const aspect = (y1 - y0) / (x1 - x0);
    if (aspect < kLowMap) views.classList.add("low");
    else views.style.setProperty("--columns", `${kScansAspect}fr ${aspect.toFixed(3)}fr`);
  }

  private lists(): HTMLElement {
    const lists = make("div", { class: "lists" });
    const { happenings, operations } = this.replay;
    if (happenings.length > 0) lists.append(make("section", {}, make("h3", {}, "Events"), this.eventChoice(), this.events.root));
    if (operations.length > 0)
      lists.append(
        make(
          "section",
          {},
          make("h3", {}, "Operation log"),
          make("p", { class: "note" }, "The command that led to each scan shown, whole, though it may take many scans; as the scans before and after it said: m rear front (m), t angle (rad)."),
          this.operations.root,
        ),
      );
    return lists;
  }

  private eventChoice(): HTMLElement {
    const kinds = new Map<string, number>();
    const nameOf = ({ run, what }: Happening): string => (run ? `${run.name}: ${what}` : what);
    for (const happening of this.replay.happenings) kinds.set(nameOf(happening), (kinds.get(nameOf(happening)) ?? 0) + 1);
    const select = make("select", {}, make("option", { value: "" }, `all ${this.replay.happenings.length}`));
    for (const [kind, count] of kinds) select.append(make("option", { value: kind }, `${kind} (${count})`));
    select.addEventListener("change", () => {
      this.listed = this.replay.happenings.filter((one) => select.value === "" || nameOf(one) === select.value);
      this.events.show(this.listed.length);
      this.draw();
    });
    return make("div", { class: "bar" }, make("label", {}, "Show ", select));
  }

  private fillOperation(row: HTMLButtonElement, index: number): void {
    const operation = this.replay.operations[index];
    row.append(
      make("span", { class: "time" }, `${this.replay.times[index].toFixed(1)} s`),
      make("code", {}, operation),
      make("span", { class: "words" }, operationWords(operation)),
    );
  }

  private fillEvent(row: HTMLButtonElement, index: number): void {
    const { time_s, run, what, detail } = this.listed[index];
    row.append(make("span", { class: "time" }, `${time_s.toFixed(1)} s`));
    if (run) row.append(swatch(run.colour));
    row.append(make("span", { class: "words" }, `${run && this.replay.runs.length > 1 ? `${run.name}: ` : ""}${what}${detail ? ` — ${detail}` : ""}`));
    row.title = [what, this.meanings.get(what) ?? "", detail].filter(Boolean).join(" — ");
  }

  private listen(): void {
    const { signal } = this.closing;
    this.slider.addEventListener("input", () => this.show(Number(this.slider.value)));
    this.slider.addEventListener("change", () => this.writeAddress());
    document.addEventListener(
      "keydown",
      (event) => {
        const target = event.target as HTMLElement;
        if (event.ctrlKey || event.altKey || event.metaKey) return;
        if (target.closest("input, select, button, summary, a, .wide, .long-view")) return;
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
      },
      { signal },
    );
    addEventListener("resize", () => this.draw(), { signal });
    this.dark.addEventListener("change", () => void this.load(), { signal });
  }

  private writeAddress(): void {
    const address = `#${this.address}t=${this.replay.times[this.shown.index].toFixed(1)}`;
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
    if (this.shown.index === this.replay.times.length - 1) this.show(0);
    this.lastFrame_ms = performance.now();
    requestAnimationFrame((now_ms) => this.frame(now_ms));
  }

  private frame(now_ms: number): void {
    if (!this.playing) return;
    const time_s = this.time_s + (Number(this.speed.value) * Math.max(0, now_ms - this.lastFrame_ms)) / 1000;
    this.lastFrame_ms = now_ms;
    this.showTime(time_s);
    if (this.shown.index === this.replay.times.length - 1) this.toggle();
    else requestAnimationFrame((next_ms) => this.frame(next_ms));
  }

  private step(scans: number): void {
    this.show(this.shown.index + scans);
    this.writeAddress();
  }

  private seek(time_s: number): void {
    this.showTime(time_s);
    this.writeAddress();
  }

  private show(index: number): void {
    this.shown.index = Math.min(this.replay.times.length - 1, Math.max(0, index));
    this.time_s = this.replay.times[this.shown.index];
    this.draw();
  }

  /** The last scan that is not later. */
  showTime(time_s: number): void {
    const { times } = this.replay;
    let low = 0;
    let high = times.length - 1;
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      // An address holds a tenth of a second, a single-precision number a little less than it should.
      if (times[middle] <= time_s + 1e-3) low = middle;
      else high = middle - 1;
    }
    this.show(low);
    this.time_s = Math.max(time_s, this.time_s);
  }

  // --- drawing

  private async load(): Promise<void> {
    await this.stage.load(this.dark.matches);
    if (!this.closing.signal.aborted) this.draw();
  }

  private draw(): void {
    const { index } = this.shown;
    const { times } = this.replay;
    const time_s = times[index];
    this.slider.value = String(index);
    const text = `${time_s.toFixed(1)} s of ${times[times.length - 1].toFixed(1)} s`;
    this.slider.setAttribute("aria-valuetext", text);
    this.output.textContent = text;
    // On paper there is no player to draw.
    if (this.root.clientWidth > 0) {
      this.stage.draw(this.shown, this.dark.matches);
      this.scanViews?.draw(index, this.dark.matches);
      this.timeline.draw(time_s, this.dark.matches);
    }
    this.operations.setCurrent(index);
    this.events.setCurrent(this.lastEventAt(time_s));
    this.sayPoses();
    this.plots.show(time_s, this.stage.trueOrFirst(index));
  }

  /** Of those listed; -1 before the first. */
  private lastEventAt(time_s: number): number {
    let last = -1;
    while (last + 1 < this.listed.length && this.listed[last + 1].time_s <= time_s + 1e-3) ++last;
    return last;
  }

  private sayPoses(): void {
    const { index } = this.shown;
    const say = (name: string, pose: Pose | null): string =>
      pose
        ? `${name} ${decimals(pose.x, 2)}, ${decimals(pose.y, 2)} m, ${decimals((pose.yaw * 180) / Math.PI, 1)}°`
        : `${name} nowhere`;
    const parts = this.replay.truth ? [say(kTruth.name, this.replay.truth.at(index))] : [];
    for (const run of this.replay.runs) if (this.shown.runs.has(run)) parts.push(say(run.name, run.path.at(index)));
    const goal = this.stage.goalAt(this.replay.times[index]);
    if (goal) parts.push(`goal ${goal[0].toFixed(2)}, ${goal[1].toFixed(2)} m`);
    this.poses.textContent = parts.join(" · ");
    const pose = this.stage.trueOrFirst(index);
    const player = this.root.parentElement!;
    player.dataset.time = this.replay.times[index].toFixed(3);
    player.dataset.pose = pose ? [pose.x, pose.y, pose.yaw].map((value) => value.toFixed(4)).join(" ") : "";
  }
}
