// What scenarios differ in, for names, chips and legends.

import { bytesIn } from "../base/format.js";
import { parametersOf, valueText } from "./parameters.js";

const NAME_BYTES = 200; // the server's limit of a scenario's name
const MORE = "…"; // for the parameters that it leaves no room for

const key = ({ pointer, label }) => `${pointer} ${label}`;

// One text for each value; lists that are too long to be said are numbered.
function textsOf(values, unit) {
  const seen = [];
  return values.map((value) => {
    const text = valueText(value, unit);
    if (text !== null) return text;
    const json = JSON.stringify(value);
    if (!seen.includes(json)) seen.push(json);
    return `list ${seen.indexOf(json) + 1}`;
  });
}

// [{ pointer, label, values: [text of each scenario], isUsual }], what planners usually vary first. A scenario without a
// member that another has is said to have none.
export function differences(scenarios) {
  const known = new Map();
  scenarios.forEach((scenario, k) => {
    for (const parameter of parametersOf(scenario)) {
      if (!known.has(key(parameter))) known.set(key(parameter), { ...parameter, all: Array(scenarios.length).fill(undefined) });
      known.get(key(parameter)).all[k] = parameter.value;
    }
  });
  const rows = [...known.values()].map(({ pointer, label, unit, all, isUsual }) => ({ pointer, label, values: textsOf(all, unit), isUsual }));
  const differing = rows.filter(({ values }) => values.some((text) => text !== values[0]));
  return [...differing.filter(({ isUsual }) => isUsual), ...differing.filter(({ isUsual }) => !isUsual)];
}

// "angle 75°", of scenario k, at most so many.
export function chipsOf(rows, k, most = 4) {
  return rows.slice(0, most).map(({ label, values }) => `${label} ${values[k]}`);
}

// What is left of a name without the parameters that were written behind it: "Example 1" of "Example 1, angle 75°" and
// of "Example 1: singularizer at 60 degrees".
export function stemOf(name, labels) {
  const parts = name.split(", ");
  while (parts.length > 1 && (parts.at(-1) === MORE || labels.some((label) => parts.at(-1).startsWith(`${label} `)))) parts.pop();
  const stem = parts.join(", ");
  return /^(.+?): /.exec(stem)?.[1] ?? stem;
}

// The name of a scenario that was changed: the name of the one it began with, without what that says of its parameters, and
// the parameters that were changed, as many as there is room for. null: nothing was.
export function nameOfVariant(origin, scenario) {
  const changed = differences([origin, scenario]).map(({ label }) => label);
  if (changed.length === 0) return null;
  const parameters = parametersOf(scenario);
  const labels = [...new Set([...parameters, ...parametersOf(origin)].map(({ label }) => label))];
  const stem = stemOf(origin.name ?? "", labels);
  const rest = (origin.name ?? "").slice(stem.length);
  const said = parameters.filter(({ label, value, unit }) =>
    valueText(value, unit) !== null && (changed.includes(label) || rest.includes(`, ${label} `)));
  const texts = said.map(({ label, value, unit }) => `${label} ${valueText(value, unit)}`);
  const nameWith = (n) => [stem, ...texts.slice(0, n), n < texts.length ? MORE : ""].filter(Boolean).join(", ");
  let n = texts.length;
  while (n > 0 && bytesIn(nameWith(n)) > NAME_BYTES) n--;
  return bytesIn(nameWith(n)) > NAME_BYTES ? stem : nameWith(n);
}
