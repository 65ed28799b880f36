// Two to eight runs side by side under one clock, their curves beside them, below what they come to: key figures, how far they
// agree, and how they were computed.

import { saveReport } from "../actions/report.js";
import { isGoing } from "../actions/run_actions.js";
import { getJson, isBusy, isOver, LATER_MS, listRuns } from "../base/api.js";
import { h, iconButton, link, setText } from "../base/dom.js";
import { follow } from "../base/events.js";
import { age, fileNameOf, modelOf, modelWords, nameOf } from "../base/format.js";
import { address, go, note } from "../base/router.js";
import { statePill } from "../base/run_words.js";
import { Cinema } from "../player/cinema.js";
import { drawPicture } from "../player/picture.js";
import { SceneControls } from "../player/scene_controls.js";
import { KeyTable } from "../run/key_strip.js";
import { RunData } from "../run/run_data.js";
import { fold, solverTable, verdictLines, verdictPanel } from "../run/run_panels.js";
import { chipsOf, differences } from "../scenario/differences.js";
import { CompareCurves } from "./compare_curves.js";
import { MeasuresTable } from "./measures.js";

export const COMPARED_MAX = 8;
const CHIPS_MAX = 3; // that name a run

export class CompareView {
  constructor() {
    this.title = "Compare";
  }

  async mount(root, { query }) {
    this.query = query;
    this.ids = [...new Set((query.get("runs") ?? "").split(",").filter(Boolean))].slice(0, COMPARED_MAX);
    this.cinema = new Cinema();
    root.append(h("p", { class: "loading" }, "Loading …"));
    const [{ runs: recent }] = await Promise.all([listRuns({ limit: 100 }), this.loadRuns()]);
    if (this.isGone) return;
    this.recent = recent.filter((run) => !isGoing(run.id));
    root.replaceChildren(...this.build());
    this.start();
  }

  // Those of the address that are there; of the others a line says that they are not.
  async loadRuns() {
    const all = this.ids.map((id) => new RunData(id));
    const outcomes = await Promise.allSettled(all.map((data) => data.load()));
    const fault = outcomes.find(({ reason }) => reason && reason.status !== 404)?.reason;
    if (fault) throw fault;
    this.runs = all.filter((data, k) => outcomes[k].status === "fulfilled");
    this.missing = this.ids.filter((id) => !this.runs.some((data) => data.id === id));
    this.reference = Math.max(0, this.runs.findIndex(({ id }) => id === this.query.get("reference")));
    this.nameRuns();
  }

  // What is different is what names them: parameters, model, label; their names, where these differ and parameters too many.
  nameRuns() {
    const { runs } = this;
    const rows = differences(runs.map(({ scenario }) => scenario)).filter(({ label }) => label !== "name");
    const isOf = (what) => new Set(runs.map(({ run }) => run[what])).size > 1;
    const isByName = rows.length > CHIPS_MAX && isOf("name");
    this.chips = runs.map(({ run }, k) => [isOf("model") || isOf("closure") || rows.length === 0 || isByName ? modelOf(run, modelWords) : null,
      ...(isByName ? [] : chipsOf(rows, k, CHIPS_MAX)), isOf("label") ? run.label : null].filter(Boolean));
    this.titles = this.chips.map((chips, k) => [...(isByName ? [nameOf(runs[k].run)] : []), ...chips].join(", "));
  }

  unmount() {
    this.isGone = true;
    this.stopEvents?.();
    this.curves?.dispose();
    this.controls?.dispose();
    this.cinema?.dispose();
  }

  build() {
    const head = h("div", { class: "view-head" }, h("h1", {}, "Compare runs"),
      h("div", { class: "row" }, this.referenceBox(), this.picker(),
        this.runs.length > 0 ? iconButton("download", "Save report", () => this.report(), { shown: true }) : null));
    const lost = this.missing.map((id) => h("p", { class: "notice" }, `Run ${id.slice(-8)} of this address was deleted, or there never was one.`));
    if (this.runs.length === 0) return [head, ...lost, this.invitation()];
    this.controls = new SceneControls(this.cinema, this.query, {
      headingsOf: () => this.runs.map(({ run }, k) => [nameOf(run), this.titles[k]]),
      fileWords: ["belts", ...this.titles],
    });
    const panels = this.runs.map((data, k) => this.panel(data, k));
    if (this.runs.length === 1) lost.push(h("p", { class: "notice" }, "Add another run to compare it with this one."));
    this.curves = new CompareCurves({ runs: this.runs, titles: this.titles, query: this.query,
      onSeek: (t) => this.cinema.player.seek(t), onChange: () => this.measure() });
    this.overview = verdictPanel();
    return [head, ...lost, this.overview, h("div", { class: "compare-main" },
      h("div", { class: "panels", data: { n: String(panels.length) } }, panels), h("div", { class: "compare-side" }, this.controlsCard(), this.curves.element)),
      ...(this.cards = this.tables())];
  }

