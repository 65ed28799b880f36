// A new run: an example or a past run to begin with, the numbers that matter in a form, or the JSON itself.
// The daemon validates it while it is edited; faults are shown at their fields and lines, warnings above the button.

import { getJson, listRuns, paths, post, Problem } from "./api.js";
import { nameOfVariant } from "./differences.js";
import { h } from "./dom.js";
import { fields, faultOf, limitsOf } from "./fields.js";
import { age, nameOf } from "./format.js";
import { JsonEditor } from "./json_editor.js";
import { formatJson } from "./json_text.js";
import { address, go, note } from "./router.js";
import { segments } from "./transport.js";

const JUDGE_AFTER_MS = 350;
const PREFIX = '{"scenario":'; // before the text, so that its line numbers do not change

// The scenario to begin with: the paper's first one.
const firstOf = (examples) => examples.find(({ name }) => name === "example-1") ?? examples[0];

export class NewView {
  constructor() {
    this.title = "New run";
  }

  async mount(root, { query }) {
    this.query = query;
    this.model = query.get("model") === "micro" ? "micro" : "macro";
    this.tab = query.get("tab") === "json" ? "json" : "form";
    root.append(h("p", { class: "loading" }, "Loading …"));
    const [{ examples }, { runs }] = await Promise.all([getJson("v1/examples"), listRuns({ limit: 50 })]);
    if (this.isGone) return;
    root.replaceChildren(...this.build(examples, runs));
    const from = query.get("from");
    await this.begin(from ? `run:${from}` : `example:${query.get("example") ?? firstOf(examples).name}`);
  }

  unmount() {
    this.isGone = true;
    clearTimeout(this.timer);
    this.abort?.abort();
  }

  build(examples, runs) {
    this.editor = new JsonEditor(() => this.takeText());
    this.verdict = h("p", { class: "verdict", role: "status" });
    this.others = h("ul", { class: "faults", "aria-label": "Other faults" });
    this.warnings = h("ul", { class: "warnings", "aria-label": "Warnings", hidden: true });
    this.submitButton = h("button", { type: "submit", class: "primary" }, "Start the run");
    this.formPart = this.form();
    this.jsonPart = h("div", { class: "tab" }, this.editor.element);
    const form = h("form", { class: "new-run", novalidate: true, on: { submit: (event) => {
      event.preventDefault();
      this.submit();
    } } },
    h("section", { class: "card", "aria-labelledby": "from-title" }, h("h2", { id: "from-title" }, "Begin with"),
      this.source(examples, runs), this.about()),
    h("section", { class: "card", "aria-labelledby": "what-title" },
      h("div", { class: "card-head" }, h("h2", { id: "what-title" }, "Scenario"),
        segments("Edit", [["form", "Numbers"], ["json", "JSON"]], this.tab, (tab) => this.showTab(tab)).element),
      this.formPart, this.jsonPart),
    this.warnings, h("div", { class: "submit-row" }, this.submitButton, this.verdict));
    this.showTab(this.tab);
    return [h("div", { class: "view-head" }, h("h1", {}, "New run")), form];
  }

  source(examples, runs) {
    const option = (value, text) => h("option", { value }, text);
    this.sourceBox = h("select", { on: { change: () => {
      const [kind, name] = this.sourceBox.value.split(":");
      note(kind === "run" ? { from: name, example: "" } : { example: name, from: "" });
      this.begin(this.sourceBox.value);
    } } },
    h("optgroup", { label: "Examples" }, examples.map(({ name, title }) => option(`example:${name}`, title ?? name))),
    runs.length > 0 ? h("optgroup", { label: "Past runs" },
      runs.map((run) => option(`run:${run.id}`, `${nameOf(run)} · ${run.model} · ${age(run.created_at)}`))) : null);
    return h("label", { class: "field wide" }, h("span", {}, "Example or past run"), this.sourceBox);
  }

  about() {
    const models = segments("Model", [["macro", "Macroscopic"], ["micro", "Microscopic"]], this.model, (model) => {
      this.model = model;
      note({ model: model === "macro" ? "" : model });
      this.showFields();
      this.judgeSoon(0);
    });
    this.chooseModel = models.choose;
    this.nameBox = h("input", { type: "text", maxlength: "200", autocomplete: "off", on: {
      input: () => this.takeName(),
      change: () => (this.nameBox.value = this.scenario?.name ?? "") } });
    this.labelBox = h("input", { type: "text", maxlength: "100", autocomplete: "off", on: { input: () => this.judgeSoon() } });
    this.priorityBox = h("input", { type: "number", min: "-100", max: "100", step: "1", value: "0",
      on: { input: () => this.judgeSoon() } });
    return h("div", { class: "fields about" },
      h("div", { class: "field" }, h("span", {}, "Model"), models.element,
        h("small", { class: "hint" }, "density of cargo, or every part by itself")),
      h("label", { class: "field" }, h("span", {}, "Name"), this.nameBox,
        h("small", { class: "hint" }, "says what was changed, until you edit it")),
      h("label", { class: "field" }, h("span", {}, "Label"), this.labelBox, h("small", { class: "hint" }, "to find it again; may stay empty")),
      h("label", { class: "field" }, h("span", {}, "Priority"), this.priorityBox, h("small", { class: "hint" }, "−100 to 100; higher ones first")));
  }

