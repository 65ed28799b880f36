// The cache of fetched snapshots, and prefetching. Bytes in the cache are bounded; the
// ones unused for longest go first. A request that has begun is finished, so that on a slow connection something
// arrives, however often something newer is wanted meanwhile; few are under way, so that the newest begins soon. Where
// snapshots are small, one request gets several that follow each other.

import { getBytes } from "../base/api.js";
import { isDaemonAway } from "../base/connection.js";
import { readNpy } from "../base/npy.js";

const AT_ONCE = 2;
const REST_MS = 2000; // after an answer with Retry-After
const REQUEST_BYTES = 128e3;
const REQUEST_MAX = 16; // snapshots
const later = new Set([0, 429, 502, 503, 504]);

export class Frames {
  constructor(budget = 256e6) {
    this.budget = budget;
    this.bytes = 0;
    this.kept = new Map(); // url -> frame, the longest unused first
    this.wanted = [];
    this.fetching = new Set(); // urls
    this.requests = 0; // that are under way
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
    while (this.requests < AT_ONCE) {
      const url = this.wanted.find((one) => !this.fetching.has(one));
      if (url === undefined) return;
      this.fetchSome(this.sequenceFrom(url));
    }
  }

  // A wanted snapshot with those behind it that are wanted, too: first few, so that something is shown soon, then more.
  sequenceFrom(url) {
    const [, path, number] = /^(.*\/)(\d+)$/.exec(url) ?? [];
    const size = this.bytes / Math.max(1, this.kept.size);
    const most = Math.min(REQUEST_MAX, this.kept.size, Math.floor(REQUEST_BYTES / Math.max(size, 1)));
    const urls = [url];
    for (let n = Number(number) + 1; path !== undefined && urls.length < most; n++) {
      const next = `${path}${n}`;
      if (!this.wanted.includes(next) || this.fetching.has(next)) break;
      urls.push(next);
    }
    return urls;
  }

  // The server may answer fewer; the others are then asked for again.
  async fetchSome(urls) {
    for (const url of urls) this.fetching.add(url);
    this.requests++;
    const [first] = urls;
    const arrived = [];
    try {
      const bytes = await getBytes(urls.length > 1 ? `${first}?count=${urls.length}` : first, { signal: this.end.signal });
      for (let at = 0; at < bytes.byteLength && arrived.length < urls.length;) {
        const { end, ...frame } = readNpy(bytes, at);
        this.keep(urls[arrived.length], frame);
        arrived.push(urls[arrived.length]);
        at = end;
      }
      for (const url of arrived) this.onArrive(url);
    } catch (error) {
      if (later.has(error.status)) this.rest();
      else if (error.name !== "AbortError") this.failed.set(urls[arrived.length], error);
      arrived.push(urls[arrived.length]);
    } finally {
      this.requests--;
      for (const url of urls) this.fetching.delete(url);
      this.wanted = this.wanted.filter((url) => !arrived.includes(url));
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