  // The picture is the one that is seen.
  report() {
    const scene = this.controls.scene();
    const names = new Set(this.runs.map(({ run }) => nameOf(run)));
    const [words, name] = [this.titles.join("; "), [...names][0]];
    saveReport({ title: names.size > 1 || words.includes(name) ? words : `${name}: ${words}`, name: `${fileNameOf("comparison", ...this.titles)}.html`,
      pieces: [this.overview, scene.stages.length > 0 ? drawPicture(scene) : null, this.curves.element, ...this.cards] });
  }

  invitation() {
    return h("section", { class: "card empty" },
      h("p", {}, "Add two to eight runs here, or select them in the list of runs."),
      link("#/", "Choose from the list", { class: "button" }));
  }

  picker() {
    if (this.runs.length >= COMPARED_MAX) return null;
    const others = this.recent.filter((run) => !this.ids.includes(run.id));
    const box = h("select", { disabled: others.length === 0,
      on: { change: () => box.value && this.show([...this.runs.map(({ id }) => id), box.value]) } },
      h("option", { value: "" }, others.length === 0 ? "no other run" : "choose a run"),
      others.map((run) => h("option", { value: run.id },
        `${nameOf(run)} · ${modelOf(run, modelWords)}${run.label ? ` · ${run.label}` : ""} · ${age(run.created_at)}`)));
    return h("label", { class: "field inline" }, h("span", {}, "Add"), box);
  }

  // What all others are compared with.
  referenceBox() {
    if (this.runs.length < 2) return null;
    const box = h("select", { on: { change: () => {
      this.reference = Number(box.value);
      note({ reference: this.reference === 0 ? "" : this.runs[this.reference].id });
      this.curves.setReference(this.reference);
      this.showTables();
      this.showVerdicts();
      this.measure();
    } } }, this.titles.map((title, k) => h("option", { value: String(k) }, title)));
    box.value = String(this.reference);
    return h("label", { class: "field inline" }, h("span", {}, "Reference"), box);
  }

  show(ids) {
    go(address("compare", "", { ...Object.fromEntries(this.query), t: "", runs: ids.join(",") }));
  }

  panel(data, k) {
    const { run } = data;
    const name = nameOf(run);
    const most = () => Math.max(150, innerHeight * (this.runs.length > 2 ? 0.36 : 0.31));
    const screen = this.cinema.add(data, `The belt from above, ${name}, ${this.titles[k]}`, most);
    data.state = statePill(run);
    data.state.show(run);
    data.wait = h("p", { class: "stage-wait", role: "status" });
    return h("section", { class: "card panel", "aria-label": `${name}, ${this.titles[k]}` },
      h("div", { class: "panel-head" }, this.markOf(k),
        h("div", { class: "panel-name" }, link(address("runs", run.id), name),
          h("span", { class: "meta" }, this.chips[k].map((chip) => h("span", { class: "chip" }, chip)), data.state.pill)),
        iconButton("close", `Remove ${name}, ${this.titles[k]}`, () =>
          this.show(this.runs.map(({ id }) => id).filter((id) => id !== run.id)), { class: "bare" })),
      h("div", { class: "stage-box" }, screen.stage.element, data.wait));
  }

  markOf(k) {
    return h("i", { class: "mark", "aria-hidden": "true", data: { run: String(k + 1) } });
  }

  controlsCard() {
    const [row, scale] = this.controls.build("Microscopic runs show");
    return h("section", { class: "card controls", "aria-label": "Animation" }, this.cinema.transport.element, scale, row);
  }

