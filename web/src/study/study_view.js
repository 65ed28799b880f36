// One study: a figure against a parameter or another figure while it is made, what is best, and of a fit the curves that were fitted.

import { annotate } from "../actions/annotate.js";
import { shareButton } from "../actions/grants.js";
import { saveReport } from "../actions/report.js";
import { isGuest } from "../base/access.js";
import { ask, isOver, patch, post, ticketed } from "../base/api.js";
import { h, iconButton, link, setText } from "../base/dom.js";
import { saveWithCommas } from "../base/files.js";
import { age, fileNameOf } from "../base/format.js";
import { usesComma } from "../base/numbers.js";
import { address, go, note } from "../base/router.js";
import { lineLink, statePill } from "../base/run_words.js";
import { tellFault } from "../base/toast.js";
import { parameterAt } from "../scenario/parameters.js";
import { figureNames, figureTitle, figureUnit } from "./figures.js";
import { BestPanel } from "./study_best.js";
import { StudyChart } from "./study_chart.js";
import { StudyData } from "./study_data.js";
import { FitPanel } from "./study_fit.js";
import { StudyPictures } from "./study_pictures.js";
import { pointsOf } from "./study_points.js";
import { methodWords, nameOfStudy, parametersWords, valueWords } from "./study_words.js";

const SHOWN_MAX = 400;

export class StudyView {
  constructor() {
    this.title = "Study";
  }

  async mount(root, { argument: id, query }) {
    this.data = new StudyData(id);
    root.append(h("p", { class: "loading" }, "Loading …"));
    await this.data.load();
    if (this.isGone) return;
    const { document: doc } = this.data;
    const { scenario } = doc.base;
    this.words = new Map(doc.parameters.map(({ pointer }) => [pointer, parameterAt(pointer, scenario)]));
    this.figures = figureNames(doc);
    this.figure = this.figures.includes(query.get("figure")) ? query.get("figure") : this.figures[0];
    const against = query.get("against");
    this.against = this.words.has(against) || this.figures.includes(against) ? against : doc.parameters[0]?.pointer;
    root.replaceChildren(...this.build());
    this.data.onChange = () => this.show();
    this.show();
    this.data.start();
  }

  unmount() {
    this.isGone = true;
    this.data?.dispose();
    this.chart?.dispose();
    this.pictures?.dispose();
    this.fit?.dispose();
  }

  build() {
    this.best = new BestPanel(this.words, this.figures, this.data.document, isGuest() ? null : (document) => this.make(document));
    this.fit = this.data.document.curves?.length > 0 ? new FitPanel(this.data, this.words) : null;
    this.pictures = new StudyPictures(this.data);
    this.chart = new StudyChart((point) => this.open(point));
    const left = [this.chartCard(), this.pictures.element, this.tableCard()];
    this.cards = [this.best.element, ...left, this.fit?.element];
    return [this.head(), h("div", { class: "watch" }, h("div", {}, left), h("div", {}, this.best.element, this.fit?.element))];
  }

  head() {
    const { study } = this.data;
    this.title = nameOfStudy(study);
    this.state = statePill(study);
    this.count = h("span", { class: "figures" });
    this.bar = h("progress", { max: "1", "aria-label": "Trials that have ended" });
    const action = (text, what) => h("button", { type: "button", on: { click: () => this.data.post(what).catch(tellFault) } }, text);
    this.buttons = { pause: action("Pause", "pause"), resume: action("Resume", "resume"), cancel: action("Cancel", "cancel") };
    const saved = [
      iconButton("download", "Save report", () => saveReport({ title: this.title, name: `${fileNameOf(this.title)}.html`, pieces: this.cards.filter((card) => card !== this.pictures.element || this.pictures.hasAny) }), { shown: true }),
      iconButton("download", "Trials as CSV", () => this.download(), { shown: true })];
    return h("div", { class: "view-head" },
      h("div", { class: "heading" }, this.nameText = h("h1", {}, this.title),
        h("p", { class: "meta" }, this.state.pill, this.bar, this.count, h("span", {}, methodWords(study)),
          this.lineText = h("span", { class: "of-line" }, lineLink(study)), h("time", { datetime: study.created_at }, age(study.created_at))),
        h("p", { class: "fault", role: "status", hidden: !study.suspect },
          "Results of a trial may be wrong, and so may be what is said here. Start the study again.")),
      h("div", { class: "actions" }, isGuest() ? saved : [
        ...Object.values(this.buttons), h("button", { type: "button", on: { click: () => this.rename() } }, "Rename …"), ...saved, shareButton("studies", study.id),
        link(address("runs", "", { study: study.id }), "Its runs", { class: "button" }),
        iconButton("trash", "Delete", () => this.remove(), { shown: true })]));
  }