  form() {
    this.boxes = new Map();
    const elements = fields.map((field) => {
      const hint = h("small", { class: "hint", id: `${field.id}-hint` }, [limitsOf(field), field.hint].filter(Boolean).join("; "));
      const fault = h("small", { class: "fault", id: `${field.id}-fault`, hidden: true });
      const common = { id: field.id, "aria-describedby": `${field.id}-hint ${field.id}-fault`, on: { input: () => this.takeField(field) } };
      const box = field.choices
        ? h("select", common, field.choices.map(([value, text]) => h("option", { value }, text)))
        : h("input", { type: "text", inputmode: "decimal", autocomplete: "off", placeholder: field.auto ? "automatic" : null, ...common,
          on: { ...common.on, keydown: (event) => this.nudge(event, field) } });
      const element = h("div", { class: "field" }, h("label", { for: field.id }, field.label),
        h("span", { class: "with-unit" }, box, field.unit ? h("span", { class: "unit" }, field.unit) : null), hint, fault);
      this.boxes.set(field.id, { field, box, hint, fault, element });
      return element;
    });
    return h("div", { class: "tab" }, h("div", { class: "fields" }, elements), this.others);
  }

  // Up and down keys change a number by its step.
  nudge(event, field) {
    const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    const { box } = this.boxes.get(field.id);
    const value = Number(box.value);
    if (!by || box.value.trim() === "" || !Number.isFinite(value)) return;
    event.preventDefault();
    const least = field.least ?? field.step;
    box.value = String(Number(Math.min(Math.max(value + by * field.step, least), field.most ?? Infinity).toPrecision(9)));
    this.takeField(field);
  }

  showTab(tab) {
    this.tab = tab;
    note({ tab: tab === "form" ? "" : tab });
    this.formPart.hidden = tab !== "form";
    this.jsonPart.hidden = tab !== "json";
  }

  async begin(source) {
    this.sourceBox.value = source;
    const [kind, name] = source.split(":");
    try {
      if (kind === "run") {
        const [run, scenario] = await Promise.all([getJson(paths.run(name)), getJson(paths.of(name, "scenario"))]);
        if (!this.query.has("model")) this.setModel(run.model);
        this.labelBox.value = run.label;
        this.setScenario(scenario);
      } else {
        this.setScenario(await getJson(`v1/examples/${encodeURIComponent(name)}`));
      }
    } catch (error) {
      this.say(error.message, "fault");
    }
  }

  setModel(model) {
    this.model = model;
    this.chooseModel(model, false);
  }

  setScenario(scenario) {
    this.scenario = scenario;
    this.origin = structuredClone(scenario);
    this.isNamed = false;
    this.editor.text = formatJson(scenario);
    this.fillForm();
    this.judgeSoon(0);
  }

  fillForm() {
    const { scenario } = this;
    this.nameBox.value = scenario?.name ?? "";
    for (const { field, box } of this.boxes.values()) {
      const value = read(field, scenario);
      box.value = value === null || value === "auto" ? "" : String(value);
    }
    this.showFields();
  }

  // Only what the model uses and the scenario has.
  showFields() {
    for (const { field, element, fault } of this.boxes.values()) {
      element.hidden = (field.model && field.model !== this.model) || read(field, this.scenario) === null;
      if (element.hidden) fault.hidden = true;
    }
  }

  // An empty name is made from the parameters again.
  takeName() {
    this.isNamed = this.nameBox.value !== "";
    this.change((scenario) => (scenario.name = this.nameBox.value));
  }

  // Whether it has another name now.
  nameIt() {
    if (!this.scenario || this.isNamed) return false;
    const name = nameOfVariant(this.origin, this.scenario) ?? this.origin.name;
    if (name === undefined || name === this.scenario.name) return false;
    this.scenario.name = name;
    if (document.activeElement !== this.nameBox) this.nameBox.value = name;
    return true;
  }

  // A change by the form, into the scenario and its text.
  change(set) {
    if (!this.scenario) return;
    set(this.scenario);
    this.nameIt();
    this.editor.text = formatJson(this.scenario);
    this.judgeSoon();
  }

  takeField(field) {
    const { box } = this.boxes.get(field.id);
    const text = box.value;
    const fault = faultOf(field, text);
    this.showFieldFault(field.id, fault);
    if (fault !== "") {
      this.sayFaults("");
      return;
    }
    this.change((scenario) => field.set(scenario, field.choices ? text : text.trim() === "" ? "auto" : Number(text)));
  }

