// What the runs of a list differ in: runs whose names begin alike are variants of one scenario. What differs most often gets
// columns, the rest chips. Scenarios, which never change, are fetched a few at a time and their parameters cached.

import { getJson, paths } from "../base/api.js";
import { chipsOf, differences } from "../scenario/differences.js";
import { parametersOf, valueText } from "../scenario/parameters.js";

const AT_ONCE = 4;
const CACHED_MAX = 400;
const COLUMNS_MAX = 3;

// "Example 1" of "Example 1: singularizer at 60 degrees" and of "Example 1, angle 75°".
const familyOf = ({ name }) => name.split(/: |, /)[0];

// Lists of two runs and more.
function familiesIn(runs) {
  const families = new Map();
  for (const run of runs.filter(({ name }) => name)) {
    families.set(familyOf(run), [...(families.get(familyOf(run)) ?? []), run]);
  }
  return [...families.values()].filter((family) => family.length > 1);
}

// The labels of what differs in the most runs, what planners usually vary first.
function mostFrequent(differing) {
  const found = new Map(); // label -> { isUsual, n }
  for (const { rows, runs } of differing) {
    for (const { label, isUsual } of rows) found.set(label, { isUsual, n: (found.get(label)?.n ?? 0) + runs.length });
  }
  return [...found].sort(([, a], [, b]) => b.isUsual - a.isUsual || b.n - a.n).slice(0, COLUMNS_MAX).map(([label]) => label);
}

export class Variants {
  // onKnown(labels, of): the columns' labels, and for each run { values, texts, chips }, values and texts by column.
  constructor(onKnown) {
    Object.assign(this, { onKnown, scenarios: new Map(), runs: [], waiting: [], n: 0 });
  }

  // Runs that are shown now. Those of which nothing differs are asked for last.
  want(runs) {
    this.runs = runs;
    this.families = familiesIn(runs);
    const ids = [...new Set([...this.families.flat(), ...runs].map(({ id }) => id))];
    this.waiting = ids.filter((id) => !this.scenarios.has(id));
    if (this.scenarios.size > CACHED_MAX) {
      for (const id of this.scenarios.keys()) if (!ids.includes(id)) this.scenarios.delete(id);
    }
    this.fetchMore();
    if (this.waiting.length === 0 && this.n === 0) this.tell();
  }

  fetchMore() {
    while (this.n < AT_ONCE && this.waiting.length > 0) this.fetchOne(this.waiting.shift());
  }

  async fetchOne(id) {
    this.n += 1;
    try {
      const scenario = await getJson(paths.of(id, "scenario"));
      this.scenarios.set(id, { scenario, parameters: new Map(parametersOf(scenario).map((one) => [one.label, one])) });
    } catch {
      // The run was removed meanwhile, or the server is away: its row stays without them.
    }
    this.n -= 1;
    this.fetchMore();
    if (this.n === 0) this.tell();
  }

  // What a name says already, or a column, is not said again.
  tell() {
    const differing = this.families.map((family) => {
      const runs = family.filter(({ id }) => this.scenarios.has(id));
      return { runs, rows: differences(runs.map(({ id }) => this.scenarios.get(id).scenario)) };
    });
    const labels = mostFrequent(differing);
    const known = new Map(this.runs.filter(({ id }) => this.scenarios.has(id)).map(({ id }) => {
      const { parameters } = this.scenarios.get(id);
      const found = labels.map((label) => parameters.get(label));
      return [id, { values: found.map((one) => one?.value), chips: [],
        texts: found.map((one) => (one === undefined ? "–" : valueText(one.value, one.unit) ?? "a list")) }];
    }));
    for (const { runs, rows } of differing) {
      const others = rows.filter(({ label }) => !labels.includes(label));
      runs.forEach(({ id, name }, k) => {
        known.get(id).chips = chipsOf(others, k).filter((chip) => !name.includes(chip));
      });
    }
    this.onKnown(labels, known);
  }
}
