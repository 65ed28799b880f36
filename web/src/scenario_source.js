// What a new run or study begins with: an example, a past run, or the scenario that was edited last in the form.

import { getJson, listRuns, paths } from "./api.js";
import { h } from "./dom.js";
import { age, nameOf } from "./format.js";
import { note } from "./router.js";

const KEY = "beltflow-draft";

// The scenario that the form hands on: { scenario, model, label }. It lasts as long as the tab.
export function setDraft(draft) {
  try {
    sessionStorage.setItem(KEY, JSON.stringify(draft));
  } catch {
    // Where the browser stores nothing, the study begins with an example.
  }
}

function draft() {
  try {
    return JSON.parse(sessionStorage.getItem(KEY));
  } catch {
    return null;
  }
}

// The paper's first scenario.
const firstOf = (examples) => examples.find(({ name }) => name === "example-1") ?? examples[0];

export class ScenarioSource {
  // onChoose({ scenario, run, model, label }), onFault(error).
  constructor(query, onChoose, onFault) {
    Object.assign(this, { query, onChoose, onFault });
    this.box = h("select", { on: { change: () => this.take(this.box.value) } });
    this.element = h("label", { class: "field wide" }, h("span", {}, "Example or past run"), this.box);
  }

  async load() {
    const [{ examples }, { runs }] = await Promise.all([getJson("v1/examples"), listRuns({ limit: 50 })]);
    const option = (value, text) => h("option", { value }, text);
    this.box.replaceChildren(
      ...(this.query.has("draft") && draft() ? [option("draft:", "As it was edited in the form")] : []),
      h("optgroup", { label: "Examples" }, examples.map(({ name, title }) => option(`example:${name}`, title ?? name))),
      ...(runs.length > 0 ? [h("optgroup", { label: "Past runs" },
        runs.map((run) => option(`run:${run.id}`, `${nameOf(run)} · ${run.model} · ${age(run.created_at)}`)))] : []));
    const from = this.query.get("from");
    this.first = this.query.has("draft") && draft() ? "draft:" : from ? `run:${from}` : `example:${this.query.get("example") ?? firstOf(examples).name}`;
  }

  async begin() {
    this.box.value = this.first;
    await this.read(this.first);
  }

  take(source) {
    const [kind, name] = source.split(":");
    note({ draft: kind === "draft" ? "1" : "", from: kind === "run" ? name : "", example: kind === "example" ? name : "" });
    this.read(source);
  }

  async read(source) {
    const [kind, name] = source.split(":");
    try {
      if (kind === "draft") this.onChoose({ run: null, ...draft() });
      if (kind === "example") this.onChoose({ scenario: await getJson(`v1/examples/${encodeURIComponent(name)}`), run: null });
      if (kind === "run") {
        const [run, scenario] = await Promise.all([getJson(paths.run(name)), getJson(paths.of(name, "scenario"))]);
        this.onChoose({ scenario, run, model: run.model, label: run.label });
      }
    } catch (error) {
      this.onFault(error);
    }
  }
}
