import { button, make } from "./dom";

/** A part of the world in the maps' units: metres, y down. */
interface View {
  x: number;
  y: number;
  width: number;
  height: number;
}

const kStep = 1.4;
const kMostZoom = 60;

/** Maps of one ground show the same part of the world: what is done to one is done to all of them. */
class LinkedMaps {
  private view: View;
  private readonly whole: View;

  constructor(private readonly maps: SVGSVGElement[]) {
    const box = maps[0].viewBox.baseVal;
    this.whole = { x: box.x, y: box.y, width: box.width, height: box.height };
    this.view = { ...this.whole };
    for (const map of maps) this.listen(map);
    for (const group of document.querySelectorAll(".maps"))
      if (group.querySelector("svg.map") && maps.includes(group.querySelector("svg.map")!)) group.before(this.controls());
  }

  private controls(): HTMLElement {
    return make(
      "div",
      { class: "bar", role: "group", "aria-label": "Zoom of all maps" },
      button("+", "Zoom in", () => this.zoom(1 / kStep)),
      button("−", "Zoom out", () => this.zoom(kStep)),
      button("←", "Move left", () => this.move(-0.2, 0)),
      button("→", "Move right", () => this.move(0.2, 0)),
      button("↑", "Move up", () => this.move(0, -0.2)),
      button("↓", "Move down", () => this.move(0, 0.2)),
      button("Whole", "Show the whole map", () => this.show({ ...this.whole })),
    );
  }

  private show(view: View): void {
    this.view = view;
    const text = `${view.x} ${view.y} ${view.width} ${view.height}`;
    for (const map of this.maps) map.setAttribute("viewBox", text);
  }

  private move(right: number, down: number): void {
    const { x, y, width, height } = this.view;
    this.show({ x: x + right * width, y: y + down * height, width, height });
  }

  /** About a point given as shares of the view. */
  private zoom(factor: number, atX = 0.5, atY = 0.5): void {
    const { x, y, width, height } = this.view;
    const limited = Math.min(this.whole.width, Math.max(this.whole.width / kMostZoom, width * factor)) / width;
    this.show({
      x: x + atX * width * (1 - limited),
      y: y + atY * height * (1 - limited),
      width: width * limited,
      height: height * limited,
    });
  }

  private listen(map: SVGSVGElement): void {
    map.classList.add("movable");
    // The wheel alone scrolls the page, as people expect.
    map.addEventListener(
      "wheel",
      (event) => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        const box = map.getBoundingClientRect();
        const atX = (event.clientX - box.left) / box.width;
        const atY = (event.clientY - box.top) / box.height;
        this.zoom(event.deltaY < 0 ? 1 / kStep : kStep, atX, atY);
      },
      { passive: false },
    );
    map.addEventListener("dblclick", () => this.show({ ...this.whole }));
    map.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch" && this.view.width >= this.whole.width) return;
      map.setPointerCapture(event.pointerId);
      let [lastX, lastY] = [event.clientX, event.clientY];
      const drag = (moved: PointerEvent): void => {
        const box = map.getBoundingClientRect();
        this.move((lastX - moved.clientX) / box.width, (lastY - moved.clientY) / box.height);
        [lastX, lastY] = [moved.clientX, moved.clientY];
      };
      map.addEventListener("pointermove", drag);
      for (const end of ["pointerup", "pointercancel"] as const)
        map.addEventListener(end, () => map.removeEventListener("pointermove", drag), { once: true });
    });
  }
}

export function linkMaps(): void {
  const groups = new Map<string, SVGSVGElement[]>();
  for (const map of document.querySelectorAll<SVGSVGElement>("svg.map")) {
    const name = map.dataset.group ?? "";
    groups.set(name, [...(groups.get(name) ?? []), map]);
  }
  for (const maps of groups.values()) new LinkedMaps(maps);
}
