// What the runs of a list differ in: runs whose names begin alike are variants of one scenario. Their scenarios, which never
// change, are fetched a few at a time and cached.

import { getJson, paths } from "./api.js";
import { chipsOf, differences } from "./differences.js";

const AT_ONCE = 4;
const CACHED_MAX = 400;

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

export class Variants {
  // onKnown(id, chips).
  constructor(onKnown) {
    Object.assign(this, { onKnown, scenarios: new Map(), families: [], waiting: [], n: 0 });
  }

  // Runs that are shown now.
  want(runs) {
    this.families = familiesIn(runs);
    const ids = this.families.flat().map(({ id }) => id);
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
      this.scenarios.set(id, await getJson(paths.of(id, "scenario")));
    } catch {
      // The run was removed meanwhile, or the server is away: its row stays without chips.
    }
    this.n -= 1;
    this.fetchMore();
    if (this.n === 0) this.tell();
  }

  // What a name says already is not said again.
  tell() {
    for (const family of this.families) {
      const known = family.filter(({ id }) => this.scenarios.has(id));
      const rows = differences(known.map(({ id }) => this.scenarios.get(id)));
      known.forEach(({ id, name }, k) => this.onKnown(id, chipsOf(rows, k).filter((chip) => !name.includes(chip))));
    }
  }
}
