// A new run: a line, an example or a past run to begin with, the belt and what stands on it, the numbers that matter, or the JSON
// itself. The server validates it while it is edited; faults and warnings are shown at their fields and lines. Each change is kept in
// the browser and can be undone.

import { getJson, post, Problem } from "../base/api.js";
import { h } from "../base/dom.js";
import { saveBlob } from "../base/files.js";
import { fileNameOf, quantity, span } from "../base/format.js";
import { formatJson } from "../base/json_text.js";
import { readNumber } from "../base/numbers.js";
import { address, go, note } from "../base/router.js";
import { Board } from "../board/board.js";
import { History } from "../board/history.js";
import { lineOf, newLineId, saveLine } from "../board/lines.js";
import { loadSchemas } from "../board/schema.js";
import { Underlay } from "../board/underlay.js";
import { fileButton } from "../compare/measured.js";
import { segments } from "../player/transport.js";
import { nameOfVariant } from "../scenario/differences.js";
import { JsonEditor } from "./json_editor.js";
import { ScenarioForm } from "./scenario_form.js";
import { ScenarioSource } from "./scenario_source.js";
import { SceneEditor } from "./scene_editor.js";

const JUDGE_AFTER_MS = 350;
const ASK_TIME_AFTER_MS = 1500;
const PARTS_MAX = 20000; // the server's own limit of parts that it lists
const PREFIX = '{"scenario":'; // before the text, so that its line numbers do not change

export class NewView {
  constructor() {
    this.title = "New run";
  }

  async mount(root, { query }) {
    this.query = query;
    this.model = query.get("model") === "micro" ? "micro" : "macro";
    this.tab = query.get("tab") === "json" ? "json" : "form";
    root.append(h("p", { class: "loading" }, "Loading …"));
    this.source = new ScenarioSource(query, (begun) => this.begin(begun), (error) => this.say(error.message, "fault"));
    [this.goods] = await Promise.all([getJson("v1/goods"), this.source.load(), loadSchemas()]);
    if (this.isGone) return;
    root.replaceChildren(...this.build());
    await this.source.begin();
  }

  unmount() {
    this.isGone = true;
    clearTimeout(this.timer);
    this.abort?.abort();
    this.scene?.dispose();
    this.editor?.dispose();
  }

  build() {
    this.editor = new JsonEditor(() => this.takeText());
    this.history = new History();
    this.form = new ScenarioForm((set, what) => this.change(set, what), () => this.sayFaults(""), this.goods);
    this.board = new Board({ onChange: (set, what) => this.change(set, what), onChoose: () => this.showScene(), onFault: () => this.sayFaults("") });
    this.scene = new SceneEditor((set, what) => this.change(set, what), (list, k) => this.board.choose(list, k));
    this.underlay = this.scene.underlay = new Underlay({ onChange: () => this.placeDrawing(), onTake: (list, item) => this.board.take(list, item),
      onSize: (x, y) => this.change((scenario) => Object.assign(scenario.domain, { x_m: x, y_m: y })) });
    this.verdict = h("p", { class: "verdict", role: "status" });
    this.others = h("ul", { class: "faults", "aria-label": "Other faults" });
    this.warnings = h("ul", { class: "warnings", "aria-label": "Warnings", hidden: true });
    this.formPart = h("div", { class: "tab" }, h("div", { class: "scene-form" }, h("div", {}, this.scene.element, this.underlay.element, this.board.stand),
      h("div", {}, this.board.thing, this.form.main)), this.advanced(), this.others);
    this.jsonPart = h("div", { class: "tab" }, this.editor.element);
    const form = h("form", { class: "new-run", novalidate: true, on: { keydown: (event) => this.undoByKey(event), submit: (event) => {
      event.preventDefault();
      this.submit([this.model]);
    } } },
    h("section", { class: "card", "aria-labelledby": "from-title" }, h("h2", { id: "from-title" }, "Begin with"),
      this.source.element, this.about()),
    h("section", { class: "card", "aria-labelledby": "what-title" },
      h("div", { class: "card-head" }, h("h2", { id: "what-title" }, "Scenario"), this.editRow(),
        segments("Edit", [["form", "Belt and numbers"], ["json", "JSON"]], this.tab, (tab) => this.showTab(tab)).element),
      this.formPart, this.jsonPart),
    this.warnings, this.submitRow());
    this.showTab(this.tab);
    return [h("div", { class: "view-head" }, h("h1", {}, "New run")), form];
  }

