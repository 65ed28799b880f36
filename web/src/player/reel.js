// The snapshots of one run in their order of time: what to show at a time, and what to fetch for it.

import { indexBefore } from "../base/search.js";

const AHEAD_BYTES = 48e6; // of each run
const AHEAD_MAX = 48; // snapshots

export class Reel {
  // data: a RunData; frames: the cache, which several reels may share.
  constructor(data, frames) {
    Object.assign(this, { data, frames, layer: "density", isProbed: false });
  }

  // { k, share, gap } of a time: the snapshot before it, and how far on the way to the next one.
  locate(t, isSmooth) {
    const { snapshots } = this.data;
    const k = Math.max(0, indexBefore(snapshots, t + 1e-9, (snapshot) => snapshot.t_s));
    const [now, next] = [snapshots[k], snapshots[k + 1]];
    if (!next || !isSmooth) return { k, share: 0, gap: 0 };
    const gap = next.t_s - now.t_s;
    const share = Math.min(1, Math.max(0, (t - now.t_s) / gap));
    return { k, share: share < 1e-6 ? 0 : share, gap };
  }

  urlsOf(k) {
    const snapshot = this.data.snapshots[k];
    if (!snapshot) return [];
    const wantsDensity = this.layer !== "parts" || this.isProbed;
    const wantsParts = this.layer !== "density" && snapshot.parts_url;
    return [wantsDensity ? snapshot.url : null, wantsParts ? snapshot.parts_url : null].filter(Boolean);
  }

  isReady(t, isSmooth) {
    const { k, share } = this.locate(t, isSmooth);
    const urls = share > 0 ? [...this.urlsOf(k), ...this.urlsOf(k + 1)] : this.urlsOf(k);
    return urls.every((url) => this.frames.has(url) || this.frames.failed.has(url));
  }

  // What is there of a time, for Stage.show(); null: nothing of it yet.
  pictureAt(t, isSmooth) {
    const { k, share, gap } = this.locate(t, isSmooth);
    const [now, next] = [this.data.snapshots[k], share > 0 ? this.data.snapshots[k + 1] : null];
    if (!now || !this.isReady(t, isSmooth)) return null;
    const pick = (name) => {
      const frame = now[name] && this.frames.get(now[name]);
      return frame ? { frame, next: next && this.frames.get(next[name]) } : null;
    };
    const picture = { t: now.t_s + share * gap, density: pick("url"), parts: pick("parts_url"), share, gap };
    return picture.density || picture.parts ? picture : null;
  }

  // Addresses of what will be shown from t on, the most urgent first.
  wantedFrom(t) {
    const { k } = this.locate(t, false);
    const { snapshots } = this.data;
    const size = this.data.frameBytes(this.layer);
    const n = Math.min(AHEAD_MAX, Math.max(2, Math.floor(AHEAD_BYTES / Math.max(size, 1))));
    const urls = [];
    for (let i = k; i < Math.min(k + n, snapshots.length); i++) urls.push(...this.urlsOf(i));
    return urls;
  }

  problemAt(t) {
    const { k } = this.locate(t, false);
    return this.urlsOf(k).map((url) => this.frames.failed.get(url)).find(Boolean) ?? null;
  }
}
