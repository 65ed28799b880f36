// The scenario as JSON text, with numbers of lines, and faults marked at their lines.

import { h } from "./dom.js";
import { locate, offsetOf } from "./json_text.js";

export class JsonEditor {
  constructor(onInput) {
    this.faults = [];
    this.gutter = h("div", { class: "gutter", "aria-hidden": "true" });
    this.area = h("textarea", { class: "json-area", spellcheck: "false", autocomplete: "off", autocapitalize: "off",
      wrap: "off", rows: "24", "aria-label": "Scenario as JSON", "aria-describedby": "json-faults",
      on: { input: () => {
        this.number();
        onInput();
      }, scroll: () => (this.gutter.scrollTop = this.area.scrollTop) } });
    this.list = h("ol", { class: "faults", id: "json-faults", "aria-label": "Faults" });
    this.element = h("div", { class: "json-editor" }, h("div", { class: "json-box" }, this.gutter, this.area), this.list);
  }

  get text() {
    return this.area.value;
  }

  set text(value) {
    this.area.value = value;
    this.number();
  }

  lineAt(offset) {
    return this.text.slice(0, offset).split("\n").length;
  }

  number() {
    const marked = new Map(this.faults.map(({ line, detail }) => [line, detail]));
    const n = this.text.split("\n").length;
    this.gutter.replaceChildren(...Array.from({ length: n }, (_, k) =>
      h("span", { class: marked.has(k + 1) ? "bad" : null, title: marked.get(k + 1) }, String(k + 1))));
  }

  // errors: [{ pointer (below the scenario), detail }].
  showFaults(errors) {
    this.faults = errors.map(({ pointer, detail }) => ({ pointer, ...this.placeOf(pointer, detail) }));
    this.area.setAttribute("aria-invalid", String(errors.length > 0));
    this.number();
    this.list.replaceChildren(...this.faults.map((fault) => h("li", {},
      h("button", { type: "button", class: "fault-link", on: { click: () => this.select(fault) } },
        h("span", { class: "place" }, `line ${fault.line}${fault.pointer ? ` · ${fault.pointer}` : ""}`), fault.detail))));
  }

  // Text that is no JSON has its place in the words of the fault.
  placeOf(pointer, detail) {
    const match = /^line (\d+), column (\d+): (.*)$/s.exec(detail);
    if (match) {
      const start = offsetOf(this.text, Number(match[1]), Number(match[2]));
      return { start, end: start + 1, line: this.lineAt(start), detail: match[3] };
    }
    const { start, end } = locate(this.text, pointer);
    return { start, end, line: this.lineAt(start), detail };
  }

  select({ start, end, line }) {
    this.area.focus();
    this.area.setSelectionRange(start, end);
    const height = this.area.scrollHeight / Math.max(1, this.text.split("\n").length);
    this.area.scrollTop = Math.max(0, (line - 6) * height);
  }
}
