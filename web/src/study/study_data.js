// Everything about one study: what it is, its trials as they end, and what it found so far.

import { ask, getJson, ticketed } from "../base/api.js";
import { report } from "../base/connection.js";

const RETRY_MS = 2000;
const BEST_EVERY_MS = 1500;

export class StudyData {
  constructor(id) {
    Object.assign(this, { id, trials: [], best: null, last: "", onChange: () => {} });
  }

  get path() {
    return `v1/studies/${this.id}`;
  }

  async load() {
    [this.study, this.document] = await Promise.all([getJson(this.path), getJson(`${this.path}/document`)]);
  }

  // Its events bring all trials, from the first one on.
  async start() {
    this.findBest();
    try {
      const query = this.last ? `?last_event_id=${this.last}` : "";
      const target = await ticketed(`${this.path}/events${query}`);
      if (!this.isGone) this.listen(target);
    } catch {
      this.tryAgain();
    }
  }

  listen(target) {
    this.source = new EventSource(target);
    const take = (kind, use) => this.source.addEventListener(kind, (event) => {
      this.last = event.lastEventId || this.last;
      use(JSON.parse(event.data));
      this.tell();
    });
    take("trial", (trial) => {
      this.trials[trial.trial] = trial;
      this.findBestSoon();
    });
    take("status", (study) => (this.study = study));
    take("end", (study) => {
      this.study = study;
      this.source.close();
      this.findBest();
    });
    this.source.addEventListener("open", () => report(true));
    this.source.addEventListener("error", () => this.tryAgain());
  }

  tryAgain() {
    this.source?.close();
    if (!this.isGone) this.timer = setTimeout(() => this.start(), RETRY_MS);
  }

  // Many trials may end at once, so it is told once in a frame.
  tell() {
    if (this.isTelling) return;
    this.isTelling = true;
    requestAnimationFrame(() => {
      this.isTelling = false;
      if (!this.isGone) this.onChange();
    });
  }

  findBestSoon() {
    this.bestTimer ??= setTimeout(() => this.findBest(), BEST_EVERY_MS);
  }

  async findBest() {
    clearTimeout(this.bestTimer);
    this.bestTimer = undefined;
    try {
      this.best = await getJson(`${this.path}/best`);
      this.tell();
    } catch {
      // It stays as it was; a lost connection is told elsewhere.
    }
  }

  async post(what) {
    await ask(`${this.path}/${what}`, { method: "POST" });
  }

  dispose() {
    this.isGone = true;
    clearTimeout(this.timer);
    clearTimeout(this.bestTimer);
    this.source?.close();
  }

  // Trials are numbered; those that have not ended are missing.
  ended() {
    return this.trials.filter(Boolean);
  }
}
