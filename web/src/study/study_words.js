// Studies in words.

import { isOver } from "../base/api.js";
import { models, quantity } from "../base/format.js";
import { valueText } from "../scenario/parameters.js";

const methods = {
  grid: "even steps", list: "listed values", lhs: "Latin hypercube", sobol: "Sobol points", direct: "search (DIRECT)",
  cmaes: "search (CMA-ES)", screen: "both models", calibrate: "fit to counts",
};

export function methodWords({ method, model }) {
  return method === "screen" ? methods.screen : `${methods[method]}, ${models[model]}`;
}

// "12 of 36 trials", and "31 trials" in the end.
export function trialsWords({ status, trials }) {
  const done = trials.succeeded + trials.failed + trials.infeasible + trials.pruned + trials.cancelled;
  return isOver({ status }) ? `${done} trials` : `${done} of ${trials.limit} trials`;
}

export function nameOfStudy(study) {
  return study.name || `Study ${study.id.slice(-8)}`;
}

// A value of the API with its 95 % interval, as valueWords() takes it.
export function spreadOf({ mean, interval_95: interval }) {
  return { mean, low: interval?.[0] ?? null, high: interval?.[1] ?? null };
}

// "39,100 ± 200 parts/h"; the half of the 95 % interval is left out where there is none.
export function valueWords({ mean, low = null, high = null }, unit) {
  if (mean === null || mean === undefined) return "–";
  const text = low === null ? quantity(mean, "", 4) : `${quantity(mean, "", 4)} ± ${quantity((high - low) / 2, "", 2)}`;
  return unit ? `${text} ${unit}` : text;
}

// "angle 75°, belt speed 0.5 m/s".
export function parametersWords(parameters, words) {
  return Object.entries(parameters).map(([pointer, value]) => {
    const { label, unit } = words.get(pointer);
    return `${label} ${valueText(value, unit)}`;
  }).join(", ");
}
