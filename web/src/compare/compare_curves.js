// The curves of compared runs in one plot: as they are, as differences from the reference, or as flow rates; with counts that
// were measured on a real belt, stored by the server and named in the address.

import { h, iconButton } from "../base/dom.js";
import { note } from "../base/router.js";
import { DASHES } from "../base/theme.js";
import { tellFault, toast } from "../base/toast.js";
import { segments } from "../player/transport.js";
import { CurvePlot } from "../plot/curve_plot.js";
import { columnsOf, differenceOf, flowOf, isFed, isOneWay, rateOf, shifted } from "../plot/series.js";
import { fileButton, listMeasured, loadMeasured, storeCurve, storeFile, storeMeasured } from "./measured.js";
import { askForCounts } from "./paste_counts.js";
import { askForShift } from "./shift_counts.js";

const flowDashes = { "left the belt": DASHES[0], admitted: DASHES[1], offered: DASHES[2], waiting: DASHES[3], discarded: [1, 4] };
const EXITS = "left_domain";
const plots = [["counts", "Counts"], ["difference", "Difference"], ["rate", "Flow rate"]];
const units = { counts: "Parts", difference: "Parts more than the reference", rate: "Parts/s" };

export class CompareCurves {
  // runs: RunData; titles: their names in the legend; query: of the address; onSeek(t); onChange(): another column or other
  // counts are shown.
  constructor({ runs, titles, query, onSeek, onChange }) {
    Object.assign(this, { runs, titles, onChange, reference: 0, end: 0, measured: [] });
    this.plot = new CurvePlot("Curves of the runs", () => (innerWidth < 1000 ? 260 : 340), onSeek);
    this.hasFlow = runs.some(({ scenario }) => isFed(scenario));
    this.column = query.get("column") ?? (this.hasFlow ? "" : runs[0].scenario.counters[0].id);
    this.shown = units[query.get("plot")] ? query.get("plot") : "counts";
    this.element = this.build();
    this.loadMeasured((query.get("measured") ?? "").split(",").filter(Boolean), query.has("column"));
  }

  dispose() {
    this.isGone = true;
    this.plot.dispose();
  }

  build() {
    const choice = segments("Plot", plots, this.shown, (shown) => {
      this.shown = shown;
      note({ plot: shown === "counts" ? "" : shown });
      this.show();
    });
    this.laid = h("ul", { class: "chips", "aria-label": "Measured counts" });
    const card = h("section", { class: "card curve", "aria-labelledby": "curve-title" },
      h("div", { class: "card-head" }, h("h2", { id: "curve-title" }, "Curves"), choice.element),
      this.columnBox(), this.plot.element, this.laid, this.measuredRow());
    for (const type of ["dragover", "dragleave", "drop"]) card.addEventListener(type, (event) => {
      event.preventDefault();
      card.classList.toggle("dropping", type === "dragover");
      if (type === "drop" && event.dataTransfer.files[0]) this.layFile(event.dataTransfer.files[0]);
    });
    return card;
  }

  // Which column of the curves is shown; "" is the flow of runs with feeds: four columns at once.
  columnBox() {
    const columns = new Map([...(this.hasFlow ? [["", "offered, admitted, waiting and left the belt"]] : []),
      ...this.runs.flatMap(({ scenario }) => columnsOf(scenario))]);
    this.box = h("select", { on: { change: () => this.choose(this.box.value) } },
      [...columns].map(([name, words]) => h("option", { value: name }, words)));
    this.box.value = this.column;
    return h("label", { class: "field inline" }, h("span", {}, this.hasFlow ? "Curves" : "Counter"), this.box);
  }

  choose(column) {
    this.column = column;
    this.box.value = column;
    note({ column });
    this.show();
    this.onChange();
  }

  measuredRow() {
    const stored = h("select", { "aria-label": "Stored counts", hidden: true,
      on: { change: () => stored.value && this.loadMeasured([stored.value]) } });
    listMeasured().then((list) => {
      stored.hidden = list.length === 0;
      stored.replaceChildren(h("option", { value: "" }, "Stored counts …"),
        ...list.map(({ id, label, counter }) => h("option", { value: id }, `${label || id.slice(-8)} (${counter})`)));
    }).catch(() => {}); // without the list counts can still be laid over
    return h("p", { class: "row hint" }, fileButton("Lay measured counts over", (file) => this.layFile(file)),
      h("button", { type: "button", on: { click: () => this.paste() } }, "Paste counts …"), stored,
      h("span", {}, "or drop a CSV here: times in seconds, then counts of parts."));
  }

  // Measures and measured counts are of one column; those of a flow are of what left.
  measuredColumn() {
    return this.column || EXITS;
  }