  submitRow() {
    const button = (text, onClick) => h("button", { type: "button", on: { click: onClick } }, text);
    this.buttons = [h("button", { type: "submit", class: "primary" }, "Start the run"),
      button("Run both models", () => this.submit(["macro", "micro"]))];
    this.runsBox = h("input", { type: "number", min: "1", max: "1000", step: "1", value: "1", on: { input: () => this.judgeSoon() } });
    const runs = h("label", { class: "field inline", title: "With other arrivals; several give a mean with its interval" },
      h("span", {}, "Runs of each"), this.runsBox);
    return h("div", { class: "submit-row" }, this.buttons, runs, button("Study …", () => this.study()), this.verdict);
  }

  // Undo and redo, and the scenario as a file, out and in.
  editRow() {
    const button = (text, onClick) => h("button", { type: "button", on: { click: onClick } }, text);
    this.undoButtons = [[-1, button("Undo", () => this.go(-1))], [1, button("Redo", () => this.go(1))]];
    const save = () => saveBlob(new Blob([this.editor.text], { type: "application/json" }), `${fileNameOf(this.scenario?.name ?? "scenario")}.json`);
    return h("div", { class: "palette" }, this.undoButtons.map(([, element]) => element), button("Save as a file", save),
      fileButton("Open a file …", (file) => this.open(file), { accept: ".json,application/json" }));
  }

  async open(file) {
    this.editor.text = await file.text();
    this.takeText();
    if (this.scenario) this.editor.text = formatJson(this.scenario);
    else this.showTab("json");
  }

  // One step back or on in what was edited.
  go(by) {
    if (!this.history.canGo(by)) return;
    this.editor.text = this.history.go(by);
    this.scenario = JSON.parse(this.editor.text);
    this.keep();
    this.fillForm();
    this.judgeSoon();
  }