  tables() {
    this.keyTable = new KeyTable();
    this.agreement = new MeasuresTable();
    this.solver = h("div");
    const agreement = fold("Agreement", "How far the curves and the densities are from those of the reference.", this.agreement.element);
    this.agreementFold = agreement.firstChild;
    this.agreementFold.addEventListener("toggle", () => this.measure());
    return [
      h("section", { class: "card", "aria-labelledby": "figures-title" }, h("h2", { id: "figures-title" }, "Key figures"),
        this.keyTable.element),
      agreement,
      fold("Computation", "What the solvers did; it says nothing about the belt.", this.solver),
    ];
  }

  showTables() {
    const headOf = (k) => this.headOf(k);
    this.keyTable.show(this.runs, this.reference, headOf);
    this.solver.replaceChildren(solverTable(this.runs, headOf));
  }

  // What the throughputs are to that of the reference, once all runs have ended.
  async showVerdicts() {
    const { runs, reference } = this;
    if (runs.length < 2 || !runs.every(({ run }) => isOver(run))) return;
    const answer = await getJson(`v1/compare?${new URLSearchParams({ runs: runs.map(({ id }) => id).join(","), reference: runs[reference].id, densities: 0 })}`)
      .catch((error) => {
        if (isBusy(error)) setTimeout(() => this.isGone || this.showVerdicts(), LATER_MS);
        return null;
      });
    if (this.isGone || reference !== this.reference || answer === null) return;
    this.overview.hidden = false;
    this.overview.replaceChildren(...answer.pairs.map(({ b, verdicts }) => {
      const k = runs.findIndex(({ id }) => id === b);
      return h("div", {}, runs.length > 2 ? h("strong", {}, this.markOf(k), this.titles[k]) : null, verdictLines(verdicts));
    }));
  }

  // Of a run, or behind them of measured counts.
  headOf(k) {
    if (k >= this.runs.length) {
      const counts = this.curves.measuredHere()[k - this.runs.length];
      return h("span", { class: "together" }, h("i", { class: "mark dots", "aria-hidden": "true" }), "measured", h("small", {}, counts.label));
    }
    return h("span", {}, this.markOf(k), this.titles[k], k === this.reference ? h("small", {}, "reference") : null);
  }

  // Only where somebody looks: densities of long runs are much to compare.
  measure() {
    if (!this.agreementFold?.open) return;
    this.agreement.load({ runs: this.runs, reference: this.reference, column: this.curves.measuredColumn(),
      measured: this.curves.measuredHere(), headOf: (k) => this.headOf(k) });
  }

  start() {
    const { cinema, runs } = this;
    if (runs.length === 0) return;
    cinema.onUpdate = () => this.update();
    for (const data of runs) data.onChange = (what) => this.change(data, what);
    cinema.refresh();
    this.showEnd();
    this.curves.setReference(this.reference);
    this.controls.show();
    this.showTables();
    this.showVerdicts();
    this.measure();
    const active = runs.filter(({ run }) => !isOver(run));
    if (active.length > 0) {
      this.stopEvents = follow(active.map(({ id }) => id), (kind, event) =>
        active.find(({ id }) => id === event.run)?.take(kind, event));
    }
    cinema.begin(this.query);
  }

  change(data, what) {
    if (this.isGone) return;
    if (what === "curve") this.curves.show();
    if (what === "run") data.state.show(data.run);
    if (what === "figures" || what === "run") this.showTables();
    if (what === "snapshots" || what === "summary") {
      this.cinema.refresh();
      this.showEnd();
    }
    if (what === "summary") {
      data.state.show(data.run);
      this.showTables();
      this.showVerdicts();
      this.measure();
    }
    this.controls.show();
  }

  showEnd() {
    this.curves.setEnd(this.cinema.axisEnd || Math.max(...this.runs.map(({ scenario }) => scenario.duration_s)));
  }

  update() {
    const { player, screens } = this.cinema;
    this.curves.plot.showTime(player.t);
    for (const { data, stage, reel } of screens) {
      const problem = reel.problemAt(player.t);
      setText(data.wait, problem ? problem.message : stage.picture ? "" : data.run.status === "queued"
        ? "Waiting for its turn …" : isOver(data.run) && data.snapshots.length === 0 ? "There are no snapshots." : "Loading …");
      data.wait.hidden = data.wait.textContent === "";
    }
  }
}
