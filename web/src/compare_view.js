// Two to four runs side by side under one clock, their curves in one plot, and the daemon's measures of how
// far they are apart. Counts that were measured on a real belt can be laid over.

import { isOver, listRuns } from "./api.js";
import { Cinema } from "./cinema.js";
import { CurvePlot } from "./curve_plot.js";
import { h, iconButton, link, setText } from "./dom.js";
import { follow } from "./events.js";
import { age, nameOf } from "./format.js";
import { MeasuresTable } from "./measures.js";
import { address, go, note } from "./router.js";
import { isGoing } from "./run_actions.js";
import { RunData } from "./run_data.js";
import { statePill } from "./runs_table.js";
import { ScaleBar } from "./scale_bar.js";
import { columnsOf, flowOf, isFed, readMeasured } from "./series.js";
import { DASHES } from "./theme.js";
import { toast } from "./toast.js";
import { segments } from "./transport.js";

export const COMPARED_MAX = 4;
const flowDashes = { exits: DASHES[0], admitted: DASHES[1], offered: DASHES[2], waiting: DASHES[3], discarded: [1, 4] };

export class CompareView {
  constructor() {
    this.title = "Compare";
  }

  async mount(root, { query }) {
    this.query = query;
    this.ids = [...new Set((query.get("runs") ?? "").split(",").filter(Boolean))].slice(0, COMPARED_MAX);
    this.cinema = new Cinema();
    this.measured = null;
    root.append(h("p", { class: "loading" }, "Loading …"));
    this.runs = this.ids.map((id) => new RunData(id));
    const [{ runs: recent }] = await Promise.all([listRuns({ limit: 100 }), ...this.runs.map((data) => data.load())]);
    if (this.isGone) return;
    this.recent = recent.filter((run) => !isGoing(run.id));
    root.replaceChildren(...this.build());
    this.start();
  }

  unmount() {
    this.isGone = true;
    this.stopEvents?.();
    this.plot?.dispose();
    this.cinema?.dispose();
  }

  build() {
    const head = h("div", { class: "view-head" }, h("h1", {}, "Compare runs"), this.picker());
    if (this.runs.length === 0) return [head, this.invitation()];
    this.cinema.map = this.query.get("map") === "grey" ? "grey" : "viridis";
    this.cinema.layer = this.query.get("layer") ?? undefined;
    const panels = this.runs.map((data, k) => this.panel(data, k));
    const parts = [head, h("div", { class: "panels", data: { n: String(panels.length) } }, panels), this.controls()];
    if (this.runs.length === 1) parts.push(h("p", { class: "notice" }, "Add another run to compare it with this one."));
    parts.push(h("div", { class: "beside" }, this.curves(), this.measures()));
    return parts;
  }

  invitation() {
    return h("section", { class: "card empty" },
      h("p", {}, "Add two to four runs here, or select them in the list of runs."),
      link("#/", "Choose from the list", { class: "button" }));
  }

  picker() {
    if (this.ids.length >= COMPARED_MAX) return null;
    const others = this.recent.filter((run) => !this.ids.includes(run.id));
    const box = h("select", { disabled: others.length === 0,
      on: { change: () => box.value && this.show([...this.ids, box.value]) } },
      h("option", { value: "" }, others.length === 0 ? "no other run" : "choose a run"),
      others.map((run) => h("option", { value: run.id },
        `${nameOf(run)} · ${run.model}${run.label ? ` · ${run.label}` : ""} · ${age(run.created_at)}`)));
    return h("label", { class: "field inline" }, h("span", {}, "Add"), box);
  }

  show(ids) {
    go(address("compare", "", { ...Object.fromEntries(this.query), t: "", runs: ids.join(",") }));
  }

