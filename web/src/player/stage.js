// A run's belt from above: the cargo, the scenery and the devices over it, and the value under the pointer.

import { h, setText } from "../base/dom.js";
import { fixed, number, percent, quantity } from "../base/format.js";
import { color, onTheme, rgb } from "../base/theme.js";
import { Equipment } from "../scenario/equipment.js";
import { isPale, tableOf } from "./colormap.js";
import { drawDevices } from "./devices.js";
import { densityAt, Heatmap } from "./heatmap.js";
import { PartsLayer } from "./parts_layer.js";
import { drawScenery, feedLines } from "./scenery.js";
import { ViewBox } from "./view_box.js";

const PROBE_STEP = 10; // CSS pixels a key moves the probe
const KINDS = ["draw-part", ...Array.from({ length: 7 }, (_, k) => `draw-part-${k + 2}`)]; // colours, again from the first

// How a PartsLayer paints, in the theme of now.
export const bodyStyle = () => ({ fills: KINDS.map(color), line: color("draw-part-line"), fillsRgb: KINDS.map(rgb), lineRgb: rgb("draw-part-line") });

export class Stage {
  // label: what the drawing is called; most(): how high it may be, CSS pixels.
  constructor(label, most) {
    this.most = most;
    this.field = h("canvas", { class: "field" });
    this.above = h("canvas", { class: "above" });
    this.devices = h("canvas", { class: "devices" });
    this.tip = h("div", { class: "tip", hidden: true });
    this.cross = h("div", { class: "cross", hidden: true });
    this.stamp = h("div", { class: "stamp", hidden: true });
    this.frame = h("div", { class: "stage-frame", role: "img", tabindex: "0", "aria-label": label },
      this.field, this.above, this.devices, this.stamp, this.cross, this.tip);
    this.element = h("div", { class: "stage" }, this.frame);
    this.heatmap = new Heatmap();
    this.style = { layer: "density", map: "viridis", end: 1 };
    this.zoom = { factor: 1, x: 0.5, y: 0.5 };
    this.picture = null;
    this.onProbe = () => {};
    this.watch();
  }