  chartCard() {
    const choose = (label, values, chosen, text, onChoose) => {
      const box = h("select", { on: { change: () => onChoose(box.value) } }, values.map((value) => h("option", { value }, text(value))));
      box.value = chosen;
      return values.length > 1 ? h("label", { class: "field inline" }, h("span", {}, label), box) : null;
    };
    return h("section", { class: "card", "aria-labelledby": "chart-title" },
      h("div", { class: "card-head" }, this.chartTitle = h("h2", { id: "chart-title" }),
        h("div", { class: "row" },
          choose("Figure", this.figures, this.figure, figureTitle, (value) => this.choose({ figure: value })),
          this.words.size === 0 ? null : choose("Against", [...this.words.keys(), ...this.figures], this.against, (name) => this.wordsOf(name).label,
            (value) => this.choose({ against: value })))),
      this.chart.element,
      h("p", { class: "hint" }, this.words.size > 0 ? "Each point is the mean of its runs, with the 95 % interval where there are several." : "Each point is a run.",
        h("span", { class: "of-screen" }, " Press one to open it.")));
  }

  tableCard() {
    this.rows = h("tbody");
    this.columns = h("tr");
    return h("details", { class: "card trials" }, h("summary", {}, h("h2", {}, "All points")),
      h("div", { class: "scroll" }, h("table", { class: "measures" }, h("thead", {}, this.columns), this.rows)));
  }

  choose(change) {
    Object.assign(this, change);
    note({ figure: this.figure, against: this.against });
    this.show();
  }

  // Of a parameter or a figure.
  wordsOf(name) {
    return this.words.get(name) ?? { label: figureTitle(name), unit: figureUnit(name) };
  }

  show() {
    const { study, best } = this.data;
    this.state.show(study);
    const { trials } = study;
    const done = this.data.ended().length;
    setText(this.count, `${done} of ${isOver(study) ? done : trials.limit} trials`);
    this.bar.hidden = isOver(study) || study.status === "paused";
    this.bar.value = done / Math.max(1, trials.limit);
    this.buttons.pause.hidden = !["queued", "running"].includes(study.status);
    this.buttons.resume.hidden = study.status !== "paused";
    this.buttons.cancel.hidden = isOver(study);
    const points = pointsOf(this.data.ended(), this.figure);
    const unit = figureUnit(this.figure);
    const { label, unit: of } = this.words.size > 0 ? this.wordsOf(this.against) : { label: "number of the run" };
    setText(this.chartTitle, `${figureTitle(this.figure)} against ${label}`);
    const drawn = this.words.size > 0 ? this.drawn(points, unit) : this.repeated(unit);
    this.chart.show(drawn, this.words.size === 1 && this.words.has(this.against), [of ? `${label} (${of})` : label, unit ? `${figureTitle(this.figure)} (${unit})` : figureTitle(this.figure)]);
    this.showTable(points, unit);
    this.pictures.show(this.pictured(points));
    this.best.show(study, best);
    this.fit?.show(best);
  }

  isBest({ point, model }) {
    const { best } = this.data.best ?? {};
    return best?.point === point && best.model === model;
  }

