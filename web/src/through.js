// How many parts have left the belt, of all that were on it, for the list: of runs that ended from their summaries, fetched
// a few at a time and cached; of others from their curves as they come.

import { getJson, isOver, paths } from "./api.js";

const AT_ONCE = 4;

export class Through {
  constructor(onKnown) {
    this.onKnown = onKnown; // (id, { left, start, entered })
    this.known = new Map();
    this.waiting = [];
    this.n = 0;
  }

  get(id) {
    return this.known.get(id);
  }

  set(id, value) {
    this.known.set(id, { ...this.known.get(id), ...value });
    this.onKnown(id, this.known.get(id));
  }

  // Runs that are shown now.
  want(runs) {
    this.waiting = runs.filter((run) => isOver(run) && run.started_at && !this.known.get(run.id)?.isFinal);
    this.fetchMore();
  }

  fetchMore() {
    while (this.n < AT_ONCE && this.waiting.length > 0) this.fetchOne(this.waiting.shift());
  }

  async fetchOne(run) {
    this.n += 1;
    try {
      const { parts_start: start, parts_entered: entered, parts_left: left } = await getJson(paths.of(run.id, "summary"));
      this.set(run.id, { left, start, entered, isFinal: true });
    } catch (error) {
      if (error.status !== 0) this.set(run.id, { isFinal: true });
    }
    this.n -= 1;
    this.fetchMore();
  }

  // A batch of the curve of a run that is going.
  take({ run, left_domain: left, ...columns }) {
    const admitted = Object.entries(columns).filter(([name]) => name.endsWith(".admitted"));
    const entered = admitted.reduce((all, [, values]) => all + values.at(-1), 0);
    if (left?.length) this.set(run, { left: left.at(-1), entered });
  }
}
