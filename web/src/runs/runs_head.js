// The head of the list of runs: a press on a column sorts by it, a second one the other way round. Key figures are sorted by the
// server; parameters here, where all runs of the list stand on one page.

import { h } from "../base/dom.js";
import { columns, titleOfLabel } from "./runs_columns.js";

const PREFIX = "parameter:";
const NEWEST = "-created";

// The label of the parameter by which is sorted; null: by something that the server sorts.
export function parameterOf(sort) {
  const word = (sort ?? "").replace(/^-/, "");
  return word.startsWith(PREFIX) ? word.slice(PREFIX.length) : null;
}

function compare(a, b) {
  return typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
}

// Runs in the order of valueOf(run); those without a value come last.
export function sortedBy(runs, sort, valueOf) {
  const sign = sort.startsWith("-") ? -1 : 1;
  const isKnown = (run) => valueOf(run) !== undefined;
  return [...runs.filter(isKnown).sort((a, b) => sign * compare(valueOf(a), valueOf(b))), ...runs.filter((run) => !isKnown(run))];
}

export class RunsHead {
  // onSort(sort), as it stands in the address.
  constructor(onSort) {
    this.onSort = onSort;
    this.sorters = new Map(); // what is sorted by -> its header
    const hidden = (name) => h("th", { role: "columnheader", scope: "col" }, h("span", { class: "hidden" }, name));
    const headers = columns.map((column) => this.header(column));
    [this.first] = headers;
    this.parameters = [];
    this.element = h("thead", { role: "rowgroup" }, h("tr", { role: "row" }, hidden("Select"), headers, hidden("Actions")));
  }

  header({ name, sort, begins, title, kind }) {
    const header = h("th", { role: "columnheader", scope: "col", title, class: kind },
      sort ? h("button", { type: "button", class: "sorter", on: { click: () => this.press(sort, begins) } }, name) : name);
    if (sort) this.sorters.set(sort, header);
    return header;
  }

  press(sort, begins = "") {
    const other = begins ? sort : `-${sort}`;
    this.onSort(this.now === `${begins}${sort}` ? other : `${begins}${sort}`);
  }

  // Columns of parameters behind the name. isWhole: they can be sorted by.
  showParameters(labels, isWhole) {
    const key = JSON.stringify([labels, isWhole]);
    if (this.shown === key) return;
    this.shown = key;
    for (const header of this.parameters) header.remove();
    for (const sort of this.sorters.keys()) if (parameterOf(sort) !== null) this.sorters.delete(sort);
    this.parameters = labels.map((label) => this.header({ name: titleOfLabel(label), sort: isWhole ? `${PREFIX}${label}` : null, kind: "right",
      title: isWhole ? null : "To sort by it, filter the list until it fits on one page" }));
    this.first.after(...this.parameters);
    this.showSorting(this.now);
  }

  showSorting(now) {
    this.now = now ?? NEWEST;
    for (const [sort, header] of this.sorters) {
      if (this.now === sort || this.now === `-${sort}`) header.setAttribute("aria-sort", this.now === sort ? "ascending" : "descending");
      else header.removeAttribute("aria-sort");
    }
  }
}
