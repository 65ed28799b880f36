// What is typed into the search of a list: conditions on numbers, "angle > 50; belt speed < 0.4 m/s", for the API's `where`, or
// else a text that names, labels or lines contain, as one in quotes is whatever stands in it.

import { readNumber } from "../base/numbers.js";
import { pointersOfLabels } from "../scenario/parameters.js";

const CONDITION = /^(.+?)\s*(<=|>=|[<>=≤≥])\s*(.*)$/;
const RELATIONS = { "≤": "<=", "≥": ">=" };
const NUMBER = /^[-+−]?[\d.,'’\s]*\d(?:e[+-]?\d+)?/i; // what follows it is a unit

// The words of the list's columns and of the parameters that runs are told apart by.
const NAMES = {
  angle: "angle_deg", speed: "speed_m_s", "belt speed": "speed_m_s", feed: "rate_per_s", duration: "duration_s", mass: "mass_kg",
  throughput: "throughput_per_h", "sustained throughput": "sustained_throughput_per_h", "drained at": "drained_at_s",
  residence: "residence_s/p95", peak: "peak_density", ...pointersOfLabels,
};

function nameOf(words) {
  return NAMES[words.toLowerCase()] ?? words.replaceAll(" ", "_");
}

// { search, where, fault }: fault is "" or says what is wrong with a number.
export function searchOf(text) {
  const [, quoted] = /^"(.*)"$/.exec(text) ?? [];
  if (quoted !== undefined) return { search: quoted, where: "", fault: "" };
  const parts = text.split(/;|\sand\s/i).map((part) => CONDITION.exec(part.trim()));
  if (parts.includes(null)) return { search: text, where: "", fault: "" };
  let fault = "";
  const conditions = parts.map(([, words, relation, rest]) => {
    const read = readNumber(NUMBER.exec(rest)?.[0].trim() ?? "");
    if (read.fault) fault ||= `What "${words}" is compared with ${read.fault}`;
    return `${nameOf(words.trim())}${RELATIONS[relation] ?? relation}${read.value}`;
  });
  return { search: "", where: conditions.join(","), fault };
}
