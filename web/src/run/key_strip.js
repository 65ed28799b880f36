// The six figures that a planner decides by: of one run in a strip below its title, of several in a table. Their definitions
// are the API's.

import { isOver } from "../base/api.js";
import { h } from "../base/dom.js";
import { fixed, number, parts, quantity } from "../base/format.js";
import { fallsOf, isFed } from "../plot/series.js";
import { residenceOf } from "./key_figures.js";

// Summaries of earlier versions do not say it among the key figures.
function entered({ figures: known, summary, snapshots }) {
  if (known?.parts) return known.parts.entered;
  return summary ? summary.parts_start + (summary.parts_entered ?? 0) : snapshots[0]?.mass ?? 0;
}

// What an interval lacks, of a run of parts that are fed by chance.
function lackOf({ run, figures: known }) {
  if (!known || known.throughput_error_per_h > 0 || run.model === "macro") return "";
  return known.throughput_needs_s > 0 ? `Too short for an interval: it needs about ${quantity(known.throughput_needs_s, "s", 2)}.` : "";
}

// A density knows no bridges: its throughput is none where parts bridge the opening.
const isBridged = ({ run, summary }) => run.model === "macro" && Boolean(summary?.validity?.outside.some(({ what }) => what === "bridges"));

// What is said of some runs, each sentence once.
const sentencesOf = (runs, sentence) => [...new Set(runs.flatMap(sentence))].filter(Boolean).join(" ");

// name(data); value(data): a number, or null: not known; text(value, data): without its unit; sentence(data): one, or several.
const figures = [
  {
    name: () => "Drained at",
    unit: "s",
    value: ({ figures: known }) => known?.drained_at_s ?? null,
    text: (value, { run, figures: known }) => (value === null && known && isOver(run) ? "not drained" : number(value, 4)),
    sentence: ({ figures: known }) => (known && known.drained_at_s === undefined ? "Parts are still on the belt."
      : "Since then the belt has been empty."),
  },
  {
    name: ({ scenario }) => (isFed(scenario) ? "Throughput" : "Sustained throughput"),
    unit: "parts/h",
    value: (data) => (isBridged(data) ? null : data.figures?.sustained_throughput_per_h ?? null),
    text: (value, { figures: known }) => {
      if (value === null) return "–";
      const error = known?.throughput_error_per_h;
      return `${number(value >= 1000 ? Math.round(value) : value, 6)}${error > 0 ? ` ± ${parts(error, 2)}` : ""}`;
    },
    sentence: (data) => (isBridged(data) ? "Parts bridge this opening: solve it with the microscopic model."
      : isFed(data.scenario) ? ["Parts that left the belt, after the warm-up.", lackOf(data)]
      : `While the middle 80 % of the parts passed counter “${data.scenario.counters[0].id}”.`),
  },
  {
    name: () => "Longest queue",
    unit: "m",
    value: ({ figures: known }) => known?.queue_end_m ?? null,
    text: (value) => number(value),
    sentence: ({ run, scenario }) => (run.model === "macro" && !isFed(scenario) ? "Only the microscopic model knows it without feeds."
      : "From what holds parts back, the end of a plate or the first that is slow, upstream to the last that is slower than 0.8 of its belt."),
  },
  {
    name: () => "Residence, 95 %",
    unit: "s",
    value: ({ figures: known }) => (known && residenceOf(known)) ?? null,
    text: (value) => number(value),
    sentence: ({ run, scenario }) => (!isFed(scenario) ? "95 % of the parts that left stayed no longer."
      : "95 % of the parts stay no longer; those still inside count as longer than their age, so that it may not be known yet."),
  },
  {
    name: () => "Peak density",
    unit: "%",
    value: ({ figures: known }) => known?.peak_density ?? null,
    text: (value) => (value === null ? "–" : fixed(100 * value, 0)),
    sentence: () => "100 % is close packing.",
  },
  {
    name: () => "Parts still on the belt",
    unit: "",
    value: ({ summary, snapshots }) => summary?.parts_end ?? snapshots.at(-1)?.mass ?? null,
    text: (value, data) => (value === null ? "–" : `${parts(value, 3)} of ${parts(Math.round(entered(data) * 10) / 10, 6)}`),
    sentence: ({ run }) => (isOver(run) ? "When the run ended." : "At the newest snapshot."),
  },
];

const withUnit = (text, unit) => (unit && /^[\d.]/.test(text) ? `${text} ${unit}` : text);

export class KeyStrip {
  constructor() {
    this.list = h("dl", { class: "strip" });
    this.doubts = h("ul", { class: "warnings", "aria-label": "Lost parts", hidden: true });
    this.element = h("section", { class: "card", "aria-label": "At a glance" }, this.list, this.doubts);
  }

  show(data) {
    this.list.replaceChildren(...figures.map(({ name, unit, value, text, sentence }) => h("div", {},
      h("dt", {}, name(data)), h("dd", {}, withUnit(text(value(data), data), unit)), h("dd", { class: "hint" }, sentencesOf([data], sentence)))));
    const falls = fallsOf(data.curve);
    this.doubts.hidden = falls.length === 0;
    this.doubts.replaceChildren(...falls.map(([words, values]) =>
      h("li", {}, `${parts(values.at(-1), 3)} parts ${words}; they do not count as throughput.`)));
  }
}

// How much more than the reference, in percent; "": they are the same or one is not known.
function moreThan(value, reference) {
  if (value === null || !(reference > 0) || value === reference) return "";
  const share = value / reference - 1;
  const text = fixed(100 * Math.abs(share), Math.abs(share) < 0.095 ? 1 : 0);
  return text === "0.0" ? "" : `${share < 0 ? "−" : "+"}${text} %`;
}

// A column for each run; those but the reference say how much more or less it is.
export class KeyTable {
  constructor() {
    this.head = h("tr");
    this.body = h("tbody");
    this.element = h("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": "Table of key figures" },
      h("table", { class: "measures key-table" }, h("thead", {}, this.head), this.body));
  }

  // headOf(k): the heading of a run, an element.
  show(runs, reference, headOf) {
    this.head.replaceChildren(h("th", { scope: "col" }, h("span", { class: "hidden" }, "Figure")),
      ...runs.map((data, k) => h("th", { scope: "col" }, headOf(k))));
    this.body.replaceChildren(...figures.map(({ name, unit, value, text, sentence }) => {
      const values = runs.map(value);
      const words = sentencesOf(runs, sentence);
      return h("tr", {}, h("th", { scope: "row" }, [...new Set(runs.map(name))].join(", "), h("small", {}, unit), h("small", { class: "sentence" }, words)), values.map((one, k) =>
        h("td", {}, text(one, runs[k]), h("small", {}, k === reference ? "" : moreThan(one, values[reference])))));
    }));
  }
}
