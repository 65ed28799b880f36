// The scale of a density's colours, in parts/m2 and in shares of close packing; and what else is drawn.

import { h } from "../base/dom.js";
import { fixed, number, quantity } from "../base/format.js";
import { cargoOf } from "../scenario/cargo.js";
import { cssColor, maps, ranges } from "./colormap.js";
import { niceStep } from "./scenery.js";

const STOPS = 16;

function tick(value, end, text) {
  const mark = h("span", { class: "tick" }, h("span", {}, text));
  mark.style.left = `${(value / end) * 100}%`;
  return mark;
}

function ticksTo(end, step) {
  return Array.from({ length: Math.floor(end / step + 1e-9) + 1 }, (_, k) => k * step);
}

export class ScaleBar {
  constructor({ onMap, onRange }) {
    this.band = h("div", { class: "band" });
    this.upper = h("div", { class: "ticks upper" });
    this.lower = h("div", { class: "ticks lower" });
    this.map = h("select", { "aria-label": "Colours", on: { change: () => onMap(this.map.value) } },
      Object.entries(maps).map(([name, { label }]) => h("option", { value: name }, label)));
    this.range = h("select", { "aria-label": "Range of the colours", on: { change: () => onRange(this.range.value) } },
      ranges.map(([range, words]) => h("option", { value: range }, words)));
    this.over = h("span", { class: "over" }, "above");
    this.element = h("div", { class: "scale" },
      h("div", { class: "scale-bar", role: "img" },
        h("span", { class: "scale-name" }, "parts/m²"), this.upper, this.band, this.lower,
        h("span", { class: "scale-name" }, "share of close packing")),
      this.over, this.range, this.map);
  }

  // end: density at the end of the scale, 1 is close packing; packing: parts/m2 of that; isExceeded: some density is above.
  set({ map, range, end, packing, isExceeded }) {
    const key = `${map} ${range} ${end} ${packing} ${isExceeded}`;
    if (key === this.key) return;
    this.key = key;
    this.map.value = map;
    this.range.value = range;
    this.over.hidden = !isExceeded;
    const colors = Array.from({ length: STOPS + 1 }, (_, k) => cssColor(map, k / STOPS));
    this.band.style.background = `linear-gradient(to right, ${colors.join(", ")})`;
    const parts = niceStep(end * packing, 4);
    this.upper.replaceChildren(...ticksTo(end * packing, parts).map((v) => tick(v, end * packing, number(v, 6))));
    this.lower.replaceChildren(...ticksTo(end, end > 2 ? niceStep(end, 4) : 0.25).map((v) => tick(v, end, v === 0 ? "0" : fixed(v, 2))));
    this.element.firstChild.setAttribute("aria-label",
      `Colour scale from 0 to ${number(end * packing)} parts per square metre; close packing is ${number(packing, 4)}`);
  }
}

function kindsOf(cargo) {
  if (cargo.kinds.length < 2) return [];
  return cargo.kinds.map(({ name }, k) => h("li", {}, h("i", { class: "key kind", data: { kind: String((k % 8) + 1) } }), name));
}

// What the lines of the drawing mean, with the speeds of the belts; of a microscopic run the colours of the kinds.
export function keyOf(scenario, hasParts) {
  const speeds = [...new Set(scenario.belts.map(({ velocity_m_s: v }) => quantity(Math.hypot(...v), "m/s")))];
  const entry = (kind, text) => h("li", {}, h("i", { class: `key ${kind}` }), text);
  const sides = Object.values(scenario.edges);
  const { feeds = [], photo_eyes: eyes = [] } = scenario;
  return h("ul", { class: "keys" },
    entry("belt", `belt ${speeds.slice(0, 3).join(", ")}${speeds.length > 3 ? " …" : ""}`),
    scenario.obstacles.length > 0 ? entry("plate", scenario.obstacles.length > 1 ? "deflectors" : "deflector") : null,
    feeds.length > 0 ? entry("feed", feeds.length > 1 ? "feeds" : `feed “${feeds[0].id}”`) : null,
    eyes.length > 0 ? entry("eye", "photo eye that is blocked") : null,
    sides.includes("wall") ? entry("wall", "wall") : null,
    sides.some((side) => side !== "wall") ? entry("open", "open edge") : null,
    entry("counter", scenario.counters.length > 1 ? "counters" : `counter “${scenario.counters[0].id}”`),
    hasParts ? kindsOf(cargoOf(scenario)) : []);
}
