import { make } from "./dom";
import type { Happening, Replay, Run } from "./replay_data";
import { isWeighty, themeColour, visible } from "./stage";

const kRow_px = 18;
const kRight_px = 8;

/** All that happened as marks over time, a row per method and one for the robot; a click goes there. */
export class Timeline {
  readonly canvas = make("canvas", { class: "timeline", role: "img" });
  private readonly rows: { run: Run | null; happenings: Happening[] }[] = [];
  private readonly end_s: number;

  constructor(replay: Replay, onSeek: (time_s: number) => void) {
    this.end_s = Math.max(1e-9, replay.times[replay.times.length - 1]);
    for (const run of [null, ...replay.runs]) {
      const happenings = replay.happenings.filter((one) => one.run === run);
      if (happenings.length > 0) this.rows.push({ run, happenings });
    }
    this.canvas.hidden = this.rows.length === 0;
    this.canvas.setAttribute("aria-label", "What happened when: the list below has the same");
    const seek = (event: PointerEvent): void => {
      const { left, right } = this.span();
      const x = event.clientX - this.canvas.getBoundingClientRect().left;
      onSeek((this.end_s * (x - left)) / (right - left));
    };
    this.canvas.addEventListener("pointerdown", seek);
    this.canvas.addEventListener("pointermove", (event) => {
      if (event.buttons === 1) seek(event);
    });
  }

  private span(): { left: number; right: number } {
    return { left: Math.min(130, 0.28 * this.canvas.clientWidth), right: this.canvas.clientWidth - kRight_px };
  }

  draw(time_s: number, dark: boolean): void {
    if (this.rows.length === 0) return;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [this.canvas.clientWidth, this.rows.length * kRow_px];
    this.canvas.width = Math.max(1, Math.round(width * ratio));
    this.canvas.height = Math.round(height * ratio);
    const context = this.canvas.getContext("2d")!;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const { left, right } = this.span();
    const px = (at_s: number): number => left + ((right - left) * Math.min(at_s, this.end_s)) / this.end_s;
    context.font = "12px system-ui, sans-serif";
    this.rows.forEach(({ run, happenings }, row) => {
      const top = row * kRow_px;
      context.fillStyle = themeColour("ink");
      context.fillText(shortened(context, run?.name ?? "robot", left - 10), 0, top + 13);
      context.strokeStyle = themeColour("line");
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(left, top + kRow_px - 3.5);
      context.lineTo(right, top + kRow_px - 3.5);
      context.stroke();
      context.fillStyle = run ? visible(run.colour, dark) : themeColour("failure");
      for (const { time_s: at_s, what } of happenings) {
        const high = isWeighty(what) ? 13 : 6;
        context.fillRect(px(at_s) - 1, top + kRow_px - 4 - high, 2, high);
      }
    });
    context.fillStyle = themeColour("ink");
    context.fillRect(px(time_s) - 0.75, 0, 1.5, height);
  }
}

function shortened(context: CanvasRenderingContext2D, text: string, width: number): string {
  if (context.measureText(text).width <= width) return text;
  let end = text.length;
  while (end > 1 && context.measureText(`${text.slice(0, end)}…`).width > width) --end;
  return `${text.slice(0, end)}…`;
}
