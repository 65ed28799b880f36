// What a new run or study begins with: a blank line, one that was edited in this browser, an example, or a past run.

import { getJson, listRuns, paths } from "../base/api.js";
import { h } from "../base/dom.js";
import { age, nameOf } from "../base/format.js";
import { note } from "../base/router.js";
import { blankLine, savedLines } from "../board/lines.js";

// The paper's first scenario.
const firstOf = (examples) => examples.find(({ name }) => name === "example-1") ?? examples[0];

export class ScenarioSource {
  // onChoose({ scenario, run, model, label, line, ofLine }), line: the id of one that was edited in this browser, ofLine: what
  // runs of it belong to; onFault(error).
  constructor(query, onChoose, onFault) {
    Object.assign(this, { query, onChoose, onFault });
    this.box = h("select", { on: { change: () => this.take(this.box.value) } });
    this.element = h("label", { class: "field wide" }, h("span", {}, "A line, an example or a past run"), this.box);
  }

  async load() {
    const [{ examples }, { runs }] = await Promise.all([getJson("v1/examples"), listRuns({ limit: 50 })]);
    const option = (value, text) => h("option", { value }, text);
    const group = (label, options) => (options.length > 0 ? [h("optgroup", { label }, options)] : []);
    const lines = savedLines();
    this.box.replaceChildren(option("blank:", "A blank line"),
      ...group("Edited in this browser", lines.map(({ id, scenario, saved_at: at }) => option(`line:${id}`, `${scenario.name || "without a name"} · ${age(at)}`))),
      ...group("Examples", examples.map(({ name, title }) => option(`example:${name}`, title ?? name))),
      ...group("Past runs", runs.map((run) => option(`run:${run.id}`, `${nameOf(run)} · ${run.model} · ${age(run.created_at)}`))));
    const [from, line] = ["from", "line"].map((name) => this.query.get(name));
    const example = `example:${this.query.get("example") ?? firstOf(examples).name}`;
    this.first = lines.some(({ id }) => id === line) ? `line:${line}` : this.query.has("blank") ? "blank:" : from ? `run:${from}` : example;
  }

  async begin() {
    this.box.value = this.first;
    await this.read(this.first);
  }

  take(source) {
    const [kind, name] = source.split(":");
    note({ line: kind === "line" ? name : "", blank: kind === "blank" ? "1" : "", from: kind === "run" ? name : "", example: kind === "example" ? name : "" });
    this.read(source);
  }

  async read(source) {
    const [kind, name] = source.split(":");
    try {
      if (kind === "blank") this.onChoose({ scenario: structuredClone(blankLine), run: null, isNamed: true });
      if (kind === "line") this.onChoose({ run: null, line: name, ...savedLines().find(({ id }) => id === name) });
      if (kind === "example") this.onChoose({ scenario: await getJson(`v1/examples/${encodeURIComponent(name)}`), run: null });
      if (kind === "run") {
        const [run, scenario] = await Promise.all([getJson(paths.run(name)), getJson(paths.of(name, "scenario"))]);
        this.onChoose({ scenario, run, model: run.model, label: run.label, ofLine: run.line });
      }
    } catch (error) {
      this.onFault(error);
    }
  }
}
