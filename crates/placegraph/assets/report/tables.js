// Tables whose headings sort.

import { element, number } from "../viewer/dom.js";

/** A column of text. */
export const textColumn = (name, key) => ({ name, key, cell: (cell, row) => { cell.textContent = key(row); } });

/** A column of figures with `digits` after the point. */
export const figureColumn = (name, key, digits) => ({
  name, key: (row) => key(row) ?? -1, isNumber: true, cell: (cell, row) => { cell.textContent = number(key(row), digits); },
});

/** Fills the table `target`; returns what fills it again after `isShown` changed its mind. */
export function table(target, columns, all, isShown = () => true) {
  const rows = [...all];
  const head = element(element(target, "thead"), "tr");
  const body = element(target, "tbody");
  const fill = () => {
    body.replaceChildren();
    for (const row of rows.filter(isShown)) {
      const line = element(body, "tr", { id: row.id && `row-${row.id}` });
      for (const column of columns) column.cell(element(line, "td", { class: column.isNumber && "number" }), row);
    }
  };
  for (const column of columns) {
    const cell = element(head, "th", { scope: "col", class: column.isNumber && "number" });
    let up = false;
    element(cell, "button", {
      type: "button",
      onclick: () => {
        up = !up;
        const { key } = column;
        rows.sort((a, b) => (key(a) > key(b) ? 1 : key(a) < key(b) ? -1 : 0) * (up ? 1 : -1));
        for (const other of head.querySelectorAll("th")) other.removeAttribute("aria-sort");
        cell.setAttribute("aria-sort", up ? "ascending" : "descending");
        fill();
      },
    }, column.name);
  }
  fill();
  return fill;
}
