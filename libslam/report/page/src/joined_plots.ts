import { makeSvg } from "./dom";
import type { Pose } from "./replay_data";

/** What of the page, beside the player, shows the moment: a line in the charts over time, a dot in the maps. */
export class JoinedPlots {
  private readonly cursors: { chart: SVGSVGElement; line: SVGLineElement }[] = [];
  private readonly marks: SVGCircleElement[] = [];

  /** Maps of this group, `width_m` wide; pointing at a chart seeks. */
  constructor(group: number, width_m: number, seek: (time_s: number) => void, signal: AbortSignal) {
    for (const chart of document.querySelectorAll<SVGSVGElement>("svg.chart[data-duration]")) this.join(chart, seek, signal);
    const radius = Math.max(width_m, 1) / 80;
    for (const map of document.querySelectorAll<SVGSVGElement>(`svg.map[data-group="${group}"]`)) {
      const mark = makeSvg("circle", { class: "cursor", r: String(radius) });
      map.append(mark);
      this.marks.push(mark);
    }
  }

  remove(): void {
    for (const { line } of this.cursors) line.remove();
    for (const mark of this.marks) mark.remove();
  }

  show(time_s: number, pose: Pose | null): void {
    for (const { chart, line } of this.cursors) {
      const { left, right, duration } = chart.dataset as Record<string, string>;
      const share = Math.min(1, time_s / Number(duration));
      const x = String(Number(left) + (Number(right) - Number(left)) * share);
      line.setAttribute("x1", x);
      line.setAttribute("x2", x);
    }
    for (const mark of this.marks) {
      mark.setAttribute("visibility", pose ? "visible" : "hidden");
      if (!pose) continue;
      mark.setAttribute("cx", pose.x.toFixed(3));
      mark.setAttribute("cy", (-pose.y).toFixed(3));
    }
  }

  private join(chart: SVGSVGElement, seek: (time_s: number) => void, signal: AbortSignal): void {
    const { left, right, top, bottom, duration } = chart.dataset as Record<string, string>;
    const line = makeSvg("line", { class: "cursor", y1: top, y2: bottom });
    chart.append(line);
    this.cursors.push({ chart, line });
    const seekAt = (event: PointerEvent): void => {
      const box = chart.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * chart.viewBox.baseVal.width;
      seek((Number(duration) * (x - Number(left))) / (Number(right) - Number(left)));
    };
    chart.addEventListener("pointerdown", seekAt, { signal });
    chart.addEventListener(
      "pointermove",
      (event) => {
        if (event.buttons === 1) seekAt(event);
      },
      { signal },
    );
  }
}
