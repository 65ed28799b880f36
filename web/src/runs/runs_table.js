// The rows of the list of runs. A row is made once and changed in place, so that focus, selection and
// scroll stay where they are.

import { isOver } from "../base/api.js";
import { h, iconButton, link, setText } from "../base/dom.js";
import { age, moment, nameOf } from "../base/format.js";
import { address } from "../base/router.js";
import { lineLink, statePill, suspicion } from "../base/run_words.js";
import { columns, titleOfLabel } from "./runs_columns.js";

export class RunRow {
  // actions: { onStar, onCancel, onRemove, onSelect }.
  constructor(run, actions) {
    this.id = run.id;
    this.title = link(address("runs", run.id), "");
    this.label = h("small", { class: "label" });
    this.line = h("small", { class: "of-line" });
    this.chips = h("span", { class: "chips" });
    this.state = statePill(run);
    this.bar = h("progress", { max: "1" });
    this.fault = h("small", { class: "fault" });
    this.age = h("time");
    this.check = h("input", { type: "checkbox", on: { change: () => actions.onSelect(run, this.check.checked) } });
    this.star = iconButton("star", "Star", () => actions.onStar(this.run), { class: "bare star" });
    this.cancel = iconButton("stop", "Cancel", () => actions.onCancel(this.run), { class: "bare" });
    this.remove = iconButton("trash", "Delete", () => actions.onRemove(this.run), { class: "bare" });
    this.texts = new Map(columns.filter(({ text }) => text).map(({ name, title }) => [name, h("span", { class: "figures", title })]));
    const inside = { State: [this.state.pill], Progress: [this.bar, this.texts.get("Progress"), this.fault], Age: [this.age] };
    this.name = h("td", { role: "cell", class: "name" }, this.title, this.label, this.line, this.chips);
    this.parameters = [];
    this.element = h("tr", { role: "row" },
      h("td", { role: "cell", class: "pick" }, h("label", {}, this.check, h("span", { class: "hidden" }, "Compare"))), this.name,
      columns.slice(1).map(({ name, kind }) => h("td", { role: "cell", "data-label": name, class: kind }, inside[name] ?? this.texts.get(name))),
      h("td", { role: "cell", class: "actions" }, this.star, this.cancel, this.remove));
    this.show(run);
  }

  show(run) {
    this.run = run;
    const name = nameOf(run);
    setText(this.title, name);
    setText(this.label, run.label);
    this.label.hidden = !run.label;
    this.showLine(run);
    for (const { name: column, text } of columns) if (text) setText(this.texts.get(column), text(run));
    this.state.show(run);
    this.bar.value = run.progress;
    this.bar.hidden = run.status !== "running";
    this.bar.setAttribute("aria-label", `Progress of ${name}`);
    const fault = run.error?.detail ?? (run.suspect ? suspicion : "");
    setText(this.fault, fault);
    this.fault.hidden = !fault;
    this.age.dateTime = run.created_at;
    this.age.title = moment(run.created_at);
    setText(this.age, age(run.created_at));
    this.cancel.classList.toggle("absent", isOver(run));
    this.star.setAttribute("aria-pressed", String(run.starred === true));
    for (const button of [this.star, this.cancel, this.remove]) button.setAttribute("aria-label", `${button.title} ${name}`);
    this.check.setAttribute("aria-label", `Select ${name} (${run.model}) to compare`);
  }

  // Made again only when it is another, so that the focus stays.
  showLine(run) {
    const [made] = lineLink(run);
    if (this.line.textContent !== (made?.textContent ?? "")) this.line.replaceChildren(...(made ? [made] : []));
  }

  // What distinguishes the run from its variants: parameters in columns behind its name, ["75°", "0.5 m/s"], and those that
  // have no column, ["foot at y 0 m"].
  showVariant(labels, { texts, chips }) {
    const key = JSON.stringify([labels, texts, chips]);
    if (this.shownVariant === key) return;
    this.shownVariant = key;
    this.chips.replaceChildren(...chips.map((chip) => h("span", { class: "chip" }, chip)));
    for (const cell of this.parameters) cell.remove();
    this.parameters = labels.map((label, k) => h("td", { role: "cell", "data-label": titleOfLabel(label), class: "right" }, texts[k]));
    this.name.after(...this.parameters);
  }
}
