// The panel of key figures: those of the run, then of each feed, counter, photo eye, belt whose speed changes, failure, outlet and sink. Their names follow
// from their members, their units and definitions from the API's description.

import { getJson } from "../base/api.js";
import { h } from "../base/dom.js";
import { percent, quantity } from "../base/format.js";

let description = null; // a promise of the schemas

// Those of the API, by their names; none where they could not be loaded.
export function schemas() {
  description ??= getJson("openapi.json").then(({ components }) => components.schemas).catch(() => {
    description = null; // asked for again by the next panel
    return {};
  });
  return description;
}

const groups = { feeds: ["Feed", "FeedFigures"], counters: ["Counter", "CounterFigures"], photo_eyes: ["Photo eye", "PhotoEyeFigures"],
  belts: ["Belt", "BeltFigures"], failures: ["Failure", "FailureFigures"], outlets: ["Outlet", "OutletFigures"], sinks: ["Sink", "SinkFigures"] };

const HALF_A_PART = 0.5; // less has not left, though the macroscopic model lets some of its tail pass

// How long 95 % of the parts that left stayed, s; undefined: not known.
export function residenceOf({ parts, residence_s: residence }) {
  return parts?.left < HALF_A_PART ? undefined : residence?.p95;
}

// "throughput_per_h" is "Throughput": the unit stands with the value.
export function titleOf(word) {
  const text = word.replace(/_(per_h|share|max|s|m)$/, (suffix) => (suffix === "_max" ? ", most" : "")).replaceAll("_", " ");
  return text[0].toUpperCase() + text.slice(1);
}

function valueText(word, value, definition = "") {
  if (/_share$|_density$|^availability$/.test(word)) return percent(value, 1);
  return quantity(value, /\[([^\]]+)\]/.exec(definition)?.[1] ?? "", 4);
}

// A number, or the numbers that one figure has.
function fact(word, value, schema) {
  const single = (text, number, { description: definition } = {}, name = null) =>
    h("span", { title: definition }, name ? h("small", {}, name) : null, valueText(text, number, definition));
  const parts = typeof value === "number" ? [single(word, value, schema)]
    : Object.entries(value).map(([part, number]) =>
      single(word, number, schema?.properties?.[part], part.replace(/_s$/, "").replaceAll("_", " ")));
  return h("div", {}, h("dt", { title: schema?.description }, titleOf(word)), h("dd", {}, parts));
}

function list(figures, schema) {
  const rows = Object.entries(figures).filter(([word, value]) => word !== "id" && !Array.isArray(value));
  return h("dl", { class: "facts" }, rows.map(([word, value]) => fact(word, value, schema?.properties?.[word])));
}

export class KeyFiguresPanel {
  constructor() {
    this.body = h("div", { class: "key-figures" });
    this.element = h("section", { class: "card", hidden: true, "aria-labelledby": "figures-title" },
      h("h2", { id: "figures-title" }, "Key figures"), this.body);
    schemas().then((known) => {
      this.schemas = known;
      this.show(this.figures, this.isFed);
    });
  }

  // figures: as the API gives them, or null: there are none yet. With feeds both throughputs are the same; without, the mean
  // over the run's time says nothing of how fast parts pass.
  show(figures, isFed) {
    this.figures = figures;
    this.isFed = isFed;
    this.element.hidden = !figures;
    if (!figures) return;
    const known = this.schemas ?? {};
    const parts = Object.entries(groups).flatMap(([word, [name, schema]]) => (figures[word] ?? []).map((item) =>
      (Object.keys(item).length > 1 ? [h("h3", {}, `${name} “${item.id}”`), list(item, known[schema])] : [])));
    const unsaid = isFed ? ["sustained_throughput_per_h"] : ["throughput_per_h", "throughput_error_per_h"];
    const said = Object.fromEntries(Object.entries(figures).filter(([word]) => !unsaid.includes(word)));
    this.body.replaceChildren(list(said, known.RunFigures), ...parts.flat());
  }
}
