// The form of one thing of a scenario, made of the schema of its list: a box for each member, with its unit, what it means, and its
// limits. Members of the thing itself that are neither needed nor given are folded away.

import { h, iconButton } from "../base/dom.js";
import { readNumber, writeNumber } from "../base/numbers.js";
import { boxOf, faultOfNumber, formOf, labelOf, resolve } from "./schema.js";
import { converted, sampleOf } from "./things.js";

const LONGEST = 4000; // characters of a value that is changed in a box

export const valueAt = (item, path) => path.reduce((value, name) => value?.[name], item);

// Without a value the member goes.
function put(item, path, value) {
  const holder = valueAt(item, path.slice(0, -1));
  if (value === undefined) delete holder[path.at(-1)];
  else holder[path.at(-1)] = value;
}

// What its boxes follow from: objects and points that are given, and lengths of lists of them; not numbers, texts and lists of numbers,
// which have their boxes in any case.
function shapeOf(value) {
  if (Array.isArray(value)) return typeof value[0] === "object" ? `[${value.map(shapeOf)}]` : value.length === 2 ? "pair" : "";
  if (value === null || typeof value !== "object") return "";
  return `{${Object.entries(value).map(([name, inner]) => [name, shapeOf(inner)]).filter(([, shape]) => shape !== "").map(([name, shape]) => name + shape)}}`;
}

const listText = (values) => values.map((value) => (typeof value === "boolean" ? (value ? "yes" : "no") : writeNumber(value))).join("; ");

// { value } or { fault } of the text of a list; items are apart by semicolons, spaces or both after a comma.
function readList(text, { type }) {
  const parts = text.trim().split(/\s*;\s*|,\s+|\s+/).filter(Boolean);
  if (parts.length === 0) return { fault: "must be given" };
  if (type === "boolean") {
    const isGood = parts.every((part) => /^(?:yes|no|true|false)$/i.test(part));
    return isGood ? { value: parts.map((part) => /^(?:yes|true)$/i.test(part)) } : { fault: "must be yes or no, each" };
  }
  const read = parts.map((part) => readNumber(part));
  const fault = read.findIndex((one) => one.fault);
  return fault < 0 ? { value: read.map(({ value }) => value) } : { fault: `“${parts[fault]}” ${read[fault].fault}` };
}

function say({ box, fault }, text) {
  fault.textContent = text;
  fault.hidden = text === "";
  box.setAttribute("aria-invalid", String(text !== ""));
}

export class ThingForm {
  // onChange(edit): edit(item) writes into the thing; onFault(): a box has a fault; ids(list): those that can be named.
  constructor({ onChange, onFault, ids }) {
    Object.assign(this, { onChange, onFault, ids, built: "" });
    this.element = h("div", { class: "thing-form" });
  }

  // list, schema: of the thing; key: which thing it is. Boxes stay while only their values differ.
  show(list, schema, item, key) {
    Object.assign(this, { list, schema, item });
    const built = `${key} ${shapeOf(item)} ${this.ids("belts")} ${this.ids("photo_eyes")} ${this.ids("obstacles")} ${this.ids("feeds")} ${this.ids("kinds")}`;
    if (built !== this.built) this.rebuild(built);
    for (const entry of this.boxes.filter(({ box }) => box !== document.activeElement)) {
      entry.own = "";
      entry.write(valueAt(this.item, entry.path));
    }
  }

  // What is being typed goes on in the new box, also where that is folded away: a member that is not needed is, once it is empty.
  rebuild(built) {
    const typed = this.boxes?.find(({ box }) => box === document.activeElement)?.box;
    const isOpen = this.element.querySelector("details")?.open && this.built.split(" {")[0] === built.split(" {")[0];
    this.built = built;
    this.boxes = [];
    this.element.replaceChildren(...this.objectBoxes(this.schema, []));
    for (const details of isOpen ? this.element.querySelectorAll("details") : []) details.open = true;
    const entry = this.boxes.find(({ box }) => box.id === typed?.id);
    if (!entry) return;
    entry.box.closest("details")?.setAttribute("open", "");
    entry.box.value = typed.value;
    entry.box.focus();
    if (typed.selectionEnd !== undefined && typed.selectionEnd !== null) entry.box.setSelectionRange(typed.selectionEnd, typed.selectionEnd);
  }

