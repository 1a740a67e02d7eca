import { make } from "./dom";

const kRowsWorthFiltering = 5;

/** What sorts a cell: its number, NaN where it has none; text as text. */
function keyOf(cell: HTMLElement): number | string {
  return cell.dataset.value === undefined ? (cell.textContent ?? "") : Number(cell.dataset.value);
}

function compare(a: number | string, b: number | string, direction: number): number {
  if (typeof a === "string" || typeof b === "string")
    return direction * String(a).localeCompare(String(b), "en", { numeric: true });
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

function makeFilterable(table: HTMLTableElement): void {
  const rows = Array.from(table.tBodies[0].rows);
  if (rows.length < kRowsWorthFiltering) return;
  const input = make("input", { type: "search" });
  input.addEventListener("input", () => {
    const wanted = input.value.trim().toLowerCase();
    for (const row of rows) row.hidden = !(row.textContent ?? "").toLowerCase().includes(wanted);
  });
  table.parentElement!.before(make("label", { class: "filter" }, "Rows with ", input));
}

export function enliven(): void {
  for (const table of document.querySelectorAll<HTMLTableElement>("table.sortable")) {
    makeSortable(table);
    makeFilterable(table);
  }
}