  panel(data, k) {
    const { run } = data;
    const name = nameOf(run);
    const most = () => Math.max(180, innerHeight * (this.runs.length > 2 ? 0.36 : 0.46));
    const screen = this.cinema.add(data, `The belt from above, ${name}, ${run.model}`, most);
    data.state = statePill(run);
    data.state.show(run);
    const mark = h("i", { class: "mark", "aria-hidden": "true" });
    mark.dataset.run = String(k + 1);
    data.wait = h("p", { class: "stage-wait", role: "status" });
    return h("section", { class: "card panel", "aria-label": `${name}, ${run.model}` },
      h("div", { class: "panel-head" }, mark,
        h("div", { class: "panel-name" }, link(address("runs", run.id), name),
          h("span", { class: "meta" }, h("span", { class: "model", data: { model: run.model } }, run.model),
            run.label ? h("span", { class: "label" }, run.label) : null, data.state.pill)),
        iconButton("close", `Remove ${name}`, () => this.show(this.ids.filter((id) => id !== run.id)), { class: "bare" })),
      h("div", { class: "stage-box" }, screen.stage.element, data.wait));
  }

  controls() {
    const { cinema } = this;
    this.scale = new ScaleBar((map) => {
      cinema.setMap(map);
      note({ map: map === "viridis" ? "" : map });
      this.showScale();
    });
    const layers = this.runs.some((data) => data.hasParts())
      ? segments("Microscopic runs show", [["both", "Parts over density"], ["parts", "Parts"], ["density", "Density"]],
        cinema.layer ?? "both", (layer) => {
          cinema.setLayer(layer);
          note({ layer: layer === "both" ? "" : layer });
        }).element
      : null;
    return h("section", { class: "card controls", "aria-label": "Animation" }, cinema.transport.element,
      h("div", { class: "row" }, this.scale.element, layers));
  }

  curves() {
    this.plot = new CurvePlot("Outflow curves of the runs", () => (innerWidth < 1000 ? 260 : 340),
      (t) => this.cinema.player.seek(t));
    const file = h("input", { type: "file", accept: ".csv,text/csv", class: "hidden",
      on: { change: () => file.files[0] && this.lay(file.files[0]) } });
    this.unlay = h("button", { type: "button", class: "quiet", hidden: true, on: { click: () => this.setMeasured(null) } },
      "Remove measured counts");
    const card = h("section", { class: "card curve", "aria-labelledby": "curve-title" },
      h("h2", { id: "curve-title" }, "Curves"), this.columnBox(), this.plot.element,
      h("p", { class: "row hint" },
        h("label", { class: "button" }, file, "Lay measured counts over"), this.unlay,
        h("span", {}, "or drop a CSV with the header ", h("code", {}, "t_s,count"), " here.")));
    card.addEventListener("dragover", (event) => {
      event.preventDefault();
      card.classList.add("dropping");
    });
    card.addEventListener("dragleave", () => card.classList.remove("dropping"));
    card.addEventListener("drop", (event) => {
      event.preventDefault();
      card.classList.remove("dropping");
      if (event.dataTransfer.files[0]) this.lay(event.dataTransfer.files[0]);
    });
    return card;
  }

  // Which column of the curves is shown; "" is the flow of runs with feeds: four columns at once.
  columnBox() {
    const hasFlow = this.runs.some(({ scenario }) => isFed(scenario));
    this.column = this.query.get("column") ?? (hasFlow ? "" : this.runs[0].scenario.counters[0].id);
    const columns = new Map([...(hasFlow ? [["", "offered, admitted, waiting and exits"]] : []),
      ...this.runs.flatMap(({ scenario }) => columnsOf(scenario))]);
    const box = h("select", { on: { change: () => {
      this.column = box.value;
      note({ column: box.value });
      this.showCurves();
      this.table.load(this.measuredColumn());
    } } }, [...columns].map(([name, words]) => h("option", { value: name }, words)));
    box.value = this.column;
    return h("label", { class: "field inline" }, h("span", {}, hasFlow ? "Curves" : "Counter"), box);
  }

  // Measures are of one column; those of a flow are of its exits.
  measuredColumn() {
    return this.column || "left_domain";
  }

