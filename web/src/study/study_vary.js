// What a study varies: a row for each parameter, with its range, or with the values to be tried.

import { h, iconButton, setText } from "../base/dom.js";
import { readNumber, readNumbers, writeNumber } from "../base/numbers.js";
import { baseFor } from "./study_parameters.js";

const MOST = 8;
const STEPS = { first: 6, other: 3 };

const STEPPED = ["grid", "screen"];
const SPACINGS = [["even", "evenly"], ["log", "in equal ratios"], ["listed", "as listed"]];

const numberIn = (box) => readNumber(box.value).value;

class Row {
  constructor(rows) {
    this.rows = rows;
    const box = (name, mode = "decimal") => h("input", { type: "text", inputmode: mode, autocomplete: "off", name, on: { input: () => rows.onChange() } });
    this.chosen = h("select", { name: "parameter", on: { change: () => this.choose() } });
    this.spacing = h("select", { name: "spacing", on: { change: () => rows.respace() } }, SPACINGS.map(([value, text]) => h("option", { value }, text)));
    this.units = [0, 1, 2].map(() => h("span", { class: "unit" }));
    this.boxes = { from: box("from"), to: box("to"), steps: box("steps", "numeric"), values: box("values", "text") };
    const field = (label, input, unit, hint) => h("label", { class: "field" }, h("span", {}, label), h("span", { class: "with-unit" }, input, unit ?? null),
      hint ? h("small", { class: "hint" }, hint) : null);
    this.fields = {
      spacing: field("Spread", this.spacing),
      from: field("From", this.boxes.from, this.units[0]),
      to: field("To", this.boxes.to, this.units[1]),
      steps: field("Values", this.boxes.steps, null, "how many, with both ends"),
      values: field("Values", this.boxes.values, this.units[2], "as 45 52.5 60"),
    };
    this.remove = iconButton("trash", "Do not vary this", () => rows.drop(this));
    this.element = h("div", { class: "fields vary", role: "group" }, field("Parameter", this.chosen), Object.values(this.fields), this.remove);
  }

  get parameter() {
    return this.rows.parameters.find(({ pointer }) => pointer === this.chosen.value);
  }

  // Keeps the parameter where there still is one of its pointer.
  offer(otherwise) {
    const before = this.chosen.value;
    const { parameters } = this.rows;
    this.chosen.replaceChildren(...parameters.map(({ pointer, label }) => h("option", { value: pointer }, label)));
    const isKnown = parameters.some(({ pointer }) => pointer === before);
    this.chosen.value = isKnown ? before : otherwise;
    if (!isKnown) this.choose();
  }

  choose() {
    const { range, unit } = this.parameter;
    this.boxes.from.value = writeNumber(range[0]);
    this.boxes.to.value = writeNumber(range[1]);
    this.boxes.values.value = range.map((value) => writeNumber(value)).join(" ");
    for (const element of this.units) setText(element, unit);
    this.rows.onChange();
  }

  get isListed() {
    const { method } = this.rows;
    return method === "list" || (STEPPED.includes(method) && this.spacing.value === "listed");
  }

  // Only grids take values of their own.
  show(method) {
    const isStepped = STEPPED.includes(method);
    this.spacing.lastChild.hidden = !isStepped;
    if (!isStepped && this.spacing.value === "listed") this.spacing.value = "even";
    const shown = { spacing: method !== "list", from: !this.isListed, to: !this.isListed, steps: isStepped && !this.isListed, values: this.isListed };
    for (const [name, isShown] of Object.entries(shown)) this.fields[name].hidden = !isShown;
  }

  // The least and the largest number that is tried, or all of them.
  values() {
    return this.isListed ? readNumbers(this.boxes.values.value).values : [numberIn(this.boxes.from), numberIn(this.boxes.to)];
  }

  steps() {
    return this.isListed ? this.values().length : Math.max(1, Math.round(numberIn(this.boxes.steps)) || 1);
  }

