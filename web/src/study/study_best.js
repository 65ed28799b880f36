// What a study found: the best point, whether the microscopic model confirms it, and why to doubt it.

import { h } from "../base/dom.js";
import { models, number, quantity } from "../base/format.js";
import { figureTitle, figureUnit } from "./figures.js";
import { parametersWords, spreadOf, valueWords } from "./study_words.js";

// The daemon's sentences name a parameter by its member of the scenario, "angle_deg" or "velocity_m_s/0"; the page has words for it.
function readable(text, words) {
  return [...words].reduce((said, [pointer, { label }]) => said.replaceAll(` ${pointer.match(/[^/]+(\/\d+)*$/)[0]} `, ` ${label.toLowerCase()} `), text);
}

// What a sentence advises, as a study to be made instead: { text, document }; null: it advises none.
function adviceOf({ kind, advice, figures }, study) {
  const of = (name) => figures.find(({ figure }) => figure === name)?.value;
  if (kind === "edge") {
    const range = [of("try_from"), of("try_to")];
    const { pointer } = study.parameters.find((one) => one.range && of(one.pointer) !== undefined) ?? {};
    return pointer === undefined ? null : { text: `Study ${range.map((value) => number(value, 4)).join(" to ")}`,
      document: { ...study, parameters: study.parameters.map((one) => (one.pointer === pointer ? { ...one, range } : one)) } };
  }
  const runs = of("runs_of_each");
  return runs === undefined || advice === "" ? null : { text: `Make ${3 * runs} more runs of each`, document: { ...study, replications: 4 * runs } };
}

// In sentences, what was found and how sure it is; [{ text, advised }].
function sentences(study, { best, is_ended: isEnded, verdicts = [] }, words, document) {
  const said = (text) => [{ text, advised: null }];
  if (!best) return said(isEnded ? "No trial has this value, so nothing is best." : "Nothing is known yet.");
  if (study.method === "calibrate") return said(isEnded ? "These values agree best with the counts." : "So far these values agree best with the counts.");
  const model = study.method === "screen" || words.size === 0 ? [] : said(`${isEnded ? "The best that was tried" : "The best so far"}, by the ${models[best.model]} model alone${
    best.model === "macro" ? "; the microscopic model has not confirmed it." : "."}`);
  return [...model, ...verdicts.map((one) => ({ text: readable(one.text, words), advised: isEnded ? adviceOf(one, document) : null }))];
}

export class BestPanel {
  // document: of the study, as the server keeps it; onMake(document): another one is to be made; null: nobody may.
  constructor(words, figures, document, onMake) {
    Object.assign(this, { words, figures, document, onMake });
    this.body = h("div", { class: "best-panel" });
    this.element = h("section", { class: "card", "aria-labelledby": "best-title" },
      this.title = h("h2", { id: "best-title" }, words.size > 0 ? "Best found" : "All runs together"), this.body);
  }

  show(study, found) {
    if (!found) return;
    const key = JSON.stringify([study.status, found]);
    if (key === this.key) return;
    this.key = key;
    const { best, warnings = [], confirmed, front = [] } = found;
    this.body.replaceChildren(...[
      best && this.words.size > 0 ? h("p", { class: "best-words" }, parametersWords(best.parameters, this.words)) : null,
      ...sentences(study, found, this.words, this.document).flatMap(({ text, advised }) => [h("p", { class: "hint" }, text),
        advised && this.onMake && h("button", { type: "button", on: { click: () => this.onMake(advised.document) } }, advised.text)]),
      best ? this.values(best) : null,
      front.length > 1 ? this.front(front) : null,
      confirmed?.length > 0 ? this.confirmed(confirmed) : null,
      warnings.length > 0 ? h("ul", { class: "warnings", "aria-label": "Warnings" }, warnings.map((text) => h("li", {}, text))) : null,
      study.error ? h("p", { class: "fault" }, study.error.detail) : null,
    ].filter(Boolean));
  }

  values({ values }) {
    return h("dl", { class: "facts" }, Object.entries(values).filter(([, value]) => value.mean !== null).map(([name, value]) =>
      h("div", {}, h("dt", {}, figureTitle(name)), h("dd", {}, valueWords(spreadOf(value), figureUnit(name))))));
  }

  // Between these two figures leave the choice.
  front(points) {
    const names = this.figures.slice(0, 2);
    const heads = ["point", ...names.map((name) => (figureUnit(name) ? `${figureTitle(name)}, ${figureUnit(name)}` : figureTitle(name)))];
    return h("div", { class: "scroll" }, h("table", { class: "measures" },
      h("caption", { class: "hint" }, "No other point is better in one and not worse in the other"),
      h("thead", {}, h("tr", {}, heads.map((text) => h("th", { scope: "col" }, text)))),
      h("tbody", {}, points.map(({ parameters, values }) => h("tr", {}, h("th", { scope: "row" }, parametersWords(parameters, this.words)),
        names.map((name) => h("td", {}, valueWords(spreadOf(values[name] ?? {}), ""))))))));
  }

  confirmed(points) {
    const [name] = this.figures;
    const row = ({ is_dropped: isDropped, is_in_set: isInSet, micro, macro, difference }) => h("tr", {},
      h("th", { scope: "row" }, parametersWords(micro.parameters, this.words), h("small", {}, isInSet ? "may be best" : isDropped ? "dropped" : "worse")),
      h("td", {}, quantity(macro.values[name]?.mean, "", 4)), h("td", {}, valueWords(spreadOf(micro.values[name] ?? {}), "")),
      h("td", {}, quantity(difference, "", 3)));
    return h("div", { class: "scroll" }, h("table", { class: "measures" },
      h("caption", { class: "hint" }, `${figureTitle(name)} by both models${figureUnit(name) ? `, ${figureUnit(name)}` : ""}`),
      h("thead", {}, h("tr", {}, ["point", "macro", "micro", "difference"].map((text) => h("th", { scope: "col" }, text)))),
      h("tbody", {}, points.map(row))));
  }
}