  // Measured counts of the column that is shown.
  measuredHere() {
    return this.measured.filter(({ counter }) => counter === this.measuredColumn());
  }

  // Counts whose column is called like a counter are bound to that, others to the one that is shown; store(counter, isColumn)
  // stores them.
  async lay(store) {
    try {
      const isColumn = (wanted) => this.runs.some(({ scenario }) => columnsOf(scenario).some(([name]) => name === wanted));
      this.add(await store(this.measuredColumn(), isColumn));
    } catch (error) {
      tellFault(error);
    }
  }

  layFile(file) {
    this.lay((counter, isColumn) => storeFile(file, counter, isColumn));
  }

  async paste() {
    const curve = await askForCounts();
    if (curve) this.lay((counter, isColumn) => storeCurve(curve, "pasted counts", counter, isColumn));
  }

  // Shifted counts are stored as others, so that all that is made of counts goes by them.
  async shift(curve) {
    const by = await askForShift(curve, this.curveOf(this.runs[this.reference], this.reference, curve.counter));
    if (by === null) return;
    try {
      const moved = await storeMeasured(shifted(curve, by), `${curve.label}, ${Math.abs(by)} s ${by > 0 ? "later" : "earlier"}`, curve.counter);
      this.setMeasured(this.measured.map((one) => (one === curve ? moved : one)));
    } catch (error) {
      tellFault(error);
    }
  }

  async loadMeasured(ids, isColumnChosen = false) {
    for (const id of ids) {
      try {
        this.add(await loadMeasured(id), isColumnChosen);
      } catch (error) {
        if (error.status === 404) toast("Measured counts of this address were deleted.", { isFault: true });
        else tellFault(error);
      }
    }
  }

  // Shows their counter, unless the address says which one is shown.
  add(curve, isColumnChosen = false) {
    if (this.isGone) return;
    this.setMeasured([...this.measured.filter(({ id }) => id !== curve.id), curve]);
    if (!isColumnChosen && curve.counter !== this.measuredColumn()) this.choose(curve.counter);
  }

  setMeasured(list) {
    this.measured = list;
    note({ measured: list.map(({ id }) => id).join(",") });
    this.laid.replaceChildren(...list.map((curve) => h("li", { class: "chip" }, `${curve.label} · ${curve.counter}`,
      h("button", { type: "button", class: "quiet", on: { click: () => this.shift(curve) } }, "Shift …"),
      iconButton("close", `Remove ${curve.label}`, () => this.setMeasured(this.measured.filter(({ id }) => id !== curve.id)), { class: "bare" }))));
    this.show();
    this.onChange();
  }

  // end: of the axis of time.
  setEnd(end) {
    if (end === this.end) return;
    this.end = end;
    this.show();
  }

  setReference(k) {
    this.reference = k;
    this.show();
  }

  show() {
    const isFlow = this.column === "" && this.shown === "counts";
    const curves = [...this.runs.flatMap((data, k) => (isFlow ? this.flowCurves(data, k) : [this.curveOf(data, k)])),
      ...this.measuredHere().map((curve) => ({ name: `measured: ${curve.label}`, group: isFlow ? "Measured" : null, color: "text",
        points: this.shown !== "rate", column: curve.counter, t: curve.t, v: curve.v }))];
    const shown = isFlow ? curves : this.derived(curves);
    this.plot.setCurves(shown.filter(({ v }) => v.length > 0), this.end, units[this.shown]);
  }

  // Differences need the reference, rates what only passes: of other columns what left.
  derived(curves) {
    if (this.shown === "rate") return curves.map((curve) => ({ ...curve, ...rateOf(curve) }));
    if (this.shown !== "difference") return curves;
    const { t, v } = curves[this.reference];
    return curves.filter((curve, k) => k !== this.reference).map((curve) => ({ ...curve, ...differenceOf(curve, { t, v }) }));
  }

  // A run whose scenario has no such column shows its first counter.
  curveOf({ curve, scenario }, k, wanted = this.measuredColumn()) {
    const column = this.shown === "rate" && !isOneWay(scenario, wanted) ? EXITS : wanted;
    return { name: this.titles[k], color: `run-${k + 1}`, dash: DASHES[k], t: curve.t,
      v: curve.columns.get(column) ?? curve.columns.get(scenario.counters[0].id) ?? [] };
  }

  // The colour is the run's, the dash tells what is counted.
  flowCurves({ curve, scenario }, k) {
    return flowOf(scenario, curve).map(([name, v]) => ({ name, group: this.titles[k], color: `run-${k + 1}`,
      dash: flowDashes[name], t: curve.t, v }));
  }
}
