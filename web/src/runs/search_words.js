// What is typed into the search of a list: conditions on numbers, "angle > 50; belt speed < 0.4 m/s", for the API's `where`, or
// else a text that names, labels or lines contain, as one in quotes is whatever stands in it.

import { readNumber } from "../base/numbers.js";
import { pointersOfLabels, unitOf } from "../scenario/parameters.js";

const CONDITION = /^([\w /~-]+?)\s*(<=|>=|[<>=≤≥])\s*(.*)$/;
const RELATIONS = { "≤": "<=", "≥": ">=" };
const NUMBER = /^[-+−]?[\d.,'’\s]*\d(?:e[+-]?\d+)?/i; // what follows it is a unit

// The words of the list's columns and of the parameters that runs are told apart by.
const NAMES = new Map(Object.entries({
  angle: "angle_deg", speed: "speed_m_s", "belt speed": "speed_m_s", feed: "rate_per_s", duration: "duration_s", mass: "mass_kg",
  throughput: "throughput_per_h", "sustained throughput": "sustained_throughput_per_h", "drained at": "drained_at_s",
  residence: "residence_s/p95", peak: "peak_density", ...pointersOfLabels,
}));

function nameOf(words) {
  return NAMES.get(words.toLowerCase()) ?? words.replaceAll(" ", "_");
}

// What is wrong with what follows a number, or "". "" and the unit of the member are right, and of what has none a word.
function faultOfUnit(name, number, typed) {
  const [, unit] = name.split("/").map(unitOf).findLast(([, one]) => one) ?? ["", ""];
  const plain = typed.toLowerCase().replaceAll(" ", "").replace(/^(?:parts?|1)?(?:\/|per)/, "/").replace(/^deg(?:rees)?$/, "°").replace(/2$/, "²");
  if (plain === "" || (unit ? plain === unit.toLowerCase() : /^[^\d,<>=≤≥]*$/.test(typed))) return "";
  return `After ${number} there may be ${unit || "a unit"}, or ; and another condition, not "${typed}"`;
}

// { search, where, fault }: fault is "" or says what is wrong with a number or its unit.
export function searchOf(text) {
  const [, quoted] = /^"(.*)"$/.exec(text) ?? [];
  if (quoted !== undefined) return { search: quoted, where: "", fault: "" };
  const parts = text.split(/;|\sand\s/i).map((part) => CONDITION.exec(part.trim()));
  if (parts.includes(null)) return { search: text, where: "", fault: "" };
  let fault = "";
  const conditions = parts.map(([, words, relation, rest]) => {
    const number = NUMBER.exec(rest)?.[0] ?? "";
    const name = nameOf(words);
    const read = readNumber(number);
    fault ||= read.fault ? `What "${words}" is compared with ${read.fault}` : faultOfUnit(name, number, rest.slice(number.length).trim());
    return `${name}${RELATIONS[relation] ?? relation}${read.value}`;
  });
  return { search: "", where: conditions.join(","), fault };
}
