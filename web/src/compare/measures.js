// The table of how far runs and measured counts are from the reference, as the server measures it.

import { getJson } from "../base/api.js";
import { h } from "../base/dom.js";
import { fixed, nameOf, number, parts } from "../base/format.js";
import { isOneWay } from "../plot/series.js";

// [what it is, its unit, its value of one column]. A column: { entry, curve, density }, entry being of the run alone.
// What no column has is left out.
const rows = [
  ["Mean gap (L1)", "parts", ({ curve }) => curve && parts(curve.l1, 3)],
  ["RMS gap (L2)", "parts", ({ curve }) => curve && parts(curve.l2, 3)],
  ["Largest gap", "parts", ({ curve }) => curve && `${parts(curve.largest, 3)} at ${fixed(curve.largest_at_s, 2)} s`],
  ["Drained (99 %) at", "s", ({ entry }) => (entry?.parts_end < entry?.parts_start ? drainOf(entry) : null)],
  ["Throughput, 10 to 90 %", "parts/s", ({ entry }) => entry && number(entry.throughput_per_s)],
  ["Density gap, mean", "% of close packing", ({ density }) => density && percentOf(density.mean_abs)],
  ["Densities not in common", "%", ({ density }) => density && percentOf(density.l1)],
  ["Shift along the belt", "mm", ({ density }) => density && millimetres(density.emd_x_m)],
  ["Shift across the belt", "mm", ({ density }) => density && millimetres(density.emd_y_m)],
];

const drainOf = ({ drain_time_s: t }) => (t === null ? "not yet" : fixed(t, 2));
const percentOf = (share) => (Number.isFinite(share) ? number(100 * share) : null);
const millimetres = (m) => (Number.isFinite(m) ? number(1000 * m) : null);

export class MeasuresTable {
  constructor() {
    this.body = h("tbody");
    this.head = h("tr");
    this.note = h("p", { class: "hint" });
    this.element = h("div", { class: "measures-box" },
      h("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": "Table of measures" },
        h("table", { class: "measures" }, h("thead", {}, this.head), this.body)), this.note);
  }

  // heads: a heading for each column, an element; runs: RunData, of which runs[reference] is compared with; measured: counts of
  // the column, behind the runs. An answer that comes after the next call is not shown.
  async load({ runs, reference, column, measured, headOf }) {
    const mine = Symbol("the last call");
    this.last = mine;
    const others = [...runs.map(({ id, run }) => ({ id, name: nameOf(run) })), ...measured.map(({ id, label }) => ({ id, name: label }))];
    const columns = others.map(() => ({}));
    const faults = [];
    // The figures of an entry suit what only passes.
    const entryOf = (k, entry) => (k >= runs.length || isOneWay(runs[k].scenario, column) ? entry : null);
    await Promise.all(others.map(async ({ id, name }, k) => {
      if (k === reference) return;
      try {
        const { a, b, curve, density } = await getJson(`v1/compare?${new URLSearchParams({ a: runs[reference].id, b: id, column })}`);
        columns[reference].entry = entryOf(reference, a);
        columns[k] = { entry: entryOf(k, b), curve, density: density?.mean ?? null };
      } catch (error) {
        if (error.status !== 0) faults.push(`${name}: ${error.message}`);
      }
    }));
    if (this.last !== mine) return;
    this.note.textContent = faults.join(" ");
    this.show(columns, others.map((other, k) => headOf(k)));
  }

  show(columns, heads) {
    this.head.replaceChildren(h("th", { scope: "col" }, h("span", { class: "hidden" }, "Measure")),
      ...heads.map((head) => h("th", { scope: "col" }, head)));
    const lines = rows.map(([what, unit, value]) => ({ what, unit, cells: columns.map((column) => value(column) ?? null) }));
    this.body.replaceChildren(...lines.filter(({ cells }) => cells.some((cell) => cell !== null && cell !== "–")).map(({ what, unit, cells }) =>
      h("tr", {}, h("th", { scope: "row" }, what, h("small", {}, unit)), cells.map((cell) => h("td", {}, cell ?? "–")))));
  }
}
