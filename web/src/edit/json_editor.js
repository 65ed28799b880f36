// The scenario as JSON text, with faults and warnings at their places. What it is edited with is loaded when it is
// opened for the first time: it is larger than all other modules together.

import { h } from "../base/dom.js";

export class JsonEditor {
  constructor(onInput) {
    Object.assign(this, { onInput, code: null, given: "", errors: [], warnings: [] });
    this.list = h("ol", { class: "faults", "aria-label": "Faults" });
    this.box = h("div", { class: "json-box" });
    this.element = h("div", {}, this.box, this.list);
  }

  get text() {
    return this.code?.text ?? this.given;
  }

  set text(value) {
    this.given = value;
    if (this.code) this.code.text = value;
  }

  async open() {
    if (this.code || this.isLoading) return;
    this.isLoading = true;
    this.box.replaceChildren(h("p", { class: "loading" }, "Loading …"));
    try {
      const { CodeEditor } = await import("./code_editor.js");
      if (this.isGone) return;
      this.code = new CodeEditor(this.box,
        { text: this.given, label: "Scenario as JSON", description: this.list, onInput: this.onInput });
      this.mark();
    } catch (error) {
      this.box.replaceChildren(h("p", { class: "loading" }, `The editor could not be loaded: ${error.message}`));
    } finally {
      this.isLoading = false;
    }
  }

  dispose() {
    this.isGone = true;
    this.code?.dispose();
  }

  // errors: [{ pointer (below the scenario), detail }].
  showFaults(errors) {
    this.errors = errors;
    this.mark();
  }

  // warnings: [{ pointer, title, meaning }].
  showWarnings(warnings) {
    this.warnings = warnings.map(({ pointer, title, meaning }) => ({ pointer, detail: `${title}. ${meaning}` }));
    this.mark();
  }

  mark() {
    if (!this.code) return;
    const faults = this.code.mark(this.errors, this.warnings);
    this.list.replaceChildren(...faults.map((fault) => h("li", {},
      h("button", { type: "button", class: "fault-link", on: { click: () => this.code.select(fault) } },
        h("span", { class: "place" }, `line ${fault.line}${fault.pointer ? ` · ${fault.pointer}` : ""}`), fault.message))));
  }
}
