// What stands on the line: a palette to add things, all things by their kinds, and the form of the one that is chosen, which can be
// doubled, mirrored, turned and deleted. `stand` and `thing` are its two elements.

import { h, setText } from "../base/dom.js";
import { listsOf, schemaOfLine } from "./schema.js";
import { ThingForm, valueAt } from "./thing_form.js";
import { freshId, idsOf, keepAtSide, kindOf, middleOf, mirrored, movedBy, nameOfThing, rename, turned } from "./things.js";

const LINE = { list: "" }; // the line as a whole, without what stands on it
const BESIDE = ["name", "duration_s", "domain", "warmup_s"]; // the form beside the board has these
const ASIDE_M = 0.1; // how far a double stands from what it was made of

const inWords = (faults) => faults.map(({ detail }) => detail).join("; ");

export class Board {
  // onChange(set, what): the scenario is changed by set(scenario), at the box that is named; onChoose(): another thing is chosen; onFault(): a box has a fault.
  constructor({ onChange, onChoose, onFault }) {
    Object.assign(this, { onChange, onChoose, chosen: null, errors: [], scenario: null, resolved: null });
    this.lists = listsOf();
    this.lineSchema = schemaOfLine(BESIDE);
    this.form = new ThingForm({ onChange: (edit, path) => this.edit(edit, path), onFault, ids: (list) => this.ids(list) });
    this.palette = h("div", { class: "palette", role: "group", "aria-label": "Add" });
    this.list = h("ul", { class: "things" });
    this.title = h("h3", {});
    this.tools = h("div", { class: "palette", role: "group", "aria-label": "What is chosen" });
    this.thing = h("section", { class: "thing", "aria-label": "What is chosen", hidden: true }, this.title, this.tools, this.form.element);
    this.stand = h("div", { class: "board" }, this.palette, this.list);
  }

  ids(list) {
    return this.scenario ? idsOf(this.scenario, this.resolved, list) : [];
  }

  // resolved: of the server's last validation; names what has no id.
  show(scenario, resolved) {
    Object.assign(this, { scenario, resolved });
    this.isShown = Array.isArray(scenario?.domain?.x_m) && Array.isArray(scenario.domain.y_m);
    this.stand.hidden = !this.isShown;
    if (!this.isShown) this.chosen = null;
    this.thing.hidden = this.chosen === null;
    if (!this.isShown) return;
    if (this.chosen && !this.chosenIn(scenario)) this.chosen = null;
    this.showPalette();
    this.showList();
    this.showThing();
  }

  chosenIn(scenario) {
    return this.chosen.list === LINE.list ? scenario : scenario[this.chosen.list]?.[this.chosen.k];
  }

  choose(list, k) {
    this.chosen = { list, k };
    this.showList();
    this.showThing();
    this.onChoose();
  }

  showPalette() {
    const makes = this.lists.flatMap((one) => kindOf(one).makes.map(([title, make]) => ({ one, title, make })));
    const key = makes.map(({ title, one }) => `${title}${this.lacks(one)}`).join();
    if (key === this.paletteKey) return;
    this.paletteKey = key;
    this.palette.replaceChildren(...makes.map(({ one, title, make }) => h("button", { type: "button", disabled: this.lacks(one),
      title: this.lacks(one) ? "A rule follows a photo eye: add one first" : `Add: ${title}`, on: { click: () => this.add(one, make) } }, `+ ${title}`)));
  }

  lacks(one) {
    const { needs } = kindOf(one);
    return needs !== undefined && this.ids(needs).length === 0;
  }

  // A thing of a list that was made elsewhere.
  take(list, item) {
    this.add(this.lists.find((one) => one.list === list), () => item);
  }

  add(one, make) {
    const { stem, first = [] } = kindOf(one);
    this.onChange((scenario) => {
      const items = (scenario[one.list] ??= structuredClone(first));
      const id = stem ? { id: freshId(scenario, this.resolved, one.list, stem) } : {};
      items.push({ ...id, ...structuredClone(make(scenario.domain, (list) => idsOf(scenario, this.resolved, list), scenario)) });
      this.chosen = { list: one.list, k: items.length - 1 };
    });
    this.onChoose();
  }

  // Elements stay while they say the same: an answer of the server that comes during a press must not take the button away.
  showList() {
    const rows = [this.rowOfLine(), ...this.lists.flatMap((one) => (this.scenario[one.list] ?? []).map((_, k) => this.rowOf(one, k)))];
    const key = JSON.stringify(rows);
    if (key === this.listKey) return;
    this.listKey = key;
    this.list.replaceChildren(...rows.map(({ list, k, kind, name, isChosen, faults }) => h("li", {},
      h("button", { type: "button", "aria-pressed": String(isChosen), on: { click: () => this.choose(list, k) } }, h("span", { class: "muted" }, kind), name),
      faults === "" ? null : h("small", { class: "fault" }, faults))));
  }

  rowOf(one, k) {
    const { list } = one;
    const faults = this.errors.filter(({ pointer }) => pointer.startsWith(`/${list}/${k}/`) || pointer === `/${list}/${k}`);
    return { list, k, kind: kindOf(one).one, name: nameOfThing(this.scenario, this.resolved, list, k),
      isChosen: this.chosen?.list === list && this.chosen.k === k, faults: inWords(faults) };
  }