  // Against a figure a point stands at the mean of that, with its interval.
  drawn(points, unit) {
    const { front = [] } = this.data.best ?? {};
    const keyOf = ({ point, model }) => `${point} ${model}`;
    const others = this.words.has(this.against) ? null : new Map(pointsOf(this.data.ended(), this.against).map((point) => [keyOf(point), point]));
    const isWeighed = [this.figure, this.against].every((name) => this.figures.slice(0, 2).includes(name));
    return points.filter((point) => !others || others.has(keyOf(point))).map((point) => {
      const { mean: x, low: xLow, high: xHigh } = others?.get(keyOf(point)) ?? { mean: point.parameters[this.against], low: null, high: null };
      return { ...point, key: keyOf(point), x, xLow, xHigh, isBest: this.isBest(point), isFront: isWeighed && front.some((one) => keyOf(one) === keyOf(point)),
        title: `${parametersWords(point.parameters, this.words)}: ${valueWords(point, unit)}, ${point.model}` };
    });
  }

  // Of a base that is repeated, each run.
  repeated(unit) {
    return this.data.ended().filter(({ values }) => values[this.figure] !== undefined).map((trial) => ({
      key: `${trial.trial}`, x: trial.trial + 1, model: trial.model, mean: trial.values[this.figure], low: null, high: null, xLow: null, xHigh: null, isBest: false, isFront: false,
      trials: [trial], title: `run ${trial.trial + 1}: ${valueWords({ mean: trial.values[this.figure] }, unit)}, ${trial.model}` }));
  }

  // By the model of most points, so that pictures can be compared.
  pictured(points) {
    const macro = points.filter(({ model }) => model === "macro");
    return (macro.length > 0 ? macro : points)
      .map((point) => ({ ...point, x: point.parameters[this.against] ?? 0, label: parametersWords(point.parameters, this.words) || "run 1" }));
  }

  showTable(points, unit) {
    const labels = this.words.size > 0 ? [...this.words.values()].map(({ label }) => label) : ["point"];
    const head = [...labels, "model", "runs", unit ? `mean and 95 % interval (${unit})` : "mean and 95 % interval"];
    const key = JSON.stringify([head, points.map(({ point, model, n, mean }) => [point, model, n, mean])]);
    if (key === this.tableKey) return;
    this.tableKey = key;
    this.columns.replaceChildren(...head.map((text) => h("th", { scope: "col" }, text)));
    this.rows.replaceChildren(...points.slice(0, SHOWN_MAX).map((point) => {
      const [first = "all runs", ...others] = [...this.words.keys()].map((pointer) => parametersWords({ [pointer]: point.parameters[pointer] }, this.words));
      return h("tr", { class: this.isBest(point) ? "best" : null }, h("th", { scope: "row" }, first), others.map((text) => h("td", {}, text)),
        [point.model, String(point.n), valueWords(point, "")].map((text) => h("td", {}, text)));
    }));
  }

  // Runs of trials have curves only, so that the trial is solved again with all its output, unless that was done before.
  async open({ trials: [trial] }) {
    if (isGuest()) return;
    try {
      const run = await post(`${this.data.path}/trials/${trial.trial}/run`, "");
      go(address("runs", run.id));
    } catch (error) {
      tellFault(error);
    }
  }

  rename() {
    const { name, line = "" } = this.data.study;
    annotate({ name, line }, async (changes) => {
      this.data.study = await patch(this.data.path, changes);
      this.title = nameOfStudy(this.data.study);
      setText(this.nameText, this.title);
      this.lineText.replaceChildren(...lineLink(this.data.study));
    });
  }

  // Another study that this one advises.
  async make(document) {
    try {
      go(address("studies", (await post("v1/studies", { ...document, line: this.data.study.line ?? "" })).id));
    } catch (error) {
      tellFault(error);
    }
  }

  async download() {
    const [target, name] = [`${this.data.path}/trials.csv`, `${fileNameOf(this.title)}.csv`];
    if (usesComma()) await saveWithCommas(target, name);
    else h("a", { href: await ticketed(target), download: name }).click();
  }

  async remove() {
    try {
      await ask(this.data.path, { method: "DELETE" });
      go(address("studies"));
    } catch (error) {
      tellFault(error);
    }
  }
}
