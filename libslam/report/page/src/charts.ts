import { button, make, makeSvg } from "./dom";

/** What charts that page_chart.cpp wrote hold: a line's points with their intervals. */
interface Line {
  series: string;
  label: string;
  element: SVGGElement;
  points: number[][]; // x, y, and low and high where there is an interval
}

const kHint = "Point at the chart to read its values; its names switch lines off and on.";

function shortNumber(value: number): string {
  return String(Number(value.toPrecision(3)));
}

/** Readable with pointer and arrow keys. */
class AskedChart {
  private readonly lines: Line[];
  private readonly hidden = new Set<string>();
  private readonly guide: SVGLineElement;
  private readonly readout = make("p", { class: "note readout" }, kHint);
  private readonly from: number;
  private readonly to: number;
  private readonly left: number;
  private readonly right: number;
  private at: number;

  constructor(private readonly chart: SVGSVGElement) {
    const { dataset } = chart;
    [this.from, this.to, this.left, this.right] = [dataset.from, dataset.to, dataset.left, dataset.right].map(Number);
    this.at = this.left;
    const figure = chart.closest("figure")!;
    const legend = figure.querySelector(".legend")!;
    const labels = new Map<string, string>();
    for (const item of legend.querySelectorAll<HTMLElement>("li")) {
      labels.set(item.dataset.series!, item.querySelector("span")!.textContent ?? "");
      this.makeSwitch(item);
    }
    this.lines = Array.from(chart.querySelectorAll<SVGGElement>("g[data-series]"), (element) => ({
      series: element.dataset.series!,
      label: labels.get(element.dataset.series!) ?? "",
      element,
      points: (element.dataset.values ?? "")
        .split(";")
        .filter((text) => text !== "")
        .map((text) => text.split(" ").map(Number)),
    }));
    this.lines.sort((a, b) => Number(a.series) - Number(b.series));
    this.guide = makeSvg("line", { class: "guide", y1: dataset.top!, y2: dataset.bottom!, visibility: "hidden" });
    chart.append(this.guide);
    figure.querySelector("section")!.after(this.readout);
    chart.addEventListener("pointermove", (event) => {
      const box = chart.getBoundingClientRect();
      this.read(((event.clientX - box.left) / box.width) * chart.viewBox.baseVal.width);
    });
    chart.addEventListener("pointerleave", () => this.forget());
    const section = chart.parentElement!;
    section.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (step === undefined) return;
      event.preventDefault();
      this.read(this.at + (step * (this.right - this.left)) / 50);
    });
    section.addEventListener("blur", () => this.forget());
  }

  private makeSwitch(item: HTMLElement): void {
    const series = item.dataset.series!;
    const name = item.querySelector("span")!.textContent ?? "";
    const toggle = button("", `Show ${name}`, () => {
      const hide = !this.hidden.delete(series);
      if (hide) this.hidden.add(series);
      toggle.setAttribute("aria-pressed", String(!hide));
      for (const line of this.lines)
        if (line.series === series) line.element.setAttribute("visibility", hide ? "hidden" : "visible");
    });
    toggle.setAttribute("aria-pressed", "true");
    toggle.append(...item.childNodes);
    // The name is what it holds.
    toggle.removeAttribute("aria-label");
    item.append(toggle);
  }

  private forget(): void {
    this.guide.setAttribute("visibility", "hidden");
    this.readout.textContent = kHint;
  }

  /** The values at a place of the drawing: of every line that of its nearest point. */
  private read(place: number): void {
    this.at = Math.min(this.right, Math.max(this.left, place));
    const share = (this.at - this.left) / (this.right - this.left);
    const isLog = this.chart.dataset.log !== undefined;
    const x = isLog ? this.from * (this.to / this.from) ** share : this.from + share * (this.to - this.from);
    this.guide.setAttribute("x1", String(this.at));
    this.guide.setAttribute("x2", String(this.at));
    this.guide.setAttribute("visibility", "visible");
    const distance = (point: number[]): number => Math.abs(isLog ? Math.log(point[0] / x) : point[0] - x);
    // A line that has ended has no value there.
    const reach = isLog ? Infinity : (this.to - this.from) / 12;
    const parts: string[] = [];
    for (const line of this.lines) {
      if (this.hidden.has(line.series) || line.points.length === 0) continue;
      const [pointX, y, low, high] = line.points.reduce((best, point) => (distance(point) < distance(best) ? point : best));
      const hasInterval = low !== undefined;
      if (!hasInterval && Math.abs(pointX - x) > reach) continue;
      parts.push(
        hasInterval
          ? `${line.label} at ${shortNumber(pointX)}: ${shortNumber(y)} [${shortNumber(low)}, ${shortNumber(high)}]`
          : `${line.label} ${shortNumber(y)}`,
      );
    }
    this.readout.textContent = `${this.chart.dataset.x} ${shortNumber(x)}: ${parts.join(" · ")}`;
  }
}

export function enlivenCharts(): void {
  for (const chart of document.querySelectorAll<SVGSVGElement>("svg.chart.asked")) new AskedChart(chart);
}
