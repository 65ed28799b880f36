// A new study: which parameters, from where to where, what is best, and how the values are chosen.

import { post, Problem } from "../base/api.js";
import { h, setText } from "../base/dom.js";
import { cut, span } from "../base/format.js";
import { readNumber, writeNumber } from "../base/numbers.js";
import { address, go } from "../base/router.js";
import { lineOf } from "../board/lines.js";
import { fileButton, listMeasured, storeCurve, storeFile } from "../compare/measured.js";
import { askForCounts } from "../compare/paste_counts.js";
import { ScenarioSource } from "../edit/scenario_source.js";
import { segments } from "../player/transport.js";
import { columnsOf } from "../plot/series.js";
import { figureTitle, figureUnit, studied } from "./figures.js";
import { studyParameters } from "./study_parameters.js";
import { VaryRows } from "./study_vary.js";

const methods = [
  ["grid", "Even steps", "every value in the chosen model; of several parameters all combinations"],
  ["list", "Listed values", "the first value of each parameter, then the second ones, and so on"],
  ["sobol", "Spread evenly", "points that fill the ranges of several parameters (Sobol)"],
  ["lhs", "Spread at random", "points that fill each range evenly, drawn at random (Latin hypercube)"],
  ["screen", "Both models", "even steps in the macroscopic model, then the best ones in the microscopic one"],
  ["direct", "Search", "goes where the best value is likely (DIRECT); up to three parameters"],
  ["cmaes", "Search, many parameters", "an evolution strategy (CMA-ES), also where results scatter"],
  ["calibrate", "Fit to counts", "finds the value that agrees best with counts from the hall"],
];
const SPREAD = ["sobol", "lhs"];
const CONFIRMED = 3;
const NAME_MOST = 100; // bytes

const numberIn = (box) => readNumber(box.value).value;

export class NewStudyView {
  constructor() {
    this.title = "New study";
    this.scenario = {}; // until what the study begins with is read
    this.method = "grid";
    this.model = "macro";
  }

  async mount(root, { query }) {
    this.source = new ScenarioSource(query, (begun) => this.setScenario(begun), (error) => this.say(error.message));
    root.append(h("p", { class: "loading" }, "Loading …"));
    [this.counts] = await Promise.all([listMeasured(), this.source.load()]);
    if (this.isGone) return;
    root.replaceChildren(...this.build());
    await this.source.begin();
  }

  unmount() {
    this.isGone = true;
    clearTimeout(this.timer);
  }

  field(label, box, hint, unit) {
    return h("label", { class: "field" }, h("span", {}, label), h("span", { class: "with-unit" }, box, unit ?? null),
      hint ? h("small", { class: "hint" }, hint) : null);
  }

  box(name, value, more = {}) {
    return h("input", { type: "text", inputmode: "decimal", autocomplete: "off", name, value, ...more, on: { input: () => this.change() } });
  }

