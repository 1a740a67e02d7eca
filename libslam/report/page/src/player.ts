import { make } from "./dom";
import type { Replays } from "./replay_data";
import { ReplayView } from "./replay_view";

/** The replays of the page, one at a time. */
export class Player {
  private readonly scene: HTMLElement = make("div");
  private readonly choice = make("select");
  private current = 0;
  private view: ReplayView;

  constructor(
    private readonly replays: Replays,
    root: HTMLElement,
  ) {
    const { names } = replays;
    names.forEach((name, index) => this.choice.append(make("option", { value: String(index) }, name || `replay ${index + 1}`)));
    this.choice.addEventListener("change", () => this.open(Number(this.choice.value), 0));
    if (names.length > 1) root.append(make("div", { class: "bar" }, make("label", {}, "Replay of ", this.choice)));
    root.append(this.scene);
    const { replay, time_s } = this.readAddress();
    this.current = replay;
    this.view = this.make(replay, time_s ?? 0);
    if (time_s !== null) this.scrollIntoView();
    addEventListener("hashchange", () => {
      const asked = this.readAddress();
      if (asked.time_s === null) return;
      if (asked.replay === this.current) this.view.showTime(asked.time_s);
      else this.open(asked.replay, asked.time_s);
      this.scrollIntoView();
    });
  }

  private scrollIntoView(): void {
    document.getElementById("replay")?.scrollIntoView();
  }

  private readAddress(): { replay: number; time_s: number | null } {
    const time_s = Number(/[#&]t=([0-9.]+)/.exec(location.hash)?.[1] ?? NaN);
    const replay = Number(/[#&]replay=([0-9]+)/.exec(location.hash)?.[1] ?? 1) - 1;
    return {
      replay: replay >= 0 && replay < this.replays.names.length ? replay : this.current,
      time_s: Number.isFinite(time_s) ? time_s : null,
    };
  }

  private open(index: number, time_s: number): void {
    this.view.close();
    this.current = index;
    this.view = this.make(index, time_s);
  }

  private make(index: number, time_s: number): ReplayView {
    this.choice.value = String(index);
    this.scene.replaceChildren();
    const prefix = index > 0 ? `replay=${index + 1}&` : "";
    return new ReplayView(this.replays.at(index), this.scene, prefix, time_s);
  }
}