  measures() {
    this.table = new MeasuresTable(this.runs);
    return h("section", { class: "card", "aria-labelledby": "measures-title" },
      h("h2", { id: "measures-title" }, "Measures"), this.table.element);
  }

  async lay(file) {
    try {
      this.setMeasured({ ...readMeasured(await file.text()), file: file.name });
    } catch (error) {
      toast(`${file.name}: ${error.message}`, { isFault: true });
    }
  }

  setMeasured(curve) {
    this.measured = curve;
    this.unlay.hidden = curve === null;
    this.showCurves();
  }

  start() {
    const { cinema, runs } = this;
    if (runs.length === 0) return;
    cinema.onUpdate = () => this.update();
    for (const data of runs) data.onChange = (what) => this.change(data, what);
    cinema.refresh();
    this.showCurves();
    this.showScale();
    this.table.load(this.measuredColumn());
    const active = runs.filter(({ run }) => !isOver(run));
    if (active.length > 0) {
      this.stopEvents = follow(active.map(({ id }) => id), (kind, event) =>
        active.find(({ id }) => id === event.run)?.take(kind, event));
    }
    cinema.begin(this.query);
  }

  change(data, what) {
    if (this.isGone) return;
    if (what === "curve") this.showCurves();
    if (what === "snapshots") this.showSnapshots();
    if (what === "run") data.state.show(data.run);
    if (what === "summary") {
      data.state.show(data.run);
      this.showSnapshots();
      this.table.load(this.measuredColumn());
    }
    this.showScale();
  }

  showSnapshots() {
    const before = this.cinema.axisEnd;
    this.cinema.refresh();
    if (this.cinema.axisEnd !== before) this.showCurves();
  }

  showCurves() {
    const { measured } = this;
    const curves = this.runs.flatMap((data, k) => (this.column ? this.columnCurve(data, k) : this.flowCurves(data, k)))
      .filter(({ v }) => v.length > 0);
    if (measured) {
      curves.push({ name: `measured: ${measured.file}`, group: this.column ? null : "Measured", color: "text", points: true,
        t: measured.t, v: measured.v });
    }
    this.plot.setCurves(curves, this.cinema.axisEnd || Math.max(...this.runs.map(({ scenario }) => scenario.duration_s)));
    const { curve } = this.runs[0];
    this.table.setMeasured(measured, { t: curve.t, v: this.valuesOf(this.runs[0]) });
  }

  // A run whose scenario has no such column shows its first counter.
  valuesOf({ curve, scenario }) {
    return curve.columns.get(this.measuredColumn()) ?? curve.columns.get(scenario.counters[0].id) ?? [];
  }

  columnCurve(data, k) {
    return [{ name: `${nameOf(data.run)} (${data.run.model})`, color: `run-${k + 1}`, dash: DASHES[k], t: data.curve.t,
      v: this.valuesOf(data) }];
  }

  // The colour is the run's, the dash tells what is counted.
  flowCurves({ run, curve, scenario }, k) {
    return flowOf(scenario, curve).map(([name, v]) => ({ name, group: `${nameOf(run)} (${run.model})`, color: `run-${k + 1}`,
      dash: flowDashes[name], t: curve.t, v }));
  }

  showScale() {
    const { macro } = this.runs[0].scenario;
    this.scale.set(this.cinema.map, this.cinema.scaleEnd(), macro.packing_density_per_m2);
  }

  update() {
    const { player, screens } = this.cinema;
    this.plot.showTime(player.t);
    for (const { data, stage, reel } of screens) {
      const problem = reel.problemAt(player.t);
      setText(data.wait, problem ? problem.message : stage.picture ? "" : data.run.status === "queued"
        ? "Waiting for its turn …" : isOver(data.run) && data.snapshots.length === 0 ? "There are no snapshots." : "Loading …");
      data.wait.hidden = data.wait.textContent === "";
    }
  }
}
