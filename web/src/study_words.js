// Studies in words.

import { models, quantity } from "./format.js";
import { valueText } from "./parameters.js";

const methods = {
  grid: "even steps", list: "listed values", lhs: "Latin hypercube", sobol: "Sobol points", direct: "search (DIRECT)",
  cmaes: "search (CMA-ES)", screen: "both models", calibrate: "fit to counts",
};

export function methodWords({ method, model }) {
  return method === "screen" ? methods.screen : `${methods[method]}, ${models[model]}`;
}

export function nameOfStudy(study) {
  return study.name || `Study ${study.id.slice(-8)}`;
}

// "39,100 parts/h, 38,900 to 39,300"; the interval is left out where there is none.
export function valueWords({ mean, low = null, high = null }, unit) {
  if (mean === null || mean === undefined) return "–";
  return `${quantity(mean, unit, 4)}${low === null ? "" : `, ${quantity(low, "", 4)} to ${quantity(high, "", 4)}`}`;
}

// "angle 75°, belt speed 0.5 m/s".
export function parametersWords(parameters, words) {
  return Object.entries(parameters).map(([pointer, value]) => {
    const { label, unit } = words.get(pointer);
    return `${label} ${valueText(value, unit)}`;
  }).join(", ");
}
