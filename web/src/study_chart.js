// A figure against a parameter, a point for each of a study's, with its interval. Points open their run.

import uPlot from "uplot";

import { h } from "./dom.js";
import { models, quantity } from "./format.js";
import { axisOf, longest } from "./plot_axis.js";
import { saveButtons } from "./plot_file.js";
import { color, onTheme } from "./theme.js";

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

  // points: [{ key, x, mean, low, high, model, isBest, title }]; axes: the words below and beside.
  show(points, axes) {
    this.points = [...points].sort((a, b) => a.x - b.x);
    const isSame = axes.join() === this.axes.join();
    this.axes = axes;
    this.box.setAttribute("aria-label", `${axes[1]} against ${axes[0]}`);
    if (!this.plot || !isSame) this.rebuild();
    else this.plot.setData(this.data());
    this.showLegend();
  }

  // As saveCurves() takes it.
  what() {
    const [from, to] = this.rangeOf(this.points.map(({ x }) => x), 0.06);
    const curves = this.seen().map((model) => {
      const points = this.points.filter((point) => point.model === model);
      return { name: models[model], color: COLORS[model], points: true, t: points.map(({ x }) => x), v: points.map(({ mean }) => mean),
        low: points.map(({ low }) => low), high: points.map(({ high }) => high) };
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

  options() {
    const series = (model) => ({ stroke: color(COLORS[model]), width: 1, dash: [3, 4], spanGaps: true,
      points: { show: true, size: 8, fill: color(COLORS[model]), width: 0 } });
    return {
      width: Math.max(120, this.box.clientWidth), height: 340, padding: [12, 22, 0, 0], legend: { show: false },
      cursor: { show: false },
      scales: {
        x: { time: false, range: () => this.rangeOf(this.points.map(({ x }) => x), 0.06) },
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
    for (const { x, low, high, model } of this.points) {
      if (low === null) continue;
      const [px, y0, y1] = [u.valToPos(x, "x", true), u.valToPos(low, "y", true), u.valToPos(high, "y", true)];
      const tick = 4 * devicePixelRatio;
      ctx.strokeStyle = color(COLORS[model]);
      ctx.beginPath();
      ctx.moveTo(px, y0);
      ctx.lineTo(px, y1);
      for (const y of [y0, y1]) {
        ctx.moveTo(px - tick, y);
        ctx.lineTo(px + tick, y);
      }
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
      best ? h("li", {}, h("i", { class: "best-mark" }), h("span", {}, `best: ${quantity(best.x, "", 4)}`)) : "");
  }
}
