// The cache of fetched snapshots, and prefetching. Bytes in the cache are bounded; the
// ones unused for longest go first. A request that has begun is finished, so that on a slow connection something
// arrives, however often something newer is wanted meanwhile; few are under way, so that the newest begins soon.

import { getBytes } from "./api.js";
import { isDaemonAway } from "./connection.js";
import { readNpy } from "./npy.js";

const AT_ONCE = 2;
const REST_MS = 2000; // after an answer with Retry-After
const later = new Set([0, 429, 502, 503, 504]);

export class Frames {
  constructor(budget = 256e6) {
    this.budget = budget;
    this.bytes = 0;
    this.kept = new Map(); // url -> frame, the longest unused first
    this.wanted = [];
    this.fetching = new Set(); // urls
    this.end = new AbortController(); // of all requests
    this.failed = new Map(); // url -> Problem
    this.onArrive = () => {};
  }

  // The frame, or undefined: it is not there (yet).
  get(url) {
    const frame = this.kept.get(url);
    if (frame) {
      this.kept.delete(url);
      this.kept.set(url, frame);
    }
    return frame;
  }

  has(url) {
    return this.kept.has(url);
  }

  // Sets the frames that are needed now, the most urgent first.
  want(urls) {
    if (isDaemonAway() || this.isResting) return;
    this.wanted = urls.filter((url) => !this.kept.has(url) && !this.failed.has(url));
    this.fetchMore();
  }

  rest() {
    this.isResting = true;
    this.wanted = [];
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.isResting = false;
      this.onArrive();
    }, REST_MS);
  }

  fetchMore() {
    for (const url of this.wanted) {
      if (this.fetching.size >= AT_ONCE) return;
      if (!this.fetching.has(url)) this.fetchOne(url);
    }
  }

  async fetchOne(url) {
    this.fetching.add(url);
    try {
      const frame = readNpy(await getBytes(url, { signal: this.end.signal }));
      this.keep(url, frame);
      this.onArrive(url);
    } catch (error) {
      if (later.has(error.status)) this.rest();
      else if (error.name !== "AbortError") this.failed.set(url, error);
    } finally {
      this.fetching.delete(url);
      this.wanted = this.wanted.filter((other) => other !== url);
      this.fetchMore();
    }
  }

  keep(url, frame) {
    this.kept.set(url, frame);
    this.bytes += frame.data.byteLength;
    for (const [oldest, old] of this.kept) {
      if (this.bytes <= this.budget || oldest === url) break;
      this.kept.delete(oldest);
      this.bytes -= old.data.byteLength;
    }
  }

  dispose() {
    clearTimeout(this.timer);
    this.onArrive = () => {};
    this.wanted = [];
    this.end.abort();
    this.kept.clear();
  }
}
