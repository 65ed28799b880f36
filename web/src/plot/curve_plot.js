// Curves in one plot, with a line at the time of the animation, whose values stand in the legend, and the values under the
// pointer beside it. A click or a drag moves that time.

import uPlot from "uplot";

import { h, setText, strokeMark } from "../base/dom.js";
import { fixed, number } from "../base/format.js";
import { indexBefore } from "../base/search.js";
import { color, onTheme } from "../base/theme.js";
import { axisOf, longest } from "./plot_axis.js";
import { saveButtons } from "./plot_file.js";
import { valueAt } from "./series.js";

// A piece of the curve.
function markOf({ color: name, dash, points }) {
  const mark = points ? h("i", { class: "mark dots" }) : strokeMark(dash);
  mark.style.color = color(name);
  return mark;
}

const PAST_END = 1e-3; // of its length: the last step of a density may pass the end, where other runs have their last sample

// The value of a curve at a time; null: it has none there. Parts that are counted one by one are whole between samples, too.
function valueOf({ t, v, points }, time) {
  if (t.length === 0 || time > t.at(-1) + PAST_END * Math.abs(t.at(-1))) return null;
  const k = indexBefore(t, time + 1e-9);
  const isCount = !points && Number.isInteger(v[k]) && Number.isInteger(v[k + 1] ?? 0);
  return isCount ? v[k] : valueAt(t, v, time);
}

function textOf(value) {
  if (value === null || Number.isInteger(value)) return number(value, 6);
  return fixed(value, Math.abs(value) < 10 ? 2 : 1);
}

export class CurvePlot {
  // height(): CSS pixels; onSeek(t).
  constructor(label, height, onSeek) {
    Object.assign(this, { height, onSeek, curves: [], t: 0, end: 0 });
    this.box = h("div", { class: "plot-box", role: "img", "aria-label": label });
    this.legend = h("ul", { class: "plot-legend" });
    const what = () => ({ curves: this.curves, from: 0, to: this.end, axes: ["Time (s)", this.unit], title: label });
    this.element = h("div", { class: "plot" }, this.box, h("div", { class: "plot-foot" }, this.legend, saveButtons(what, () => this.plot)));
    this.line = h("div", { class: "plot-now" });
    this.tip = h("div", { class: "tip", hidden: true });
    this.unit = "Parts";
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.box);
    this.stopTheme = onTheme(() => this.rebuild());
  }

  dispose() {
    this.observer.disconnect();
    this.stopTheme();
    this.plot?.destroy();
  }

  // curves: [{ name, group, color (of the style sheet), dash, points, t, v }], with a group only where neighbours
  // stand below a heading of the legend; end: of the axis of time; unit: what the other axis is called.
  setCurves(curves, end, unit = "Parts") {
    this.unit = unit;
    const key = JSON.stringify([end, unit, curves.map(({ name, group, color: c, dash }) => [name, group, c, dash])]);
    this.curves = curves;
    this.end = end;
    if (key !== this.key) {
      this.key = key;
      this.rebuild();
    } else if (this.plot) {
      this.plot.setData(this.join());
      this.place();
    }
  }

  join() {
    if (this.curves.length === 0) return [[0], [null]];
    if (this.curves.every(({ t }) => t === this.curves[0].t)) return [this.curves[0].t, ...this.curves.map(({ v }) => v)];
    return uPlot.join(this.curves.map(({ t, v }) => [t, v]));
  }

  options() {
    const span = (u, low, high) => [Math.min(0, low * 1.05), Math.max(1, high * 1.05)];
    return {
      width: Math.max(120, this.box.clientWidth),
      height: this.height(),
      padding: [8, 22, 0, 0],
      legend: { show: false },
      cursor: { drag: { x: false, y: false }, y: false, points: { size: 7 } },
      scales: { x: { time: false, range: () => [0, this.end || 1] }, y: { range: span } },
      axes: [axisOf("Time (s)", 26), axisOf(this.unit, (u, texts) => Math.max(46, 16 + 7 * longest(texts)))],
      series: [{}, ...this.curves.map((curve) => ({
        stroke: color(curve.color), width: curve.points ? 0 : 2, dash: curve.dash, spanGaps: true,
        points: curve.points ? { show: true, size: 5, fill: color(curve.color), width: 0 } : { show: false },
      }))],
      hooks: { ready: [(u) => this.arm(u)], setCursor: [(u) => this.hover(u)], setSize: [() => this.place()], draw: [() => this.place()] },
    };
  }

  rebuild() {
    this.plot?.destroy();
    this.plot = null;
    if (this.box.clientWidth === 0) return;
    this.plot = new uPlot(this.options(), this.join(), this.box);
    this.showLegend();
    this.place();
  }

  // The name of each curve and its value at the time of the line.
  showLegend() {
    this.values = this.curves.map(() => h("b"));
    this.legend.replaceChildren(...this.curves.flatMap((curve, k) => {
      const isFirst = curve.group && curve.group !== this.curves[k - 1]?.group;
      return [...(isFirst ? [h("li", { class: "group" }, curve.group)] : []),
        h("li", {}, markOf(curve), h("span", {}, curve.name), this.values[k])];
    }));
  }

  arm(u) {
    const seek = (event) => {
      const box = u.over.getBoundingClientRect();
      this.onSeek(Math.min(Math.max(u.posToVal(event.clientX - box.left, "x"), 0), this.end));
    };
    u.over.append(this.line, this.tip);
    u.over.addEventListener("pointerdown", (event) => {
      u.over.setPointerCapture(event.pointerId);
      seek(event);
    });
    u.over.addEventListener("pointermove", (event) => {
      if (u.over.hasPointerCapture(event.pointerId)) seek(event);
    });
  }

  // Beside the pointer, on the side where there is room.
  hover(u) {
    const { left, top } = u.cursor;
    const time = left >= 0 ? u.posToVal(left, "x") : NaN;
    const rows = left >= 0 ? this.curves.filter((curve) => valueOf(curve, time) !== null) : [];
    this.tip.hidden = rows.length === 0;
    if (rows.length === 0) return;
    this.tip.replaceChildren(h("strong", {}, `${fixed(time, 2)} s`), ...rows.map((curve) =>
      h("span", { class: "row" }, markOf(curve), h("b", {}, textOf(valueOf(curve, time))), h("span", {}, curve.name))));
    const isRight = left > u.over.clientWidth / 2;
    const y = Math.min(Math.max(top, 0), Math.max(0, u.over.clientHeight - this.tip.offsetHeight));
    this.tip.style.transform = `translate(${left + (isRight ? -12 : 12)}px, ${y}px) translateX(${isRight ? "-100%" : "0"})`;
  }

  resize() {
    if (!this.plot) this.rebuild();
    else if (this.box.clientWidth > 0) this.plot.setSize({ width: this.box.clientWidth, height: this.height() });
  }

  showTime(t) {
    this.t = t;
    this.place();
  }

  place() {
    if (!this.plot) return;
    this.line.style.transform = `translateX(${this.plot.valToPos(Math.min(this.t, this.end), "x")}px)`;
    this.curves.forEach((curve, k) => this.values?.[k] && setText(this.values[k], textOf(valueOf(curve, this.t))));
  }
}
