// The numbers of a scenario in a form, each with its unit, limits, fault and warning beside it. Those of the solvers are
// folded away.

import { h } from "../base/dom.js";
import { readNumber, writeNumber } from "../base/numbers.js";
import { faultOf, fields, limitsOf } from "./fields.js";
import { noGoods } from "./goods.js";

function read(field, scenario, goods) {
  try {
    return field.get(scenario, goods) ?? null;
  } catch {
    return null; // the text has another shape at this place
  }
}

const isAt = (field, pointer) => field.at.some((at) => pointer === at || pointer.startsWith(`${at}/`));

export class ScenarioForm {
  // onChange(set, id): the number of this field is good and goes into the scenario by set(scenario); onFault(): it is not; goods: their table.
  constructor(onChange, onFault, goods = noGoods) {
    Object.assign(this, { onChange, onFault, goods, scenario: null, model: "macro" });
    this.boxes = new Map(fields.map((field) => [field.id, this.build(field)]));
    const elements = (isSolvers) => [...this.boxes.values()].filter(({ field }) => Boolean(field.isSolvers) === isSolvers)
      .map(({ element }) => element);
    this.main = h("div", { class: "fields beside-scene" }, elements(false));
    this.solvers = h("div", { class: "fields" }, elements(true));
  }

  build(field) {
    const hint = h("small", { class: "hint", id: `${field.id}-hint` }, [limitsOf(field), field.hint].filter(Boolean).join("; "));
    const fault = h("small", { class: "fault", id: `${field.id}-fault`, hidden: true });
    const warning = h("small", { class: "field-warning", id: `${field.id}-warning`, hidden: true });
    const common = { id: field.id, "aria-describedby": `${field.id}-hint ${field.id}-fault ${field.id}-warning`,
      on: { input: () => this.take(field) } };
    const choices = typeof field.choices === "function" ? field.choices(this.goods) : field.choices;
    const box = choices
      ? h("select", common, choices.map(([value, text]) => h("option", { value }, text)))
      : h("input", { type: "text", inputmode: "decimal", autocomplete: "off", placeholder: field.auto ? "automatic" : null, ...common,
        on: { ...common.on, keydown: (event) => this.nudge(event, field) } });
    const element = h("div", { class: "field" }, h("label", { for: field.id }, field.label),
      h("span", { class: "with-unit" }, box, field.unit ? h("span", { class: "unit" }, field.unit) : null), hint, fault, warning);
    return { field, box, fault, warning, element };
  }

  // Up and down keys change a number by its step.
  nudge(event, field) {
    const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    const { box } = this.boxes.get(field.id);
    const { value, fault } = readNumber(box.value);
    if (!by || fault) return;
    event.preventDefault();
    const least = field.least ?? (field.above === undefined ? -Infinity : field.step);
    box.value = writeNumber(Number(Math.min(Math.max(value + by * field.step, least), field.most ?? Infinity).toPrecision(9)));
    this.take(field);
  }

  take(field) {
    const text = this.boxes.get(field.id).box.value;
    const fault = faultOf(field, text, this.scenario);
    this.showFault(field.id, fault);
    if (fault !== "") this.onFault();
    else this.onChange((scenario) => field.set(scenario, field.choices ? text : text.trim() === "" ? "auto" : readNumber(text).value, this.goods), field.id);
  }

  // Only what the model uses and the scenario has. What is typed just now stays as it is typed.
  fill(scenario, model) {
    Object.assign(this, { scenario, model });
    for (const { field, box, element, fault, warning } of this.boxes.values()) {
      const value = read(field, scenario, this.goods);
      if (document.activeElement !== box) box.value = value === null || value === "auto" ? "" : field.choices ? value : writeNumber(value);
      element.hidden = (field.model && field.model !== model) || value === null;
      if (element.hidden) fault.hidden = warning.hidden = true;
    }
  }

  shown() {
    return [...this.boxes.values()].filter(({ element }) => !element.hidden);
  }

  // Each fault at the field that it is about; those of no field are returned.
  showFaults(errors) {
    const placed = this.placed(errors);
    for (const { field, box } of this.boxes.values()) {
      const isShown = this.shown().some((one) => one.field === field);
      this.showFault(field.id, (isShown ? faultOf(field, box.value, this.scenario) : "") || (placed.get(field.id) ?? []).map(({ detail }) => detail).join("; "));
    }
    return errors.filter((error) => ![...placed.values()].flat().includes(error));
  }

  // The same for warnings, which have a title and what it means.
  showWarnings(warnings) {
    const placed = this.placed(warnings);
    for (const [id, { warning }] of this.boxes) {
      const here = placed.get(id) ?? [];
      warning.hidden = here.length === 0;
      warning.textContent = here.map(({ title, meaning }) => `${title}. ${meaning}`).join(" ");
    }
    return warnings.filter((one) => ![...placed.values()].flat().includes(one));
  }

  placed(items) {
    const placed = new Map();
    for (const item of items.filter(({ pointer }) => pointer)) {
      const found = this.shown().find(({ field }) => isAt(field, item.pointer));
      if (found) placed.set(found.field.id, [...(placed.get(found.field.id) ?? []), item]);
    }
    return placed;
  }

  showFault(id, text) {
    const { box, fault } = this.boxes.get(id);
    fault.textContent = text;
    fault.hidden = text === "";
    box.setAttribute("aria-invalid", String(text !== ""));
  }

  countFaults() {
    return [...this.boxes.values()].filter(({ fault }) => !fault.hidden).length;
  }

  // Numbers that are out of their limits never came into the scenario.
  hasBadNumbers() {
    return this.shown().some(({ field, box }) => faultOf(field, box.value, this.scenario) !== "");
  }

  // To the first field with a fault, also where it is folded away; whether there is one.
  focusFault() {
    const bad = [...this.boxes.values()].find(({ fault }) => !fault.hidden);
    if (bad) {
      bad.element.closest("details")?.setAttribute("open", "");
      bad.box.focus();
    }
    return bad !== undefined;
  }
}
