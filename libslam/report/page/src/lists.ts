import { make } from "./dom";

const kRow_px = 30;
const kSpare = 6; // rows beyond those in view

/** A long list of which only what is in view is in the page. It follows the row that is current. */
export class LongList {
  readonly root: HTMLElement;
  private readonly view = make("div", { class: "long-view" });
  private readonly rows = make("div", { class: "long-rows", role: "list" });
  private count = 0;
  private current = -1;

  constructor(
    label: string,
    private readonly fill: (row: HTMLButtonElement, index: number) => void,
    private readonly onChoice: (index: number) => void,
  ) {
    this.view.append(this.rows);
    this.view.setAttribute("role", "group");
    this.view.setAttribute("aria-label", label);
    this.view.tabIndex = 0;
    this.root = this.view;
    this.view.addEventListener("scroll", () => this.draw());
  }

  show(count: number): void {
    this.count = count;
    this.rows.style.height = `${count * kRow_px}px`;
    this.view.style.height = `${Math.min(8, count) * kRow_px + 2}px`;
    this.draw();
  }

  setCurrent(index: number): void {
    if (index === this.current) return;
    this.current = index;
    // A list that someone is reading stays where it is.
    if (!this.view.matches(":hover, :focus-within"))
      this.view.scrollTop = Math.max(0, (index + 0.5) * kRow_px - this.view.clientHeight / 2);
    this.draw();
  }

  private draw(): void {
    const height = this.view.clientHeight || 8 * kRow_px;
    const first = Math.max(0, Math.floor(this.view.scrollTop / kRow_px) - kSpare);
    const last = Math.min(this.count, Math.ceil((this.view.scrollTop + height) / kRow_px) + kSpare);
    const focused = this.rows.contains(document.activeElement) ? document.activeElement!.parentElement!.dataset.index : null;
    this.rows.replaceChildren();
    for (let index = first; index < last; ++index) {
      const button = make("button", { type: "button" });
      if (index === this.current) button.setAttribute("aria-current", "true");
      button.addEventListener("click", () => this.onChoice(index));
      this.fill(button, index);
      const row = make("div", { role: "listitem", "data-index": String(index) }, button);
      row.style.top = `${index * kRow_px}px`;
      this.rows.append(row);
      if (focused === String(index)) button.focus({ preventScroll: true });
    }
  }
}