  faults() {
    const { values, ...numbers } = this.boxes;
    const [from, to] = this.values();
    const isReversed = !this.isListed && from >= to;
    const read = [...Object.entries(numbers).map(([name, box]) => [name === "steps" ? "Values" : name === "from" ? "From" : "To", box,
      readNumber(box.value).fault || (name === "to" && isReversed ? "must be greater than From" : "")]),
      ["Values", values, readNumbers(values.value).fault]];
    for (const [, box, fault] of read) box.setAttribute("aria-invalid", String(fault !== ""));
    return read.filter(([, box, fault]) => fault !== "" && !box.closest("[hidden]")).map(([label, , fault]) => `${label}: ${fault}`);
  }

  document(method) {
    if (this.isListed) return { values: this.values() };
    return { range: this.values(), ...(this.spacing.value === "log" ? { scale: "log" } : {}),
      ...(STEPPED.includes(method) ? { steps: numberIn(this.boxes.steps) } : {}) };
  }

  words() {
    const { label, unit } = this.parameter;
    const values = this.values();
    const text = this.isListed ? values.join(", ") : values.join(" to ");
    return `${label} ${text}${unit === "°" ? "°" : unit ? ` ${unit}` : ""}`;
  }
}

export class VaryRows {
  // onChange(): something else is varied, or from, to, or how.
  constructor(onChange) {
    Object.assign(this, { onChange, parameters: [], rows: [], method: "grid" });
    this.list = h("div", { class: "vary-rows" });
    this.more = h("button", { type: "button", on: { click: () => this.add() } }, "Vary another one, too");
    this.element = h("div", {}, this.list, this.more);
    this.add();
  }

  get isListed() {
    return this.method === "list";
  }

  add() {
    const row = new Row(this);
    const { first, other } = STEPS;
    row.boxes.steps.value = String(this.rows.length === 0 ? first : other);
    this.rows.push(row);
    this.list.append(row.element);
    if (this.parameters.length > 0) this.offer(this.parameters);
    this.show();
    if (this.rows.length > 1) row.chosen.focus();
  }

  drop(row) {
    this.rows = this.rows.filter((one) => one !== row);
    row.element.remove();
    this.show();
    this.onChange();
    this.rows[0].chosen.focus();
  }

  // parameters: as studyParameters() has them.
  offer(parameters) {
    this.parameters = parameters;
    for (const row of this.rows) {
      const taken = this.rows.filter((one) => one !== row).map(({ chosen }) => chosen.value);
      row.offer((parameters.find(({ pointer }) => !taken.includes(pointer)) ?? parameters[0]).pointer);
    }
    this.show();
  }

  choose(method) {
    this.method = method;
    this.show();
  }

  respace() {
    this.show();
    this.onChange();
  }

  show() {
    for (const [k, row] of this.rows.entries()) {
      row.element.setAttribute("aria-label", `Parameter ${k + 1}`);
      row.remove.hidden = this.rows.length === 1;
      row.show(this.method);
    }
    this.more.hidden = this.rows.length >= Math.min(MOST, this.parameters.length || 1);
  }

  get isReady() {
    return this.parameters.length > 0;
  }

  // What is wrong with the texts, which are marked; [text].
  faults() {
    const faults = this.rows.flatMap((row) => row.faults());
    const chosen = this.rows.map(({ chosen }) => chosen.value);
    if (new Set(chosen).size < chosen.length) faults.push("Parameter: one is varied twice");
    const lengths = this.rows.map((row) => row.values().length);
    if (this.isListed && new Set(lengths).size > 1) faults.push(`Values: each parameter needs as many as the others, not ${lengths.join(" and ")}`);
    return faults;
  }

  // Of a grid or of a list.
  nPoints() {
    return this.isListed ? this.rows[0].values().length : this.rows.reduce((n, row) => n * row.steps(), 1);
  }

  // "angle 60 to 90°, belt speed 0.3 to 0.5 m/s"; "": a number is missing.
  words() {
    return this.rows.every((row) => row.values().every(Number.isFinite)) ? this.rows.map((row) => row.words()).join(", ") : "";
  }

  // As the document of a study has them.
  document() {
    return this.rows.map((row) => ({ pointer: row.parameter.pointer, ...row.document(this.method) }));
  }

  // The scenario as the study wants it.
  base(scenario) {
    return baseFor(scenario, this.rows.map((row) => ({ parameter: row.parameter, values: row.values() })));
  }
}