  objectBoxes(schema, path) {
    const value = valueAt(this.item, path);
    const form = formOf(schema, value);
    const shown = [], folded = [];
    for (const [member, inner] of Object.entries(form.properties)) {
      const box = boxOf(member, inner);
      const isNeeded = form.required?.includes(member) || value[member] !== undefined;
      (isNeeded || path.length > 0 ? shown : folded).push(this.memberBox(box, [...path, member], Boolean(form.required?.includes(member))));
    }
    return [this.formChoice(schema, form, path), h("div", { class: "fields" }, shown),
      folded.length === 0 ? null : h("details", {}, h("summary", {}, "More"), h("div", { class: "fields" }, folded))].filter(Boolean);
  }

  // Where an object can be written in several forms.
  formChoice(schema, form, path) {
    if (!schema.oneOf) return null;
    const id = `thing-${path.join("-")}-form`;
    const box = h("select", { id, on: { change: () => this.change((item) => {
      const made = converted(this.list, valueAt(item, path), schema.oneOf[Number(box.value)], this.ids);
      if (path.length > 0) return put(item, path, made);
      for (const name of Object.keys(item)) delete item[name];
      return Object.assign(item, made);
    }) } }, schema.oneOf.map(({ title }, k) => h("option", { value: String(k) }, labelOf(title))));
    box.value = String(schema.oneOf.indexOf(form));
    return h("div", { class: "field" }, h("label", { for: id }, "Given by"), box);
  }

  memberBox(box, path, isNeeded) {
    const { kind } = box;
    if (kind === "one-or-many") return this.oneOrMany(box, path, isNeeded);
    if (kind === "object" || kind === "objects") return this.group(box, path, isNeeded);
    if (kind === "point" || kind === "points") return this.places(box, path, isNeeded);
    return this.single(box, path, isNeeded);
  }

  // A text, a number, a choice, a list of numbers, or JSON in one box.
  single({ kind, label, unit, said, usual, schema, word, choices, member }, path, isNeeded) {
    const id = `thing-${path.join("-")}`;
    const options = { choice: () => choices, truth: () => ["yes", "no"], id: () => this.ids(`${member}s`) }[kind]?.();
    const take = () => this.take(entry, () => this.read({ kind, schema, word }, box.value, isNeeded));
    const box = options
      ? h("select", { id, on: { input: take } }, [...(isNeeded ? [] : [""]), ...options].map((value) => h("option", { value }, value === "" ? `as usual: ${usual || "not given"}` : value)))
      : h("input", { id, type: "text", autocomplete: "off", inputmode: kind === "number" ? "decimal" : null, placeholder: usual, "aria-describedby": `${id}-hint ${id}-fault`,
        on: { input: take } });
    const fault = h("small", { class: "fault", id: `${id}-fault`, hidden: true });
    const write = (value) => {
      const isNumber = typeof value === "number";
      const text = value === undefined ? "" : kind === "truth" ? (value ? "yes" : "no") : Array.isArray(value) && kind === "list" ? listText(value)
        : isNumber ? writeNumber(value) : typeof value === "string" ? value : JSON.stringify(value);
      if (options && text !== "" && ![...box.options].some((option) => option.value === text)) box.append(h("option", { value: text }, text));
      box.readOnly = text.length > LONGEST;
      box.value = box.readOnly ? `${value.length} of them: change them as JSON` : text;
    };
    const entry = { box, path, write, fault, own: "" };
    this.boxes.push(entry);
    return h("div", { class: "field" }, h("label", { for: id }, label), h("span", { class: "with-unit" }, box, unit ? h("span", { class: "unit" }, unit) : null),
      h("small", { class: "hint", id: `${id}-hint` }, said), fault);
  }

  read({ kind, schema, word }, text, isNeeded) {
    if (text.trim() === "") return isNeeded ? { fault: "must be given" } : { value: undefined };
    if (kind === "truth") return { value: text === "yes" };
    if (kind === "list") return readList(text, schema.items);
    if (kind === "number") {
      if (text.trim() === word) return { value: word };
      const { value, fault } = readNumber(text);
      return { value, fault: fault || faultOfNumber({ schema }, value) };
    }
    if (kind !== "json") return { value: text };
    try {
      return { value: JSON.parse(text) };
    } catch {
      return { fault: "must be JSON" };
    }
  }

  take(entry, read) {
    const { value, fault = "" } = read();
    entry.own = fault;
    say(entry, fault);
    if (fault !== "") this.onFault();
    else this.change((item) => put(item, entry.path, value), entry.path);
  }

  change(edit, path = []) {
    this.onChange(edit, path);
  }