  build() {
    this.vary = new VaryRows(() => this.change());
    this.pointsBox = this.box("points", "32", { inputmode: "numeric" });
    this.trialsBox = this.box("trials", "60", { inputmode: "numeric" });
    this.runsBox = this.box("replications", "1", { inputmode: "numeric" });
    this.runsBox.addEventListener("input", () => (this.hasRuns = true));
    this.figureBox = h("select", { name: "figure", on: { change: () => this.chooseFigure() } });
    this.secondBox = h("select", { name: "second", on: { change: () => (this.hasSecond = true) } });
    this.indifferenceBox = this.box("indifference", "");
    this.demandBox = this.box("demand", "", { inputmode: "text" });
    this.indifferenceUnit = h("span", { class: "unit" });
    this.counterBox = h("select", { name: "counter" });
    this.methodBox = h("select", { name: "method", on: { change: () => this.chooseMethod(this.methodBox.value) } },
      methods.map(([value, text]) => h("option", { value }, text)));
    this.methodHint = h("small", { class: "hint" });
    const model = segments("Model", [["macro", "Macroscopic"], ["micro", "Microscopic"]], this.model, (value) => {
      this.model = value;
      this.change();
    });
    this.chooseModel = model.choose;
    this.nameBox = h("input", { type: "text", name: "name", maxlength: String(NAME_MOST), autocomplete: "off", on: { input: () => (this.isNamed = this.nameBox.value !== "") } });
    this.lineBox = h("input", { type: "text", name: "line", maxlength: "100", autocomplete: "off" });
    this.verdict = h("p", { class: "verdict", role: "status" });
    this.faults = h("ul", { class: "faults", "aria-label": "Faults" });
    this.button = h("button", { class: "primary" }, "Start the study");
    this.parts = {
      model: h("div", { class: "field" }, h("span", {}, "Model"), model.element),
      points: this.field("Points", this.pointsBox, "how many are tried"),
      trials: this.field("Trials", this.trialsBox, "at most"),
      runs: this.field("Runs of each", this.runsBox, "with other arrivals, for an interval; where parts arrive at random"),
      figure: this.field("Figure", this.figureBox),
      second: this.field("Then", this.secondBox, "decides between equals; both are weighed against each other"),
      demand: this.field("At least", this.demandBox, "asks for the least parameter; a number, or offered; empty: the best"),
      indifference: this.field("Does not matter below", this.indifferenceBox, "a difference of the figure", this.indifferenceUnit),
      counter: this.field("Counted", this.counterBox, "parts in a counter, or those that left"),
      counts: this.countsField(),
    };
    const card = (id, title, ...children) => h("section", { class: "card", "aria-labelledby": id }, h("h2", { id }, title), ...children);
    return [h("div", { class: "view-head" }, h("h1", {}, "New study")),
      h("form", { class: "new-run", novalidate: true, on: { submit: (event) => {
        event.preventDefault();
        this.submit();
      } } },
      card("from-title", "Begin with", this.source.element, this.field("Name", this.nameBox, "says what is varied, until you edit it"),
        this.field("Line", this.lineBox, "with whose runs it is kept")),
      card("vary-title", "Vary", this.vary.element),
      card("best-title", "Find the best", h("div", { class: "fields" },
        h("label", { class: "field" }, h("span", {}, "Method"), this.methodBox, this.methodHint),
        this.parts.points, this.parts.figure, this.parts.second, this.parts.demand, this.parts.counter, this.parts.counts, this.parts.model, this.parts.runs, this.parts.trials, this.parts.indifference)),
      this.faults, h("div", { class: "submit-row" }, this.button, this.verdict))];
  }

  // Which of the stored counts, or a file of them.
  countsField() {
    this.countsBox = h("select", { name: "counts", "aria-label": "Counts", on: { change: () => this.chooseCounts() } });
    this.noCounts = h("small", { class: "hint" }, "No counts are stored yet.");
    this.countsNote = h("small", { role: "alert" });
    const hint = h("small", { class: "hint", id: "counts-hint" }, "a CSV: times in seconds, then counts of parts");
    const button = fileButton("Add counts from a file …", (file) => this.addCounts((counter, isCounter) => storeFile(file, counter, isCounter)),
      { "aria-describedby": hint.id });
    const paste = h("button", { type: "button", on: { click: async () => {
      const curve = await askForCounts();
      if (curve) this.addCounts((counter, isCounter) => storeCurve(curve, "pasted counts", counter, isCounter));
    } } }, "Paste counts …");
    this.offerCounts();
    return h("div", { class: "field" }, h("span", {}, "Counts"), this.countsBox, this.noCounts, button, paste, hint, this.countsNote);
  }

  offerCounts() {
    this.countsBox.replaceChildren(...this.counts.map(({ id, label, counter }) =>
      h("option", { value: id }, label || `${counter}, ${id.slice(-8)}`)));
    this.countsBox.hidden = this.counts.length === 0;
    this.noCounts.hidden = !this.countsBox.hidden;
  }

  // What was counted is known of stored counts.
  chooseCounts() {
    const counter = this.counts.find(({ id }) => id === this.countsBox.value)?.counter;
    if ([...this.counterBox.options].some(({ value }) => value === counter)) this.counterBox.value = counter;
  }

  // store(counter, isCounter): stores them, for this counter or the one that they name.
  async addCounts(store) {
    this.noteCounts(""); // what is said twice is read out twice
    try {
      const isCounter = (name) => [...this.counterBox.options].some(({ value }) => value === name);
      const stored = await store(this.counterBox.value, isCounter);
      this.counts.unshift(stored);
      this.offerCounts();
      this.countsBox.value = stored.id;
      this.counterBox.value = stored.counter;
      this.noteCounts(`${stored.label} is stored and chosen.`, "hint");
    } catch (error) {
      this.noteCounts(error.message);
    }
  }

  noteCounts(text, kind = "fault") {
    this.countsNote.className = kind;
    setText(this.countsNote, text);
  }