  rowOfLine() {
    return { ...LINE, k: 0, kind: "Line", name: this.scenario.name ?? "", isChosen: this.chosen?.list === LINE.list,
      faults: inWords(this.errors.filter(({ pointer }) => this.isOfLine(pointer))) };
  }

  isOfLine(pointer) {
    return Object.hasOwn(this.lineSchema.properties, pointer.split("/")[1]);
  }

  showThing() {
    this.thing.hidden = this.chosen === null;
    if (this.chosen === null) return;
    const { list, k } = this.chosen;
    if (list === LINE.list) return this.showLine();
    const one = this.lists.find((other) => other.list === list);
    const item = this.scenario[list][k];
    setText(this.title, `${kindOf(one).one} ${nameOfThing(this.scenario, this.resolved, list, k)}`);
    const hasPlace = middleOf(item) !== null;
    this.showTools([
      ["Double", () => this.double(one, k), true],
      ["Mirror", () => this.change((scenario) => (scenario[list][k] = mirrored(scenario[list][k], scenario.domain))), hasPlace || item.edge !== undefined],
      ["Turn by 90°", () => this.change((scenario) => (scenario[list][k] = turned(scenario[list][k]))), hasPlace],
      ["Delete", () => this.remove(one, k), this.scenario[list].length > one.least]], `${list} ${k}`);
    this.form.show(list, one.schema, item, `${list} ${k}`);
    this.placeFaults();
  }

  // Its cargo and edges, what lies on it at the start, and how it is solved.
  showLine() {
    setText(this.title, "The line");
    this.showTools([], "line");
    this.form.show(LINE.list, this.lineSchema, this.scenario, "line");
    this.placeFaults();
  }

  showTools(tools, thing) {
    const key = JSON.stringify([thing, tools.map(([, , isPossible]) => isPossible)]);
    if (key === this.toolsKey) return;
    this.toolsKey = key;
    this.tools.replaceChildren(...tools.map(([text, change, isPossible]) =>
      h("button", { type: "button", disabled: !isPossible, on: { click: change } }, text)));
  }

  change(set) {
    this.onChange(set);
  }

  // By its form: what names it follows its id.
  edit(edit, path) {
    const { list, k } = this.chosen;
    const named = path[0] === "cargo" && list === LINE.list ? "kinds" : list;
    const idIn = (item) => (path.at(-1) === "id" ? valueAt(item, path) : undefined);
    this.onChange((scenario) => {
      const item = this.chosenIn(scenario), before = idIn(item), old = structuredClone(item);
      edit(item);
      if (list === "obstacles" && path.join() === "angle_deg") keepAtSide(item, old, scenario.domain);
      const after = idIn(item);
      if (before !== undefined && after !== undefined) rename(scenario, named, before, after);
    }, path.length > 0 ? `${list} ${k} ${path}` : null);
  }

  double({ list, schema }, k) {
    const { stem } = kindOf({ list, schema });
    this.change((scenario) => {
      const copy = structuredClone(scenario[list][k]);
      if (stem) copy.id = freshId(scenario, this.resolved, list, stem);
      scenario[list].push(middleOf(copy) ? movedBy(copy, [ASIDE_M, 0]) : copy);
      this.chosen = { list, k: scenario[list].length - 1 };
    });
    this.onChoose();
  }

  remove({ list, least }, k) {
    this.chosen = null;
    this.change((scenario) => {
      scenario[list].splice(k, 1);
      if (scenario[list].length === 0 && least === 0) delete scenario[list];
    });
    this.onChoose();
  }

  // Those that are about a thing, at its row and in its form; the rest is returned.
  showFaults(errors) {
    this.errors = errors.filter(({ pointer = "" }) => this.isOfLine(pointer) || this.lists.some(({ list }) => pointer.startsWith(`/${list}/`)));
    if (this.isShown) {
      this.showList();
      this.placeFaults();
    }
    return errors.filter((error) => !this.errors.includes(error));
  }

  placeFaults() {
    if (this.chosen === null) return;
    const at = this.chosen.list === LINE.list ? "" : `/${this.chosen.list}/${this.chosen.k}`;
    this.form.showFaults(this.errors.filter(({ pointer }) => pointer.startsWith(`${at}/`)).map(({ pointer, detail }) => ({ pointer: pointer.slice(at.length), detail })));
  }

  // Texts that never came into the scenario.
  hasFaults() {
    return this.chosen !== null && this.form.hasFaults();
  }

  countFaults() {
    return this.errors.length + (this.hasFaults() ? 1 : 0);
  }

  // To the form of the first thing that has one.
  focusFault() {
    const [, list, k] = this.errors[0]?.pointer.split("/") ?? [];
    if (!this.hasFaults() && list) this.isOfLine(this.errors[0].pointer) ? this.choose(LINE.list, 0) : this.choose(list, Number(k));
    this.thing.querySelector("[aria-invalid=true]")?.focus();
  }
}
