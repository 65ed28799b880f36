// The table of how far runs are apart: each against the first, as the daemon measures it; and measured
// counts against the first, by the same definitions.

import { getJson } from "./api.js";
import { h } from "./dom.js";
import { fixed, nameOf, number } from "./format.js";
import { measureGap } from "./series.js";

// [what it is, its unit, its value of one column]. A column: { curve, density, rate, drain }. What no
// column has is left out.
const rows = [
  ["Mean gap (L1)", "parts", ({ curve }) => curve && fixed(curve.l1, 2)],
  ["RMS gap (L2)", "parts", ({ curve }) => curve && fixed(curve.l2, 2)],
  ["Largest gap", "parts", ({ curve }) => curve && `${fixed(curve.largest, 2)} at ${fixed(curve.largest_at_s, 2)} s`],
  ["Drained (99 %) at", "s", ({ drain }) => (drain === null ? "not yet" : drain === undefined ? null : fixed(drain, 2))],
  ["Throughput", "parts/s", ({ rate }) => (rate === undefined ? null : fixed(rate, 2))],
  ["Density gap, mean", "% of close packing", ({ density }) => density && percentOf(density.mean_abs)],
  ["Densities not in common", "%", ({ density }) => density && percentOf(density.l1)],
  ["Shift along the belt", "mm", ({ density }) => density && millimetres(density.emd_x_m)],
  ["Shift across the belt", "mm", ({ density }) => density && millimetres(density.emd_y_m)],
];

const percentOf = (share) => (Number.isFinite(share) ? number(100 * share) : null);
const millimetres = (m) => (Number.isFinite(m) ? number(1000 * m) : null);

// The measures of the densities as means over the common snapshots; null: the grids differ.
function meanDensity(density) {
  const snapshots = density?.snapshots ?? [];
  if (density?.mean || snapshots.length === 0) return density?.mean ?? null;
  return { mean_abs: snapshots.reduce((sum, snapshot) => sum + snapshot.mean_abs, 0) / snapshots.length };
}

export class MeasuresTable {
  constructor(runs) {
    this.runs = runs;
    this.columns = runs.map(() => ({}));
    this.measured = null;
    this.body = h("tbody");
    this.head = h("tr");
    this.note = h("p", { class: "hint" });
    this.element = h("div", { class: "measures-box" },
      h("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": "Table of measures" },
        h("table", { class: "measures" }, h("thead", {}, this.head), this.body)), this.note);
  }

  // A column whose counts rise has no drain time, and a rate the other way round.
  async load(column) {
    const [first, ...others] = this.runs;
    this.isRising = !this.runs.some(({ scenario }) => scenario.counters.some(({ id }) => id === column));
    const faults = [];
    await Promise.all(others.map(async (other, k) => {
      const query = new URLSearchParams({ a: first.id, b: other.id, column });
      try {
        this.take(k + 1, await getJson(`v1/compare?${query}`));
      } catch (error) {
        this.columns[k + 1] = {};
        if (error.status !== 0) faults.push(`${nameOf(other.run)}: ${error.message}`);
      }
    }));
    this.note.textContent = faults.join(" ");
    this.show();
  }

  take(k, { curve, density }) {
    this.columns[0] = this.rateOf(curve.rate_a_per_s, curve.drain_time_a_s);
    this.columns[k] = { curve, density: meanDensity(density), ...this.rateOf(curve.rate_b_per_s, curve.drain_time_b_s) };
  }

  rateOf(rate, drain) {
    return this.isRising ? { rate: -rate } : { rate, drain };
  }

  // Counts from elsewhere against the first run's curve; null: none.
  setMeasured(curve, first) {
    this.measured = null;
    if (curve && first.t.length > 0) {
      const gap = measureGap(first, curve);
      this.measured = gap ? { curve: gap, ...this.rateOf(gap.rate_per_s, gap.drain_time_s) } : {};
    }
    this.show();
  }

  show() {
    const columns = [...this.columns, ...(this.measured ? [this.measured] : [])];
    const mark = (k) => h("i", { class: "mark", "aria-hidden": "true", data: { run: String(k + 1) } });
    const names = this.runs.map(({ run }, k) => h("th", { scope: "col" }, h("span", { class: "together" }, mark(k), run.model),
      h("small", {}, k === 0 ? "reference" : run.label || nameOf(run))));
    if (this.measured) names.push(h("th", { scope: "col" },
      h("span", { class: "together" }, h("i", { class: "mark dots", "aria-hidden": "true" }), "measured")));
    this.head.replaceChildren(h("th", { scope: "col" }, h("span", { class: "hidden" }, "Measure")), ...names);
    const lines = rows.map(([what, unit, value]) => ({ what, unit, cells: columns.map((column) => value(column) ?? null) }));
    this.body.replaceChildren(...lines.filter(({ cells }) => cells.some((cell) => cell !== null)).map(({ what, unit, cells }) =>
      h("tr", {}, h("th", { scope: "row" }, what, h("small", {}, unit)), cells.map((cell) => h("td", {}, cell ?? "–")))));
  }
}
