// The controls of a player: play, step, scrub, speed, follow; and its keys.

import { h, iconButton, setText, swapIcon } from "../base/dom.js";
import { fixed, placesOf } from "../base/format.js";
import { SPEEDS } from "./player.js";

export class Transport {
  constructor(player) {
    this.player = player;
    this.playButton = iconButton("play", "Play", () => player.toggle(), { class: "round primary" });
    this.back = iconButton("previous", "One snapshot back", () => player.step(-1), { class: "round" });
    this.forth = iconButton("next", "One snapshot on", () => player.step(1), { class: "round" });
    this.slider = h("input", { type: "range", min: "0", max: "0", step: "any", "aria-label": "Time",
      on: { input: () => player.seek(Number(this.slider.value)) } });
    this.clock = h("span", { class: "clock" }); // no live region: it changes many times a second
    this.speed = h("select", { "aria-label": "Speed", on: { change: () => (player.speed = Number(this.speed.value)) } },
      SPEEDS.map((speed) => h("option", { value: String(speed) }, `${speed}×`)));
    this.speed.value = "1";
    this.live = h("button", { type: "button", class: "live", hidden: true, "aria-pressed": "false",
      on: { click: () => player.follow(!player.isFollowing) } }, h("i", { class: "dot" }), "Follow live");
    this.element = h("div", { class: "transport", role: "group", "aria-label": "Animation" },
      this.back, this.playButton, this.forth, this.slider, this.clock, this.speed, this.live);
    this.onOtherKey = () => false; // (event) => whether it was of use elsewhere
    this.onKey = (event) => this.take(event);
    document.addEventListener("keydown", this.onKey);
  }

  dispose() {
    document.removeEventListener("keydown", this.onKey);
  }

  // end: of the slider; last: the time at which all is over; isLive: more is still to come.
  setRange(end, last, isLive) {
    this.slider.max = String(end);
    Object.assign(this, { end, last });
    this.live.hidden = !isLive;
  }

  // A time, as exactly as snapshots differ.
  textOf(t) {
    const [first, second] = this.player.times;
    return fixed(t, second === undefined ? 1 : placesOf(second - first));
  }

  update() {
    const { t, end, times, isPlaying, isFollowing } = this.player;
    const isOver = !isPlaying && t >= end - 1e-9 && times.length > 1;
    swapIcon(this.playButton, isPlaying ? "pause" : isOver && !isFollowing ? "replay" : "play");
    const name = isPlaying ? "Pause" : "Play";
    if (this.playButton.title !== name) {
      this.playButton.title = name;
      this.playButton.setAttribute("aria-label", name);
    }
    this.slider.value = String(t);
    this.slider.setAttribute("aria-valuetext", `${this.textOf(t)} seconds`);
    this.slider.style.setProperty("--done", `${this.end > 0 ? (t / this.end) * 100 : 0}%`);
    this.slider.style.setProperty("--there", `${this.end > 0 ? (end / this.end) * 100 : 0}%`);
    setText(this.clock, `${this.textOf(t)} / ${this.textOf(this.last ?? 0)} s`);
    this.live.setAttribute("aria-pressed", String(isFollowing));
    for (const button of [this.playButton, this.back, this.forth]) button.disabled = times.length < 2;
  }

  take(event) {
    const { player } = this;
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    const isTyping = event.target.closest?.("input, select, textarea, dialog[open]");
    const isPressing = event.target.closest?.("button, a, summary, label");
    const keys = {
      " ": () => player.toggle(),
      k: () => player.toggle(),
      ArrowLeft: () => player.step(-1),
      ArrowRight: () => player.step(1),
      Home: () => player.seek(0),
      End: () => player.seek(player.end),
      f: () => !this.live.hidden && player.follow(!player.isFollowing),
      ",": () => this.changeSpeed(-1),
      ".": () => this.changeSpeed(1),
    };
    if (isTyping || (event.key === " " && isPressing)) return;
    if (!keys[event.key]) {
      if (this.onOtherKey(event)) event.preventDefault();
      return;
    }
    event.preventDefault();
    keys[event.key]();
  }

  changeSpeed(by) {
    const at = SPEEDS.indexOf(this.player.speed) + by;
    this.player.speed = SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)];
    this.speed.value = String(this.player.speed);
  }
}

// A row of choices of which one is taken. choices: [[value, text]]; onChoose(value).
export function segments(label, choices, chosen, onChoose) {
  const buttons = choices.map(([value, text]) => h("button", { type: "button", data: { value },
    "aria-pressed": String(value === chosen), on: { click: () => choose(value) } }, text));
  const choose = (value, isTold = true) => {
    for (const button of buttons) button.setAttribute("aria-pressed", String(button.dataset.value === value));
    if (isTold) onChoose(value);
  };
  return { element: h("div", { class: "segments", role: "group", "aria-label": label }, buttons), choose };
}
