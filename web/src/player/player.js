// The clock of the animations: one time for everything that is shown, played, paused, scrubbed, or held
// at the newest picture that has arrived of a run that is still computed.

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];

export class Player {
  constructor() {
    this.t = 0;
    this.end = 0; // the newest time that there is
    this.speed = 1;
    this.isPlaying = false;
    this.isFollowing = false;
    this.times = []; // where a step stops
    this.canShow = () => true; // whether the pictures of a time are there
    this.onTime = () => {}; // the time or the state changed
    this.last = 0;
    this.request = 0;
  }

  dispose() {
    cancelAnimationFrame(this.request);
    this.onTime = () => {};
  }

  // More snapshots are available.
  setTimes(times) {
    this.times = times;
    this.end = times.at(-1) ?? 0;
    this.arrive();
  }

  // More pictures are there; in live mode the time moves to the newest.
  arrive() {
    if (this.isFollowing) {
      const newest = this.times.findLast((t) => t <= this.t || this.canShow(t));
      this.t = Math.max(this.t, newest ?? 0);
    }
    this.onTime();
  }

  // The time whose pictures are needed first.
  wanted() {
    return this.isFollowing ? this.end : this.t;
  }

  play() {
    if (this.t >= this.end - 1e-9) this.t = this.times[0] ?? 0;
    this.isFollowing = false;
    this.isPlaying = true;
    this.last = performance.now();
    this.tick();
    this.onTime();
  }

  // Pauses at a snapshot, so that the displayed state was computed.
  pause() {
    if (!this.isPlaying) return;
    this.halt();
    this.t = this.nearest(this.t);
    this.onTime();
  }

  halt() {
    this.isPlaying = false;
    cancelAnimationFrame(this.request);
  }

  toggle() {
    if (this.isPlaying) this.pause();
    else this.play();
  }

  seek(t) {
    this.isFollowing = false;
    this.t = Math.min(Math.max(t, this.times[0] ?? 0), this.end);
    if (!this.isPlaying) this.t = this.nearest(this.t);
    this.onTime();
  }

  step(by) {
    this.halt();
    const at = this.indexOf(this.nearest(this.t));
    this.seek(this.times[Math.min(Math.max(at + by, 0), this.times.length - 1)] ?? 0);
  }

  follow(isOn) {
    this.halt();
    this.isFollowing = isOn;
    this.arrive();
  }

  // Index of the last time that is not after t.
  indexOf(t) {
    let low = 0;
    let high = this.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= t + 1e-9) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  nearest(t) {
    const k = this.indexOf(t);
    const [before, after] = [this.times[k], this.times[k + 1]];
    if (after === undefined) return before ?? 0;
    return after - t < t - before ? after : before;
  }

  // The clock waits while a snapshot is being fetched.
  tick() {
    this.request = requestAnimationFrame((now) => {
      if (!this.isPlaying) return;
      const next = Math.min(this.t + (this.speed * Math.min(now - this.last, 100)) / 1000, this.end);
      this.last = now;
      if (this.canShow(next)) this.t = next;
      if (this.t >= this.end - 1e-9) this.halt();
      this.onTime();
      if (this.isPlaying) this.tick();
    });
  }
}
