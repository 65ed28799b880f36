// Of a calibration: what was counted against what the best point computes, and what the curves say of each parameter.

import { getJson, paths } from "../base/api.js";
import { h } from "../base/dom.js";
import { CurvePlot } from "../plot/curve_plot.js";
import { valueText } from "../scenario/parameters.js";

export class FitPanel {
  constructor(data, words) {
    Object.assign(this, { data, words, plots: [] });
    this.table = h("tbody");
    this.left = h("p", { class: "hint" });
    for (const { counter } of data.document.curves) {
      this.plots.push(new CurvePlot(`Counted and computed, ${counter}`, () => 240, () => {}));
    }
    this.element = h("div", {},
      h("section", { class: "card fit", "aria-labelledby": "fit-title" }, h("h2", { id: "fit-title" }, "Counted and computed"),
        this.plots.map(({ element }) => element), this.left),
      h("section", { class: "card", "aria-labelledby": "fitted-title" }, h("h2", { id: "fitted-title" }, "Parameters"),
        h("div", { class: "scroll" }, h("table", { class: "measures" }, h("thead", {}, h("tr", {},
          ["parameter", "fitted", "interval", "by the counts"].map((text) => h("th", { scope: "col" }, text)))), this.table))));
    this.drawCounts(null);
  }

  dispose() {
    for (const plot of this.plots) plot.dispose();
  }

  drawCounts(curve) {
    this.data.document.curves.forEach(({ counter, t_s: t, count: v }, k) => {
      const rows = [{ name: "counted", color: "text", points: true, t, v }];
      if (curve) rows.push({ name: "computed", color: "run-1", dash: [], t: curve.t_s, v: curve.columns[counter] });
      this.plots[k].setCurves(rows, t.at(-1));
    });
  }

  show(found) {
    if (!found?.best) return;
    this.showTable(found);
    this.showCurve(found.best.point);
  }

  showTable({ best, profiles = [], left_out: leftOut = [] }) {
    const rows = Object.entries(best.parameters).map(([pointer, value]) => {
      const { label, unit } = this.words.get(pointer);
      const profile = profiles.find((one) => one.pointer === pointer);
      const [low, high] = profile?.interval ?? [null, null];
      const end = (bound) => (bound === null ? "open" : valueText(bound, ""));
      return h("tr", {}, h("th", { scope: "row" }, label), h("td", {}, valueText(value, unit)),
        h("td", {}, profile ? `${end(low)} to ${end(high)}` : "not known yet"),
        h("td", {}, profile ? (profile.is_identifiable ? "determined" : "not determined") : "–"));
    });
    this.table.replaceChildren(...rows);
    const known = leftOut.filter(({ rmse }) => rmse !== null);
    this.left.textContent = known.map(({ counter, rmse }) =>
      `Predicted from the other curves, ${counter} is ${valueText(rmse, "parts")} off.`).join(" ");
  }

  // The curve of the best point's trial; its run has no more than that.
  async showCurve(point) {
    const trial = this.data.ended().find((one) => one.point === point && one.run);
    if (!trial || trial.run === this.shown) return;
    this.shown = trial.run;
    try {
      this.drawCounts(await getJson(paths.of(trial.run, "curve")));
    } catch {
      this.shown = null; // its run was removed, or the server is away
    }
  }
}
