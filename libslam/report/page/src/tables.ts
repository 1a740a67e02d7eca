import { make } from "./dom";

const kRowsWorthFiltering = 5;
const kMostChoices = 40;

/** What sorts a cell: its number, NaN where it has none; text as text. */
function keyOf(cell: HTMLElement): number | string {
  return cell.dataset.value === undefined ? (cell.textContent ?? "") : Number(cell.dataset.value);
}

function compare(a: number | string, b: number | string, direction: number): number {
  if (typeof a === "string" && typeof b === "string") return direction * a.localeCompare(b, "en", { numeric: true });
  // Numbers before words, whichever way it is sorted: "failed" is worse than any.
  if (typeof a === "string" || typeof b === "string") return typeof a === "string" ? 1 : -1;
  // Rows without a figure come last, whichever way it is sorted.
  if (Number.isNaN(a) || Number.isNaN(b)) return Number(Number.isNaN(a)) - Number(Number.isNaN(b));
  return direction * (a - b);
}

function makeSortable(table: HTMLTableElement): void {
  const body = table.tBodies[0];
  const heads = Array.from(table.tHead!.rows[0].cells);
  heads.forEach((head, index) => {
    const button = make("button", { type: "button" }, head.textContent ?? "");
    button.addEventListener("click", () => {
      const ascending = head.getAttribute("aria-sort") !== "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", ascending ? "ascending" : "descending");
      const rows = Array.from(body.rows);
      rows.sort((a, b) => compare(keyOf(a.cells[index]), keyOf(b.cells[index]), ascending ? 1 : -1));
      body.append(...rows);
    });
    head.replaceChildren(button);
  });
}

/** Columns of names that repeat, such as worlds and methods, by what they are called. */
function choicesOf(rows: HTMLTableRowElement[], heads: HTMLTableCellElement[]): Map<number, string[]> {
  const choices = new Map<number, string[]>();
  heads.forEach((head, index) => {
    const texts = rows.map((row) => row.cells[index].textContent ?? "");
    const isName = rows.every((row) => row.cells[index].dataset.value === undefined) || head.dataset.filter !== undefined;
    const different = Array.from(new Set(texts));
    if (isName && different.length > 1 && different.length < rows.length && different.length <= kMostChoices)
      choices.set(index, different);
  });
  return choices;
}

function makeFilterable(table: HTMLTableElement): void {
  const rows = Array.from(table.tBodies[0].rows);
  if (rows.length < kRowsWorthFiltering) return;
  const heads = Array.from(table.tHead!.rows[0].cells);
  const wanted = new Map<number, string>();
  const input = make("input", { type: "search" });
  const count = make("output", { class: "note" });
  const apply = (): void => {
    const text = input.value.trim().toLowerCase();
    let shown = 0;
    for (const row of rows) {
      const fits = Array.from(wanted).every(([index, value]) => row.cells[index].textContent === value);
      row.hidden = !fits || !(row.textContent ?? "").toLowerCase().includes(text);
      if (!row.hidden) ++shown;
    }
    count.textContent = shown < rows.length ? `${shown} of ${rows.length} rows` : "";
  };
  input.addEventListener("input", apply);
  const bar = make("div", { class: "bar filter", role: "group", "aria-label": `Rows of: ${table.caption?.textContent ?? ""}` });
  for (const [index, values] of choicesOf(rows, heads)) {
    const select = make("select", {}, make("option", { value: "" }, "any"));
    values.forEach((value, i) => select.append(make("option", { value: String(i) }, value)));
    select.addEventListener("change", () => {
      if (select.value === "") wanted.delete(index);
      else wanted.set(index, values[Number(select.value)]);
      apply();
    });
    bar.append(make("label", {}, `${heads[index].textContent} `, select));
  }
  bar.append(make("label", {}, "Rows with ", input), count);
  table.parentElement!.before(bar);
}

export function enliven(): void {
  for (const table of document.querySelectorAll<HTMLTableElement>("table.sortable")) {
    makeFilterable(table);
    makeSortable(table);
  }
}
