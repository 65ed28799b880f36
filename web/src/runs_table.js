// The rows of the list of runs. A row is made once and changed in place, so that focus, selection and
// scroll stay where they are.

import { isOver } from "./api.js";
import { h, iconButton, link, setText } from "./dom.js";
import { age, fixed, moment, nameOf, number, percent, quantity, span } from "./format.js";
import { address } from "./router.js";

export const states = ["queued", "running", "succeeded", "failed", "cancelled"];

export function statePill(run) {
  const pill = h("span", { class: "pill" }, h("i", { class: "dot" }), h("span"));
  return { pill, show: (current) => {
    pill.dataset.state = current.status;
    setText(pill.lastChild, current.status);
    pill.title = current.error?.detail ?? "";
  } };
}

function cell(name, ...children) {
  return h("td", { role: "cell", "data-label": name }, ...children);
}

function count(parts) {
  const isCounted = Math.abs(parts - Math.round(parts)) < 0.05 || parts >= 1000;
  return isCounted ? number(Math.round(parts), 6) : fixed(parts, 1);
}

// Parts that have left the belt, of those at the start and those that entered; what is unknown is left out.
export function throughText({ left, start, entered = 0 } = {}) {
  if (left === undefined || left === null) return "–";
  const all = start === undefined ? 0 : start + entered;
  return all > 0 ? `${count(left)} of ${count(all)}` : count(left);
}

export class RunRow {
  // actions: { onCancel, onRemove, onSelect }.
  constructor(run, actions) {
    this.id = run.id;
    this.title = link(address("runs", run.id), "");
    this.label = h("small", { class: "label" });
    this.chips = h("span", { class: "chips" });
    this.state = statePill(run);
    this.bar = h("progress", { max: "1" });
    this.share = h("span", { class: "figures" });
    this.fault = h("small", { class: "fault" });
    this.through = cell("Parts through", h("span", { class: "figures" }));
    this.throughput = cell("Throughput", h("span", { class: "figures", title: "Parts that left, in an hour" }));
    this.age = h("time");
    this.check = h("input", { type: "checkbox", on: { change: () => actions.onSelect(run, this.check.checked) } });
    this.cancel = iconButton("stop", "Cancel", () => actions.onCancel(this.run), { class: "bare" });
    this.remove = iconButton("trash", "Delete", () => actions.onRemove(this.run), { class: "bare" });
    this.model = h("span", { class: "model" });
    this.element = h("tr", { role: "row" },
      h("td", { role: "cell", class: "pick" }, h("label", {}, this.check, h("span", { class: "hidden" }, "Compare"))),
      h("td", { role: "cell", class: "name" }, this.title, this.label, this.chips),
      cell("Model", this.model), cell("State", this.state.pill),
      h("td", { role: "cell", class: "progress", "data-label": "Progress" }, this.bar, this.share, this.fault),
      this.through, this.throughput, cell("Age", this.age),
      h("td", { role: "cell", class: "actions" }, this.cancel, this.remove));
    for (const element of [this.through, this.throughput]) element.classList.add("right");
    this.show(run);
  }

  show(run) {
    this.run = run;
    const name = nameOf(run);
    setText(this.title, name);
    setText(this.label, run.label);
    this.label.hidden = !run.label;
    setText(this.model, run.model);
    this.model.dataset.model = run.model;
    this.state.show(run);
    this.bar.value = run.progress;
    this.bar.hidden = run.status !== "running";
    this.bar.setAttribute("aria-label", `Progress of ${name}`);
    setText(this.share, progressText(run));
    setText(this.fault, run.error ? run.error.detail : "");
    this.fault.hidden = !run.error;
    setText(this.throughput.firstChild, quantity(run.key_figures?.throughput_per_h, "/h"));
    this.age.dateTime = run.created_at;
    this.age.title = moment(run.created_at);
    setText(this.age, age(run.created_at));
    this.cancel.classList.toggle("absent", isOver(run));
    for (const button of [this.cancel, this.remove]) button.setAttribute("aria-label", `${button.title} ${name}`);
    this.check.setAttribute("aria-label", `Select ${name} (${run.model}) to compare`);
  }

  // What distinguishes the run from its variants: ["angle 75°"].
  showChips(chips) {
    const key = chips.join();
    if (this.shownChips === key) return;
    this.shownChips = key;
    this.chips.replaceChildren(...chips.map((chip) => h("span", { class: "chip" }, chip)));
  }

  showThrough(through) {
    setText(this.through.firstChild, throughText(through));
  }
}

function progressText(run) {
  if (run.status === "queued") return "waiting";
  if (run.status === "running") {
    const rest = run.eta_s > 0 ? `, ${span(run.eta_s)} left` : "";
    return `${percent(Math.floor(run.progress * 100) / 100)}${rest}`;
  }
  if (run.status === "succeeded") {
    return run.started_at ? `done in ${span((Date.parse(run.finished_at) - Date.parse(run.started_at)) / 1000)}` : "done";
  }
  return run.status === "failed" ? `failed at ${percent(Math.floor(run.progress * 100) / 100)}`
    : `stopped at ${percent(Math.floor(run.progress * 100) / 100)}`;
}