  // One point or several, a pair of boxes each.
  places({ kind, label, unit, said, schema, member }, path, isNeeded) {
    const value = valueAt(this.item, path);
    const legend = h("legend", {}, label, unit ? ` [${unit}]` : "");
    const remove = () => this.change((item) => put(item, path, undefined));
    if (value === undefined) return h("fieldset", { class: "places" }, legend, h("small", { class: "hint" }, said), this.adder(label, { kind, member, schema }, path));
    const pairs = kind === "point" ? [path] : value.map((_, k) => [...path, k]);
    const isLong = kind === "points" && pairs.length > (schema.minItems ?? 0);
    const rows = pairs.map((at, k) => h("div", { class: "place-row" },
      [0, 1].map((axis) => this.coordinate([...at, axis], `${label}${kind === "point" ? "" : ` ${k + 1}`}, ${kind === "point" && /^[xy]_m$/.test(member) ? ["from", "to"][axis] : "xy"[axis]}`)),
      isLong ? iconButton("trash", `Remove ${label} ${k + 1}`, () => this.change((item) => valueAt(item, path).splice(k, 1))) : null));
    const canGrow = kind === "points" && pairs.length < (schema.maxItems ?? Infinity);
    return h("fieldset", { class: "places" }, legend, h("small", { class: "hint" }, said), rows,
      canGrow ? h("button", { type: "button", on: { click: () => this.change((item) => valueAt(item, path).push([...value.at(-1)])) } }, "Add a point") : null,
      isNeeded ? null : h("button", { type: "button", on: { click: remove } }, `Without ${label.toLowerCase()}`));
  }

  coordinate(path, name) {
    const fault = h("small", { class: "fault", hidden: true });
    const box = h("input", { type: "text", inputmode: "decimal", autocomplete: "off", id: `thing-${path.join("-")}`, "aria-label": name,
      on: { input: () => this.take(entry, () => readNumber(box.value)) } });
    const entry = { box, path, fault, own: "", write: (value) => (box.value = value === undefined ? "" : writeNumber(value)) };
    this.boxes.push(entry);
    return h("span", {}, box, fault);
  }

  adder(label, box, path) {
    return h("button", { type: "button", on: { click: () => this.change((item) => put(item, path, sampleOf(box, this.ids))) } }, `Give ${label.toLowerCase()}`);
  }

  // Of one or many, by what it is now; the button makes the other of it.
  oneOrMany(box, path, isNeeded) {
    const many = box.schema.oneOf.find(({ type }) => type === "array"), one = resolve(box.schema.oneOf.find(({ type }) => type !== "array"));
    const isMany = Array.isArray(valueAt(this.item, path));
    const other = () => this.change((item) => {
      const value = valueAt(item, path);
      put(item, path, isMany ? converted("", value[0], one, this.ids) : [converted("", value, resolve(many.items), this.ids)]);
    });
    const group = this.group({ ...box, ...(isMany ? { kind: "objects", schema: many } : { kind: "object", schema: one }) }, path, isNeeded);
    group.append(h("button", { type: "button", on: { click: other } }, isMany ? "Only the first" : "A mix of several"));
    return group;
  }

  // An object in the thing, or a list of them.
  group(box, path, isNeeded) {
    const { kind, label, said, schema } = box;
    const value = valueAt(this.item, path);
    const legend = h("legend", {}, label);
    const hint = h("small", { class: "hint" }, said);
    if (value === undefined) return h("fieldset", {}, legend, hint, this.adder(label, box, path));
    const inner = kind === "object" ? this.objectBoxes(schema, path) : [
      ...value.map((_, k) => h("div", { class: "group-row" }, this.objectBoxes(resolve(schema.items), [...path, k]),
        value.length > (schema.minItems ?? 0) ? iconButton("trash", `Remove ${label} ${k + 1}`, () => this.change((item) => valueAt(item, path).splice(k, 1))) : null)),
      h("button", { type: "button", on: { click: () => this.change((item) => this.addTo(valueAt(item, path), box)) } }, "Add one")];
    return h("fieldset", {}, legend, hint, inner,
      isNeeded ? null : h("button", { type: "button", on: { click: () => this.change((item) => put(item, path, undefined)) } }, `Without ${label.toLowerCase()}`));
  }

  // As the last one is, but for its id.
  addTo(list, box) {
    const { id: _, ...rest } = list.at(-1) ?? sampleOf({ ...box, kind: "objects" }, this.ids)[0];
    list.push(structuredClone(rest));
  }

  // Each fault of the thing at the box it is about: { pointer below the thing, detail }.
  showFaults(errors) {
    for (const entry of this.boxes ?? []) {
      const here = errors.filter(({ pointer }) => pointer === `/${entry.path.join("/")}`);
      say(entry, entry.own || here.map(({ detail }) => detail).join("; "));
    }
  }

  // Whether a text never came into the scenario.
  hasFaults() {
    return (this.boxes ?? []).some(({ own }) => own !== "");
  }
}
