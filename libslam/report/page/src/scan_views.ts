import { make } from "./dom";
import type { Scans } from "./replay_data";
import { prepare, themeColour } from "./stage";

const kChartAspect = 0.6;
const kPolarAspect = 1;
/** Of both, one above the other: height over width. */
export const kScansAspect = kChartAspect + kPolarAspect + 0.03;

/** One scan, as a chart over the angle and from above. */
export class ScanViews {
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
  readonly root = make("div", { class: "scans" }, this.chart, this.polar);

  constructor(private readonly scans: Scans) {}

  draw(index: number, dark: boolean): void {
    this.drawChart(index, dark);
    this.drawPolar(index, dark);
  }

  private drawChart(index: number, dark: boolean): void {
    const { scans } = this;
    const aspect = kChartAspect;
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
    }
    const degrees = 180 / Math.PI;
    const span = (lastAngle - scans.first) * degrees;
    const step = [5, 10, 15, 30, 45, 60].find((one) => span / one <= 6) ?? 90;
    for (let angle = step * Math.ceil((scans.first * degrees) / step); angle <= lastAngle * degrees + 0.5; angle += step) {
      const x = px(angle / degrees);
      context.strokeRect(x, top, 0, height - top - bottom);
      label(String(angle === 0 ? 0 : angle), Math.min(x, width - right - 8), height - bottom + 14, "center");
    }
    context.strokeStyle = dark ? "#7cc0ff" : "#0072b2";
    context.lineWidth = 1.5;
    context.beginPath();
    let open = false;
    for (let beam = 0; beam < scans.beams; ++beam) {
      const range = scans.range(index, beam);
      if (Number.isNaN(range)) open = false;
      else if (open) context.lineTo(px(scans.first + beam * scans.step), py(range));
      else {
        context.moveTo(px(scans.first + beam * scans.step), py(range));
        open = true;
      }
    }
    context.stroke();
  }

  private drawPolar(index: number, dark: boolean): void {
    const { scans } = this;
    const context = prepare(this.polar, kPolarAspect);
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
    context.fillStyle = dark ? "#ff9d6e" : "#d55e00";
    for (let beam = 0; beam < scans.beams; ++beam) {
      const range = scans.range(index, beam);
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