  async setScenario({ scenario, model, ofLine }) {
    this.scenario = scenario;
    this.resolved = null;
    this.lineBox.value = ofLine || lineOf(scenario.name);
    if (model) this.chooseModel(this.model = model, false);
    this.fill();
    try {
      const known = await post("v1/validate", { scenario, model: this.model });
      if (this.scenario !== scenario) return;
      this.resolved = known.resolved;
      this.fill();
    } catch (error) {
      this.refuse(error);
    }
  }

  fill() {
    const counters = (this.resolved ?? this.scenario).counters ?? [{ id: "upstream" }];
    const columns = columnsOf({ ...this.resolved, counters }).filter(([name]) => !name.endsWith(".waiting"));
    this.counterBox.replaceChildren(...columns.map(([name, words]) => h("option", { value: name }, words)));
    this.chooseCounts();
    const figure = this.figureBox.value;
    const known = studied.filter(({ isFed }) => !isFed || this.scenario.feeds?.length > 0);
    this.figureBox.replaceChildren(...known.flatMap((one) => (one.of ? counters.map(({ id }) => ({ ...one, name: `${one.figure}:${id}` })) : [{ ...one, name: one.figure }]))
      .map(({ name }) => h("option", { value: name }, figureTitle(name))));
    if (figure) this.figureBox.value = figure;
    this.vary.offer(studyParameters(this.scenario, this.resolved));
    this.chooseFigure();
    this.chooseMethod(this.method);
  }

  get figure() {
    return this.figureOf(this.figureBox.value);
  }

  figureOf(name) {
    const [figure, of] = name.split(":");
    return { ...studied.find((one) => one.figure === figure), of };
  }

  chooseFigure() {
    this.indifferenceBox.value = writeNumber(this.figure.indifference);
    setText(this.indifferenceUnit, figureUnit(this.figureBox.value));
    this.offerSecond();
    this.change();
  }

  // Any other figure; first one that belts with a feed have, too, which never drain.
  offerSecond() {
    const chosen = this.hasSecond ? this.secondBox.value : "";
    const names = [...this.figureBox.options].map(({ value }) => value).filter((name) => name !== this.figureBox.value);
    this.secondBox.replaceChildren(...names.map((name) => h("option", { value: name }, figureTitle(name))));
    const usual = this.scenario.feeds?.length > 0 ? "residence_s.mean" : "";
    this.secondBox.value = [chosen, usual, names[0]].find((name) => names.includes(name)) ?? "";
  }

  chooseMethod(method) {
    this.method = method;
    this.methodBox.value = method;
    setText(this.methodHint, methods.find(([value]) => value === method)[2]);
    const isFit = method === "calibrate";
    this.vary.choose(method);
    for (const [part, isShown] of Object.entries({ model: method !== "screen", points: SPREAD.includes(method), trials: !this.isSweep, runs: !isFit,
      figure: !isFit, second: !isFit, demand: this.isSweep, indifference: method === "screen", counter: isFit, counts: isFit })) {
      this.parts[part].hidden = !isShown;
    }
    if (!this.hasRuns) this.runsBox.value = String(this.usualRuns());
    this.change();
  }

  // All points are chosen beforehand.
  get isSweep() {
    return ["grid", "list", ...SPREAD].includes(this.method);
  }

  // Where arrivals are drawn: a selection among points needs more of them for its first judgement than a mean does.
  usualRuns() {
    const isRandom = this.scenario.feeds?.some(({ arrivals = "regular" }) => arrivals !== "regular");
    if (this.method === "screen") return isRandom ? 10 : 2;
    return isRandom ? 3 : 1;
  }

  // How many runs there will be at most.
  trials() {
    const [points, runs, trials] = [this.pointsBox, this.runsBox, this.trialsBox].map((box) => Math.max(1, Math.round(numberIn(box)) || 1));
    if (SPREAD.includes(this.method)) return points * runs;
    if (this.isSweep) return this.vary.nPoints() * runs;
    return this.method === "screen" ? Math.max(trials, this.vary.nPoints() + CONFIRMED * Math.max(2, runs)) : trials;
  }

  change() {
    if (!this.vary?.isReady) return;
    const varied = this.vary.words();
    if (!this.isNamed && varied !== "") {
      const goal = this.method === "calibrate" ? "Fit" : figureTitle(this.figureBox.value);
      this.nameBox.value = cut(`${goal}, ${varied}`, NAME_MOST);
    }
    this.dropPrediction();
    if (!this.hasBadNumbers()) this.timer = setTimeout(() => this.predict(), 300);
  }

