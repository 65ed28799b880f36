// A figure against a parameter or another figure, a point for each of a study's, with its intervals. Points open their run.

import uPlot from "uplot";

import { h } from "../base/dom.js";
import { models, quantity } from "../base/format.js";
import { color, onTheme } from "../base/theme.js";
import { axisOf, longest } from "../plot/plot_axis.js";
import { saveButtons } from "../plot/plot_file.js";

const COLORS = { macro: "run-1", micro: "run-2" };

export class StudyChart {
  // onOpen(point).
  constructor(onOpen) {
    Object.assign(this, { onOpen, points: [], axes: ["", ""] });
    this.box = h("div", { class: "plot-box", role: "group" });
    this.legend = h("ul", { class: "plot-legend" });
    this.element = h("div", { class: "plot study-chart" }, this.box, h("div", { class: "plot-foot" }, this.legend, saveButtons(() => this.what(), () => this.plot)));
    this.layer = h("div");
    this.buttons = new Map();
    this.observer = new ResizeObserver(() => this.rebuild());
    this.observer.observe(this.box);
    this.stopTheme = onTheme(() => this.rebuild());
  }

  dispose() {
    this.observer.disconnect();
    this.stopTheme();
    this.plot?.destroy();
  }

  // points: [{ key, x, xLow, xHigh, mean, low, high, model, isBest, isFront, title }]; isLine: neighbours are joined; axes: the words
  // below and beside.
  show(points, isLine, axes) {
    this.points = [...points].sort((a, b) => a.x - b.x);
    const isSame = axes.join() === this.axes.join() && isLine === this.isLine;
    Object.assign(this, { axes, isLine });
    this.box.setAttribute("aria-label", `${axes[1]} against ${axes[0]}`);
    if (!this.plot || !isSame) this.rebuild();
    else this.plot.setData(this.data());
    this.showLegend();
  }

  // As saveCurves() takes it.
  what() {
    const [from, to] = this.rangeAcross();
    const curves = this.seen().map((model) => {
      const points = this.points.filter((point) => point.model === model);
      return { name: models[model], color: COLORS[model], points: true, t: points.map(({ x }) => x), v: points.map(({ mean }) => mean),
        low: points.map(({ low }) => low), high: points.map(({ high }) => high),
        left: points.map(({ xLow }) => xLow), right: points.map(({ xHigh }) => xHigh) };
    });
    return { curves, from, to, axes: this.axes, title: `${this.axes[1]} against ${this.axes[0]}` };
  }

  seen() {
    return ["macro", "micro"].filter((model) => this.points.some((point) => point.model === model));
  }

  data() {
    const of = (model) => this.points.map((point) => (point.model === model ? point.mean : null));
    return [this.points.map(({ x }) => x), of("macro"), of("micro")];
  }

  // The interval's ends belong to the picture, too.
  rangeOf(values, pad) {
    const known = values.filter((value) => value !== null && Number.isFinite(value));
    if (known.length === 0) return [0, 1];
    const [low, high] = [Math.min(...known), Math.max(...known)];
    const room = (high - low || Math.abs(high) || 1) * pad;
    return [low - room, high + room];
  }

  rangeAcross() {
    return this.rangeOf(this.points.flatMap(({ x, xLow, xHigh }) => [x, xLow, xHigh]), 0.06);
  }

  options() {
    const series = (model) => ({ stroke: color(COLORS[model]), width: this.isLine ? 1 : 0, dash: [3, 4], spanGaps: true,
      points: { show: true, size: 8, fill: color(COLORS[model]), width: 0 } });
    return {
      width: Math.max(120, this.box.clientWidth), height: 340, padding: [12, 22, 0, 0], legend: { show: false },
      cursor: { show: false },
      scales: {
        x: { time: false, range: () => this.rangeAcross() },
        y: { range: () => this.rangeOf(this.points.flatMap(({ mean, low, high }) => [mean, low, high]), 0.1) },
      },
      axes: [axisOf(this.axes[0], 26), axisOf(this.axes[1], (u, texts) => 22 + 7 * longest(texts))],
      series: [{}, series("macro"), series("micro")],
      hooks: { ready: [(u) => u.over.append(this.layer)], drawSeries: [(u, k) => k === 2 && this.drawIntervals(u)], draw: [(u) => this.place(u)] },
    };
  }

  rebuild() {
    this.plot?.destroy();
    this.plot = null;
    this.buttons.clear();
    this.layer.replaceChildren();
    if (this.box.clientWidth === 0) return;
    this.plot = new uPlot(this.options(), this.data(), this.box);
  }

  drawIntervals(u) {
    const { ctx } = u;
    ctx.save();
    ctx.lineWidth = 1.5 * devicePixelRatio;
    const tick = 4 * devicePixelRatio;
    const at = (x, y) => [u.valToPos(x, "x", true), u.valToPos(y, "y", true)];
    const bar = ([x0, y0], [x1, y1], [dx, dy]) => {
      ctx.moveTo(x0, y0);
      ctx.lineTo(x1, y1);
      for (const [x, y] of [[x0, y0], [x1, y1]]) {
        ctx.moveTo(x - dx, y - dy);
        ctx.lineTo(x + dx, y + dy);
      }
    };
    for (const { x, xLow, xHigh, mean, low, high, model } of this.points) {
      ctx.strokeStyle = color(COLORS[model]);
      ctx.beginPath();
      if (low !== null) bar(at(x, low), at(x, high), [tick, 0]);
      if (xLow !== null) bar(at(xLow, mean), at(xHigh, mean), [0, tick]);
      ctx.stroke();
    }
    ctx.restore();
  }

  // A button over each point, in the order of the axis; made once so that the focus stays on it.
  place(u) {
    const keys = new Set(this.points.map(({ key }) => key));
    for (const [key, button] of this.buttons) {
      if (keys.has(key)) continue;
      button.remove();
      this.buttons.delete(key);
    }
    for (const [k, point] of this.points.entries()) {
      let button = this.buttons.get(point.key);
      if (!button) {
        button = h("button", { type: "button", class: "study-point", on: { click: () => this.onOpen(this.points.find(({ key }) => key === point.key)) } });
        this.buttons.set(point.key, button);
      }
      if (this.layer.children[k] !== button) this.layer.insertBefore(button, this.layer.children[k] ?? null);
      button.title = point.title;
      button.setAttribute("aria-label", `${point.title}, open the run`);
      button.classList.toggle("best", point.isBest);
      button.classList.toggle("front", point.isFront);
      button.style.transform = `translate(${u.valToPos(point.x, "x")}px, ${u.valToPos(point.mean, "y")}px)`;
    }
  }

  showLegend() {
    const mark = (model) => {
      const dot = h("i", { class: "mark dots" });
      dot.style.color = color(COLORS[model]);
      return dot;
    };
    const best = this.points.find(({ isBest }) => isBest);
    this.legend.replaceChildren(...this.seen().map((model) => h("li", {}, mark(model), h("span", {}, models[model]))),
      best ? h("li", {}, h("i", { class: "best-mark" }), h("span", {}, `best: ${quantity(best.x, "", 4)}`)) : "",
      this.points.some(({ isFront }) => isFront) ? h("li", {}, h("i", { class: "front-mark" }), h("span", {}, "no other is better in both")) : "");
  }
}
