import { make, makeSvg, swatch } from "./dom";
import type { Replay } from "./replay_data";
import { isWeighty, kTruth, type Ground, type Shown } from "./stage";

/** The mark of a goal or a mishap as the map has it. */
function sign(outline: string): SVGSVGElement {
  const picture = makeSvg("svg", { class: "sign", viewBox: "0 0 16 16", "aria-hidden": "true" });
  picture.append(makeSvg("path", { d: outline }));
  return picture;
}
const kGoalSign = "M8 0V16M0 8H16M13 8A5 5 0 1 1 3 8A5 5 0 1 1 13 8";
const kLoopSign = "M14 8A6 6 0 1 1 2 8A6 6 0 1 1 14 8";
const kMishapSign = "M3 3L13 13M13 3L3 13";

/** What of a replay is shown: boxes to tick, what lies under it, and from where its scan. Each changes `shown`, then draws. */
export function playerChoices(replay: Replay, grounds: Ground[], shown: Shown, draw: () => void): HTMLElement {
  const boxes = make("fieldset", {}, make("legend", {}, "Show"));
  const addBox = (name: string, colour: string | null, onChange: (on: boolean) => void): HTMLElement => {
    const box = make("input", { type: "checkbox" });
    box.checked = true;
    box.addEventListener("change", () => {
      onChange(box.checked);
      draw();
    });
    const label = make("label", {}, box);
    if (colour) label.append(swatch(colour));
    label.append(name);
    boxes.append(label);
    return label;
  };
  if (replay.truth) addBox(kTruth.name, kTruth.colour, (on) => (shown.truth = on));
  for (const run of replay.runs) addBox(run.name, run.colour, (on) => (on ? shown.runs.add(run) : shown.runs.delete(run)));
  if (replay.scans) addBox("scan", null, (on) => (shown.scan = on));
  if (replay.goals.length > 0) addBox("goal", null, (on) => (shown.goal = on)).append(sign(kGoalSign));
  const has = (test: (what: string) => boolean): boolean => replay.happenings.some(({ what }) => test(what));
  const loops = has((what) => what === "accepted");
  const mishaps = has((what) => what !== "accepted" && isWeighty(what));
  if (loops || mishaps) {
    const label = addBox([loops ? "loops" : "", mishaps ? "mishaps" : ""].filter(Boolean).join(", "), null, (on) => (shown.events = on));
    label.append(...(loops ? [sign(kLoopSign)] : []), ...(mishaps ? [sign(kMishapSign)] : []));
  }
  return make("div", { class: "bar" }, boxes, groundChoice(grounds, shown, draw), ...(replay.scans ? [scanChoice(replay, shown, draw)] : []));
}

function groundChoice(grounds: Ground[], shown: Shown, draw: () => void): HTMLElement {
  const select = make("select");
  grounds.forEach(({ label }, index) => select.append(make("option", { value: String(index) }, label)));
  select.addEventListener("change", () => {
    shown.ground = grounds[Number(select.value)];
    draw();
  });
  return make("label", {}, "Under it ", select);
}

function scanChoice(replay: Replay, shown: Shown, draw: () => void): HTMLElement {
  const select = make("select");
  if (replay.truth) select.append(make("option", { value: "" }, "where the robot is"));
  replay.runs.forEach(({ name }, index) => select.append(make("option", { value: String(index) }, `where ${name} has it`)));
  select.addEventListener("change", () => {
    shown.scanFrom = select.value === "" ? null : replay.runs[Number(select.value)];
    draw();
  });
  return make("label", {}, "Scan from ", select);
}