  watch() {
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.element);
    this.stopTheme = onTheme(() => this.resize());
    this.frame.addEventListener("pointermove", (event) => {
      const box = this.frame.getBoundingClientRect();
      this.probe([event.clientX - box.left, event.clientY - box.top]);
    });
    this.frame.addEventListener("pointerleave", () => this.probe(null));
    this.frame.addEventListener("blur", () => this.probe(null));
    this.frame.addEventListener("keydown", (event) => this.moveProbe(event));
  }

  dispose() {
    this.observer.disconnect();
    this.stopTheme();
  }

  // data: a RunData, of which scenario, grid and, where it has them, parts are known; curve, actions and drives may grow.
  setScene(data) {
    const { scenario, grid, parts, curve, actions, drives } = data;
    Object.assign(this, { data, scenario, grid });
    this.equipment = new Equipment(scenario, curve, actions, drives);
    this.layer = parts ? new PartsLayer(parts.columns, parts.cargo, feedLines(scenario)) : null;
    this.resize();
  }

  setStyle(style) {
    Object.assign(this.style, style);
    this.resize();
  }

  // Colours follow the map, the end of the scale and the theme. Whether the picture must be drawn again.
  setEnd(end) {
    if (end === this.style.end) return false;
    this.style.end = end;
    this.table = null;
    return true;
  }

  // zoom: { factor, x, y } of Zoom.
  setZoom(zoom) {
    this.zoom = zoom;
    this.resize();
  }

  resize() {
    const width = this.element.clientWidth;
    if (!this.scenario || width === 0) return;
    const ratio = Math.min(devicePixelRatio || 1, 2);
    this.view = new ViewBox(this.scenario.domain, width, this.most(), ratio, this.zoom);
    this.frame.classList.toggle("zoomed", !this.view.isWhole);
    for (const canvas of [this.field, this.above, this.devices]) {
      if (canvas.width !== this.view.width) canvas.width = this.view.width;
      if (canvas.height !== this.view.height) canvas.height = this.view.height;
      canvas.style.width = `${this.view.cssWidth}px`;
      canvas.style.height = `${this.view.cssHeight}px`;
    }
    this.frame.style.width = `${this.view.cssWidth}px`;
    this.frame.style.height = `${this.view.cssHeight}px`;
    this.colors = this.chooseColors();
    drawScenery(this.above.getContext("2d"), this.view, this.scenario, this.colors);
    this.drawnState = "";
    this.bodies = bodyStyle();
    this.belt = color("draw-belt");
    this.table = null;
    this.draw();
  }

  chooseColors() {
    const names = ["text", "muted", "light", "dark", "plate", "rim", "feed", "blocked"];
    const colors = Object.fromEntries(names.map((name) => [name, color(`draw-${name}`)]));
    if (isPale(this.style.map)) {
      Object.assign(colors, { light: color("draw-ink"), dark: color("draw-paper"), feed: color("draw-feed-ink") });
    }
    return colors;
  }

  // picture: { t, density: { frame, next } or null, parts: the same, share, gap }.
  show(picture) {
    this.picture = picture;
    this.draw();
  }

  // text: the time of the picture; isLate: that of the clock is not there yet.
  setStamp(text, isLate) {
    this.stamp.hidden = this.picture === null;
    this.stamp.classList.toggle("late", isLate);
    setText(this.stamp, isLate ? `${text} s, loading …` : `${text} s`);
  }

  // Drawn again only when something has moved or changed.
  drawDevices() {
    const state = this.equipment.at(this.picture?.t ?? 0);
    const text = JSON.stringify(state);
    if (text === this.drawnState) return;
    this.drawnState = text;
    drawDevices(this.devices.getContext("2d"), this.view, this.scenario, state, this.colors);
  }

  draw() {
    if (!this.view) return;
    this.drawDevices();
    if (!this.picture) return;
    const context = this.field.getContext("2d");
    const { density, parts, share, gap } = this.picture;
    const { layer, map, end } = this.style;
    const { whole } = this.view;
    context.clearRect(0, 0, this.view.width, this.view.height);
    context.save();
    this.view.clip(context);
    if (layer !== "parts" && density) {
      this.table ??= tableOf(map, end, { belt: rgb("draw-belt"), above: rgb("draw-over") });
      this.heatmap.paint(density.frame, density.next, share, this.table, end);
      this.heatmap.drawOn(context, whole);
    } else {
      context.fillStyle = this.belt;
      context.fillRect(whole.x, whole.y, whole.width, whole.height);
    }
    if (layer !== "density" && parts && this.layer) this.layer.draw(context, this.view, { ...parts, share, gap }, this.bodies);
    context.restore();
    this.tell();
  }

  probe(at) {
    this.at = at;
    this.onProbe(at !== null);
    this.tell();
  }

  moveProbe(event) {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const move = moves[event.key];
    if (event.key === "Escape") this.probe(null);
    if (!move || !this.view) return;
    event.preventDefault();
    event.stopPropagation();
    const { inner, ratio } = this.view;
    const from = this.at ?? [(inner.x + inner.width / 2) / ratio, (inner.y + inner.height / 2) / ratio];
    const step = event.shiftKey ? 1 : PROBE_STEP;
    this.probe([
      Math.min(Math.max(from[0] + move[0] * step, inner.x / ratio), (inner.x + inner.width - 1) / ratio),
      Math.min(Math.max(from[1] + move[1] * step, inner.y / ratio), (inner.y + inner.height - 1) / ratio),
    ]);
  }

  // The value under the probe, as lines of text; null outside of the grid.
  valueAt([x, y]) {
    const place = this.view.place(x, y);
    const { density, share } = this.picture ?? {};
    const value = density ? densityAt(density.frame, density.next, share, this.grid, place) : null;
    const [xm, ym] = place.map((m) => m.toFixed(3));
    const part = this.partAt(place);
    if (value === null) return density ? null : [`x ${xm} m, y ${ym} m`, ...part];
    const packing = this.scenario.macro.packing_density_per_m2;
    return [`${number(value * packing, 4)} parts/m²`, `${percent(value, 1)} of close packing`, `x ${xm} m, y ${ym} m`, ...part];
  }

  // Lines about the part at a place, if one is drawn there.
  partAt(place) {
    const { parts, share, gap, t } = this.picture;
    if (this.style.layer === "density" || !parts || !this.layer) return [];
    const part = this.layer.partAt({ ...parts, share, gap }, place);
    if (!part) return [];
    const { kinds } = this.layer.cargo;
    const since = this.data.enteredAt(part.id);
    return [`Part ${part.id + 1}${kinds.length > 1 ? `, ${kinds[part.kind].name}` : ""}`, quantity(Math.hypot(part.vx, part.vy), "m/s", 2),
      `on the belt for ${fixed(Math.max(0, t - since), 1)} s`];
  }

  tell() {
    const lines = this.at && this.view && this.picture ? this.valueAt(this.at) : null;
    this.tip.hidden = this.cross.hidden = lines === null;
    if (lines === null) return;
    this.tip.replaceChildren(...lines.map((line, k) => h(k === 0 ? "strong" : "span", {}, line)));
    const [x, y] = this.at;
    this.cross.style.transform = `translate(${x}px, ${y}px)`;
    const isRight = x > this.view.cssWidth - 190;
    const isLow = y > this.view.cssHeight - 90;
    this.tip.style.transform =
      `translate(${x + (isRight ? -12 : 12)}px, ${y + (isLow ? -12 : 12)}px) translate(${isRight ? "-100%" : "0"}, ${isLow ? "-100%" : "0"})`;
  }

  // What is seen, onto another canvas.
  drawOn(context, x, y) {
    for (const layer of [this.field, this.above, this.devices]) context.drawImage(layer, x, y);
  }
}