  // Boxes whose text is no number; they are marked, and said.
  hasBadNumbers() {
    const boxes = [["Points", this.pointsBox], ["Trials", this.trialsBox], ["Runs of each", this.runsBox], ["Does not matter below", this.indifferenceBox]];
    if (this.demandBox.value.trim() !== "" && !/^[a-z]+$/i.test(this.demandBox.value.trim())) boxes.push(["At least", this.demandBox]);
    const bad = boxes.filter(([label, box]) => {
      const { fault } = readNumber(box.value);
      box.setAttribute("aria-invalid", String(fault !== ""));
      return fault !== "" && !box.closest("[hidden]");
    });
    const said = [...this.vary.faults(), ...bad.map(([label, box]) => `${label}: ${readNumber(box.value).fault}`)];
    if (said.length > 0) this.say(said.join("; "));
    return said.length > 0;
  }

  // One that came later would take the place of a refusal.
  dropPrediction() {
    clearTimeout(this.timer);
    this.prediction = null;
  }

  async predict() {
    const models = this.method === "screen" ? ["macro", "micro"] : [this.model];
    const prediction = Promise.all(models.map((model) => post("v1/validate", { scenario: this.scenario, model })));
    this.prediction = prediction;
    try {
      const known = await prediction;
      if (this.prediction === prediction) this.sayCosts(known.map(({ predicted_s: seconds }) => seconds));
    } catch (error) {
      if (this.prediction === prediction) this.refuse(error);
    }
  }

  // each: the predicted time of a run of each model.
  sayCosts(each) {
    const n = this.trials();
    const screened = this.vary.nPoints();
    const seconds = this.method === "screen" ? screened * each[0] + (n - screened) * each[1] : n * each[0];
    this.say(each.includes(null) ? `At most ${n} runs.` : `At most ${n} runs, about ${span(seconds)} of computing on one core.`, "good");
  }

  document() {
    const goal = ({ figure, of, goal: way }) => ({ figure, ...(of ? { of } : {}), goal: way });
    const second = this.figureOf(this.secondBox.value);
    const others = studied.filter(({ figure, of }) => ![this.figure.figure, second.figure].includes(figure) && !of).slice(0, 4);
    const asked = this.isSweep ? this.demandBox.value.trim() : "";
    const demand = asked === "" ? {} : { demand: Number.isFinite(numberIn(this.demandBox)) ? numberIn(this.demandBox) : asked };
    const common = {
      name: this.nameBox.value,
      line: this.lineBox.value.trim(),
      base: { scenario: this.vary.base(this.scenario), model: this.method === "screen" ? "macro" : this.model },
      parameters: this.vary.document(),
    };
    if (this.method === "calibrate") {
      return { ...common, curves: [{ counter: this.counterBox.value, measurement: this.countsBox.value }],
        method: { type: "calibrate", points: 4 }, limits: { trials: this.trials() } };
    }
    const method = this.method === "screen" ? { type: "screen", sweep: "grid", confirm: Math.min(CONFIRMED, this.vary.nPoints()), indifference: numberIn(this.indifferenceBox) }
      : { type: this.method, ...(SPREAD.includes(this.method) ? { points: numberIn(this.pointsBox) } : {}) };
    const runs = numberIn(this.runsBox);
    return { ...common, method, objectives: [{ ...goal(this.figure), ...demand }, ...[second, ...others].map(goal)],
      replications: this.method === "screen" ? Math.max(2, runs) : runs,
      ...(this.isSweep ? {} : { limits: { trials: this.trials() } }) };
  }

  async submit() {
    this.dropPrediction();
    if (this.hasBadNumbers()) return;
    if (this.method === "calibrate" && this.counts.length === 0) {
      this.noteCounts("A fit needs counts: add a file of them.");
      this.parts.counts.querySelector("input").focus();
      return;
    }
    this.button.disabled = true;
    try {
      const { id } = await post("v1/studies", this.document());
      go(address("studies", id));
    } catch (error) {
      this.refuse(error);
    } finally {
      this.button.disabled = false;
    }
  }

  refuse(error) {
    if (!(error instanceof Problem)) throw error;
    this.faults.replaceChildren(...error.errors.map(({ pointer, detail }) => h("li", {}, h("span", { class: "place" }, pointer || "the document"), detail)));
    this.say(error.message, "fault");
  }

  say(text, kind = "fault") {
    if (kind === "good") this.faults.replaceChildren();
    this.verdict.className = `verdict ${kind}`;
    setText(this.verdict, text);
  }
}