  // Boxes and the editor of JSON have their own.
  undoByKey(event) {
    const isUndo = (event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z";
    if (!isUndo || event.target.closest("input, textarea, .json-box")) return;
    event.preventDefault();
    this.go(event.shiftKey ? 1 : -1);
  }

  // In the browser, under the line's own id from the first change on.
  keep() {
    for (const [by, element] of this.undoButtons) element.disabled = !this.history.canGo(by);
    if (!this.scenario || !this.isEdited) return;
    if (this.line === null) note({ line: (this.line = newLineId()), blank: "", from: "", example: "" });
    saveLine({ id: this.line, scenario: this.scenario, model: this.model, label: this.labelBox.value, ofLine: this.lineBox.value, isNamed: this.isNamed, underlay: this.underlay.kept });
  }

  placeDrawing() {
    this.isEdited = true;
    this.scene.draw();
    this.keep();
  }

  about() {
    const models = segments("Model", [["macro", "Macroscopic"], ["micro", "Microscopic"]], this.model, (model) => {
      this.model = model;
      note({ model: model === "macro" ? "" : model });
      this.form.fill(this.scenario, model);
      this.judgeSoon(0);
    });
    this.chooseModel = models.choose;
    this.nameBox = h("input", { type: "text", maxlength: "200", autocomplete: "off", on: {
      input: () => this.takeName(),
      change: () => (this.nameBox.value = this.scenario?.name ?? "") } });
    this.labelBox = h("input", { type: "text", maxlength: "100", autocomplete: "off", on: { input: () => this.judgeSoon() } });
    this.lineBox = h("input", { type: "text", maxlength: "100", autocomplete: "off", on: { input: () => {
      this.hasLine = this.lineBox.value !== "";
      this.keep();
      this.judgeSoon();
    } } });
    return h("div", { class: "fields about" },
      h("div", { class: "field" }, h("span", {}, "Model"), models.element,
        h("small", { class: "hint" }, "density of cargo, or every part by itself")),
      h("label", { class: "field" }, h("span", {}, "Name"), this.nameBox,
        h("small", { class: "hint" }, "says what was changed, until you edit it")),
      h("label", { class: "field" }, h("span", {}, "Line"), this.lineBox,
        h("small", { class: "hint" }, "keeps its runs together")),
      h("label", { class: "field" }, h("span", {}, "Label"), this.labelBox, h("small", { class: "hint" }, "may stay empty")));
  }

  // Settings of the solvers and of the queue.
  advanced() {
    this.priorityBox = h("input", { type: "number", min: "-100", max: "100", step: "1", value: "0",
      on: { input: () => this.judgeSoon() } });
    this.form.solvers.append(h("label", { class: "field" }, h("span", {}, "Priority"), this.priorityBox,
      h("small", { class: "hint" }, "−100 to 100; higher ones first")));
    return h("details", { class: "advanced" }, h("summary", {}, "Advanced"), this.form.solvers);
  }

  showTab(tab) {
    this.tab = tab;
    note({ tab: tab === "form" ? "" : tab });
    this.formPart.hidden = tab !== "form";
    this.jsonPart.hidden = tab !== "json";
    if (tab === "json") this.editor.open();
    if (this.judged) this.showWarnings(this.judged);
  }

  begin({ scenario, model, label, line = null, ofLine = "", isNamed = false, underlay = null }) {
    if (model && !this.query.has("model")) this.chooseModel(this.model = model, false);
    if (label !== undefined) this.labelBox.value = label;
    this.scenario = scenario;
    this.origin = structuredClone(scenario);
    this.hasLine = ofLine !== "";
    this.lineBox.value = ofLine || lineOf(scenario.name);
    Object.assign(this, { line, isNamed, isEdited: false, validation: null });
    this.board.chosen = null;
    this.underlay.begin(underlay);
    this.editor.text = formatJson(scenario);
    this.history.begin(this.editor.text);
    this.keep();
    this.fillForm();
    this.judgeSoon(0);
  }

  fillForm() {
    if (document.activeElement !== this.nameBox) this.nameBox.value = this.scenario?.name ?? "";
    this.form.fill(this.scenario, this.model);
    this.underlay.domain = this.scenario?.domain ?? null;
    this.board.show(this.scenario, this.validation?.resolved ?? null);
    this.showScene();
  }

  showScene() {
    if (this.validation) this.scene.show(this.scenario, this.validation, this.board.chosen);
  }

  // After each change of the scenario.
  take(what) {
    this.isEdited = true;
    this.history.take(formatJson(this.scenario), what);
    this.keep();
  }

  // An empty name is made from the parameters again.
  takeName() {
    this.isNamed = this.nameBox.value !== "";
    if (!this.hasLine) this.lineBox.value = lineOf(this.nameBox.value);
    this.change((scenario) => (scenario.name = this.nameBox.value));
  }

  // Whether it has another name now.
  nameIt() {
    if (!this.scenario || this.isNamed) return false;
    const name = nameOfVariant(this.origin, this.scenario) ?? this.origin.name;
    if (name === undefined || name === this.scenario.name) return false;
    this.scenario.name = name;
    return true;
  }

  // A change by the form, the board or the scene, into the scenario and its text; what: names the box or handle that is used.
  change(set, what = null) {
    if (!this.scenario) return;
    set(this.scenario);
    this.nameIt();
    this.editor.text = formatJson(this.scenario);
    this.take(what);
    this.fillForm();
    this.judgeSoon();
  }

  takeText() {
    try {
      const value = JSON.parse(this.editor.text);
      this.scenario = value !== null && typeof value === "object" && !Array.isArray(value) ? value : null;
    } catch {
      this.scenario = null;
    }
    this.isNamed ||= this.scenario !== null && (this.scenario.name ?? "") !== this.nameBox.value;
    if (this.scenario) this.take("json");
    this.fillForm();
    this.judgeSoon();
  }

  body(model = this.model) {
    const rest = JSON.stringify({ model, label: this.labelBox.value, line: this.lineBox.value.trim(), priority: readNumber(this.priorityBox.value).value || 0,
      replications: readNumber(this.runsBox.value).value });
    return `${PREFIX}${this.editor.text.trim() === "" ? "null" : this.editor.text},${rest.slice(1)}`;
  }

  judgeSoon(ms = JUDGE_AFTER_MS) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.judge(), ms);
  }

  async judge() {
    this.abort?.abort();
    const abort = new AbortController();
    this.abort = abort;
    try {
      const validation = await post(`v1/validate?parts=${PARTS_MAX}`, this.body(), { signal: abort.signal });
      this.showFaults([]);
      this.accept(validation);
    } catch (error) {
      if (error.name !== "AbortError") this.refuse(error);
    }
  }

  accept(validation) {
    const { predicted_s: seconds, warning_details: warnings } = validation;
    this.validation = validation;
    this.board.show(this.scenario, validation.resolved);
    this.showScene();
    this.showWarnings(warnings);
    if (seconds === null) this.judgeSoon(ASK_TIME_AFTER_MS); // a server that has just begun does not know its speed yet
    const n = warnings.length;
    if (this.form.countFaults() + this.board.countFaults() > 0) this.sayFaults("");
    else {
      const doubt = n === 0 ? "" : ` Read the ${n === 1 ? "warning" : `${n} warnings`} first.`;
      const time = seconds === null ? "" : ` It takes about ${span(seconds)}.`;
      const like = validation.validity?.like === undefined ? "" : ` ${validation.validity.like.detail}`;
      this.say(`${sizeText(validation)}${time}${like}${doubt}`, n === 0 ? "good" : "doubt");
    }
  }

  refuse(error) {
    if (!(error instanceof Problem)) throw error;
    const errors = error.errors.map(({ pointer, detail }) => ({ pointer: pointer.replace(/^\/scenario/, ""), detail: shift(detail) }));
    this.showFaults(errors);
    this.showWarnings([]);
    this.sayFaults(error.message);
  }

  // Why the results would be doubtful; the run can be started all the same. What is about a field that is seen stands there.
  showWarnings(warnings) {
    this.judged = warnings;
    this.editor.showWarnings(warnings);
    const atFields = this.form.showWarnings(warnings);
    const rest = this.tab === "form" ? atFields : warnings;
    this.warnings.replaceChildren(...rest.map(({ title, meaning, detail }) => h("li", {}, h("strong", {}, `${title}. `), meaning,
      detail ? h("details", {}, h("summary", {}, "Details"), detail) : null)));
    this.warnings.hidden = rest.length === 0;
  }

  // Each fault at the field that it is about, the rest below the form; all of them at their lines.
  showFaults(errors) {
    this.editor.showFaults(errors);
    this.others.replaceChildren(...this.board.showFaults(this.form.showFaults(errors)).map(({ pointer, detail }) => h("li", {},
      h("span", { class: "place" }, pointer || "the document"), detail)));
  }

  // How many fields and other places there are to mend; without any, the server's own words.
  sayFaults(otherwise) {
    const n = this.form.countFaults() + this.board.countFaults() + this.others.childElementCount;
    this.say(n === 0 ? otherwise : `${n} ${n === 1 ? "fault" : "faults"} to mend`, "fault");
  }

  say(text, kind) {
    this.verdict.textContent = text;
    this.verdict.className = `verdict ${kind}`;
  }

  // A number that is out of its limits never came into the scenario, so it must be mended first.
  isReady() {
    clearTimeout(this.timer);
    if (this.form.hasBadNumbers() || this.board.hasFaults()) {
      if (!this.form.focusFault()) this.board.focusFault();
      return false;
    }
    if (this.nameIt()) this.editor.text = formatJson(this.scenario);
    return true;
  }

  // One run, or both models', which are compared then; neither begins when one is refused.
  async submit(models) {
    if (!this.isReady()) return;
    for (const button of this.buttons) button.disabled = true;
    try {
      if (models.length > 1) await Promise.all(models.map((model) => post("v1/validate", this.body(model))));
      const runs = await Promise.all(models.map((model) => post("v1/runs", this.body(model))));
      go(isStudy(runs[0]) ? runs.length === 1 ? address("studies", runs[0].id) : address("studies")
        : runs.length === 1 ? address("runs", runs[0].id) : address("compare", "", { runs: runs.map(({ id }) => id).join(",") }));
    } catch (error) {
      this.refuse(error);
      if (this.tab === "json") this.editor.list.querySelector("button")?.focus();
      else if (!this.form.focusFault()) this.board.focusFault();
    } finally {
      for (const button of this.buttons) button.disabled = false;
    }
  }

  study() {
    if (!this.isReady() || !this.scenario) return;
    this.isEdited = true;
    this.keep();
    go(address("studies", "new", { line: this.line }));
  }
}

// Several runs of each are answered as a study.
const isStudy = ({ links }) => links.trials !== undefined;

// The first line of the body begins with what stands before the text.
function shift(detail) {
  return detail.replace(/^line 1, column (\d+)/, (_, column) => `line 1, column ${Math.max(1, Number(column) - PREFIX.length)}`);
}

// What the server will have to do.
function sizeText({ resolved, shape: [rows, columns], cell_m: edges, model }) {
  if (model === "micro") return `Ready: every part by itself, ${resolved.duration_s} s.`;
  const size = `${(rows * columns).toLocaleString("en")} cells, ${resolved.duration_s} s`;
  return `Ready: ${size}. Closure ${resolved.macro.closure}, cells of ${quantity(Math.max(...edges) * 1000, "mm", 3)}.`;
}