  takeText() {
    try {
      const value = JSON.parse(this.editor.text);
      this.scenario = value !== null && typeof value === "object" && !Array.isArray(value) ? value : null;
    } catch {
      this.scenario = null;
    }
    this.isNamed ||= this.scenario !== null && (this.scenario.name ?? "") !== this.nameBox.value;
    this.fillForm();
    this.judgeSoon();
  }

  body() {
    const rest = JSON.stringify({ model: this.model, label: this.labelBox.value, priority: Number(this.priorityBox.value) || 0 });
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
      const { resolved, warnings } = await post("v1/validate", this.body(), { signal: abort.signal });
      this.showFaults([]);
      this.showWarnings(warnings);
      if (this.firstBad()) this.sayFaults("");
      else this.say(sizeText(resolved, this.model), "good");
    } catch (error) {
      if (error.name !== "AbortError") this.refuse(error);
    }
  }

  refuse(error) {
    if (!(error instanceof Problem)) throw error;
    const errors = error.errors.map(({ pointer, detail }) => ({ pointer: pointer.replace(/^\/scenario/, ""), detail: shift(detail) }));
    this.showFaults(errors);
    this.showWarnings([]);
    this.sayFaults(error.message);
  }

  // Why the results would be doubtful; the run can be started all the same.
  showWarnings(texts) {
    this.warnings.replaceChildren(...texts.map((text) => h("li", {}, text)));
    this.warnings.hidden = texts.length === 0;
  }

  // Each fault at the field that it is about, the rest below the form; all of them at their lines.
  showFaults(errors) {
    this.editor.showFaults(errors);
    const byField = new Map();
    const rest = [];
    for (const fault of errors) {
      const found = [...this.boxes.values()].find(({ field, element }) => !element.hidden && field.at.some((at) =>
        fault.pointer === at || fault.pointer.startsWith(`${at}/`)));
      if (found) byField.set(found.field.id, [...(byField.get(found.field.id) ?? []), fault.detail]);
      else rest.push(fault);
    }
    for (const [id, { field, box, element }] of this.boxes) {
      const own = element.hidden ? "" : faultOf(field, box.value);
      this.showFieldFault(id, own || (byField.get(id) ?? []).join("; "));
    }
    this.others.replaceChildren(...rest.map(({ pointer, detail }) => h("li", {},
      h("span", { class: "place" }, pointer || "the document"), detail)));
  }

  // How many fields and other places there are to mend; without any, the daemon's own words.
  sayFaults(otherwise) {
    const n = [...this.boxes.values()].filter(({ fault }) => !fault.hidden).length + this.others.childElementCount;
    this.say(n === 0 ? otherwise : `${n} ${n === 1 ? "fault" : "faults"} to mend`, "fault");
  }

  showFieldFault(id, text) {
    const { box, fault } = this.boxes.get(id);
    fault.textContent = text;
    fault.hidden = text === "";
    box.setAttribute("aria-invalid", String(text !== ""));
  }

  say(text, kind) {
    this.verdict.textContent = text;
    this.verdict.className = `verdict ${kind}`;
  }

  firstBad() {
    return [...this.boxes.values()].find(({ fault }) => !fault.hidden)?.box;
  }

  // A number that is out of its limits never came into the scenario, so it must be mended first.
  async submit() {
    clearTimeout(this.timer);
    if ([...this.boxes.values()].some(({ field, box, element }) => !element.hidden && faultOf(field, box.value) !== "")) {
      this.firstBad().focus();
      return;
    }
    if (this.nameIt()) this.editor.text = formatJson(this.scenario);
    this.submitButton.disabled = true;
    try {
      const run = await post("v1/runs", this.body());
      performance.mark("submitted");
      go(address("runs", run.id));
    } catch (error) {
      this.refuse(error);
      const bad = this.tab === "form" ? this.firstBad() : this.editor.list.querySelector("button");
      bad?.focus();
    } finally {
      this.submitButton.disabled = false;
    }
  }
}

function read(field, scenario) {
  try {
    return field.get(scenario) ?? null;
  } catch {
    return null; // the text has another shape at this place
  }
}

// The first line of the body begins with what stands before the text.
function shift(detail) {
  return detail.replace(/^line 1, column (\d+)/, (_, column) => `line 1, column ${Math.max(1, Number(column) - PREFIX.length)}`);
}

// What the daemon will have to do.
function sizeText({ domain, macro, duration_s: duration }, model) {
  const cells = ["x_m", "y_m"].reduce((n, axis) => n * Math.round((domain[axis][1] - domain[axis][0]) / macro.cell_m), 1);
  const what = model === "macro" ? `${cells.toLocaleString("en")} cells` : "every part by itself";
  return `Ready: ${what}, ${duration} s.`;
}
