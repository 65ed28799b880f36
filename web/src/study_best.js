// What a study found: the best point, whether the microscopic model confirms it, and why to doubt it.

import { figureTitle, figureUnit } from "./figures.js";
import { h } from "./dom.js";
import { models, percent, quantity } from "./format.js";
import { parametersWords, spreadOf, valueWords } from "./study_words.js";

// How sure a selection is that has ended, though intervals may overlap.
function suretyOf({ confidence = 0.95, indifference }, figure) {
  return `With ${percent(confidence)} confidence none of them is better than this one by more than ${quantity(indifference, figureUnit(figure), 4)}. `
    + "They are compared run by run with the same random numbers, so differences are surer than each interval.";
}

// In plain words, how sure the best point is.
function sentence(study, { best, is_ended: isEnded, is_decided: isDecided, confirmed }, method, figure) {
  if (!best) return isEnded ? "No trial has this value, so nothing is best." : "Nothing is known yet.";
  if (study.method === "calibrate") return isEnded ? "These values agree best with the counts." : "So far these values agree best with the counts.";
  if (study.method !== "screen") {
    return `${isEnded ? "The best that was tried" : "The best so far"}, by the ${models[best.model]} model alone${best.model === "macro" ? "; the microscopic model has not confirmed it." : "."}`;
  }
  if (!confirmed?.length) return "By the macroscopic model alone; the microscopic model has not confirmed it yet.";
  return isDecided ? `Confirmed: the microscopic model tried ${confirmed.length} points. ${suretyOf(method, figure)}`
    : `The microscopic model has tried ${confirmed.length} points; which of them is best is not decided.`;
}

export class BestPanel {
  constructor(method, words, figures) {
    Object.assign(this, { method, words, figures });
    this.body = h("div", { class: "best-panel" });
    this.element = h("section", { class: "card", "aria-labelledby": "best-title" },
      this.title = h("h2", { id: "best-title" }, "Best found"), this.body);
  }

  show(study, found) {
    if (!found) return;
    const key = JSON.stringify([study.status, found]);
    if (key === this.key) return;
    this.key = key;
    const { best, warnings = [], confirmed } = found;
    this.body.replaceChildren(...[
      best ? h("p", { class: "best-words" }, parametersWords(best.parameters, this.words)) : null,
      h("p", { class: "hint" }, sentence(study, found, this.method, this.figures[0])),
      best ? this.values(best) : null,
      confirmed?.length > 0 ? this.confirmed(confirmed) : null,
      warnings.length > 0 ? h("ul", { class: "warnings", "aria-label": "Warnings" }, warnings.map((text) => h("li", {}, text))) : null,
      study.error ? h("p", { class: "fault" }, study.error.detail) : null,
    ].filter(Boolean));
  }

  values({ values }) {
    return h("dl", { class: "facts" }, Object.entries(values).filter(([, value]) => value.mean !== null).map(([name, value]) =>
      h("div", {}, h("dt", {}, figureTitle(name)), h("dd", {}, valueWords(spreadOf(value), figureUnit(name))))));
  }

  confirmed(points) {
    const [name] = this.figures;
    const row = ({ is_dropped: isDropped, micro, macro, difference }) => h("tr", {},
      h("th", { scope: "row" }, parametersWords(micro.parameters, this.words), h("small", {}, isDropped ? "dropped" : "kept")),
      h("td", {}, quantity(macro.values[name]?.mean, "", 4)), h("td", {}, valueWords(spreadOf(micro.values[name] ?? {}), "")),
      h("td", {}, quantity(difference, "", 3)));
    return h("div", { class: "scroll" }, h("table", { class: "measures" },
      h("caption", { class: "hint" }, `${figureTitle(name)} by both models${figureUnit(name) ? `, ${figureUnit(name)}` : ""}`),
      h("thead", {}, h("tr", {}, ["point", "macro", "micro", "difference"].map((text) => h("th", { scope: "col" }, text)))),
      h("tbody", {}, points.map(row))));
  }
}
