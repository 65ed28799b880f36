// Curves as an SVG file, as a plot shows them: for a paper, a slide, or to be worked on.

import { svg } from "./dom.js";
import { number } from "./format.js";
import { saveBlob } from "./picture.js";
import { ticksOf } from "./scenery.js";
import { color } from "./theme.js";

const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM, ROW] = [900, 440, 70, 20, 16, 46, 20];
const POINTS_MAX = 4000; // of a curve: more are closer than a file can show

const thinned = (items) => {
  const step = Math.ceil(items.length / POINTS_MAX);
  return items.filter((_, k) => k % step === 0 || k === items.length - 1);
};

// curves: as CurvePlot has them; end: of the axis of time, s; unit: what the other axis is called; title: what the file says of itself.
export function saveCurves({ curves, end, unit, title, name }) {
  const values = curves.flatMap(({ v }) => [Math.min(...thinned(v)), Math.max(...thinned(v))]).filter(Number.isFinite);
  const [low, high] = [Math.min(0, ...values) * 1.05, Math.max(1, ...values) * 1.05];
  const bottom = HEIGHT - BOTTOM;
  const x = (t) => LEFT + ((WIDTH - LEFT - RIGHT) * t) / (end || 1);
  const y = (v) => bottom - ((bottom - TOP) * (v - low)) / (high - low);
  const at = (value) => value.toFixed(2);
  const text = (px, py, words, more = {}) => svg("text", { x: at(px), y: at(py), ...more }, words);
  const lines = curves.map(({ color: c, dash, points, t, v }) => {
    const places = thinned(t.map((time, k) => [x(time), y(v[k])]).filter((place) => place.every(Number.isFinite)));
    if (points) return svg("g", { fill: color(c) }, places.map(([px, py]) => svg("circle", { cx: at(px), cy: at(py), r: "2.5" })));
    return svg("polyline", { points: places.map((place) => place.map(at).join()).join(" "), fill: "none", stroke: color(c), "stroke-width": "2",
      "stroke-dasharray": (dash ?? []).join(" ") });
  });
  const names = curves.map(({ name: word, group, color: c, dash }, k) => {
    const py = HEIGHT + ROW * k;
    return svg("g", {}, svg("line", { x1: String(LEFT), x2: String(LEFT + 24), y1: String(py - 4), y2: String(py - 4), stroke: color(c), "stroke-width": "2",
      "stroke-dasharray": (dash ?? []).join(" ") }), text(LEFT + 32, py, group ? `${group}: ${word}` : word));
  });
  const grid = [...ticksOf(low, high, 6).flatMap(({ value }) => [
    svg("line", { x1: String(LEFT), x2: String(WIDTH - RIGHT), y1: at(y(value)), y2: at(y(value)), stroke: "#d5dbe1" }), text(LEFT - 8, y(value) + 4, number(value, 9), { "text-anchor": "end" })]),
  ...ticksOf(0, end || 1, 8).flatMap(({ value, text: words }) => [
    svg("line", { x1: at(x(value)), x2: at(x(value)), y1: String(TOP), y2: String(bottom), stroke: "#d5dbe1" }), text(x(value), bottom + 18, words, { "text-anchor": "middle" })])];
  const height = HEIGHT + ROW * curves.length;
  const drawing = svg("svg", { viewBox: `0 0 ${WIDTH} ${height}`, width: String(WIDTH), height: String(height),
    "font-family": "system-ui, sans-serif", "font-size": "13", fill: "#1b2430" },
  svg("title", {}, title), svg("rect", { width: "100%", height: "100%", fill: "#fff" }), grid, lines,
  text((LEFT + WIDTH - RIGHT) / 2, bottom + 38, "Time (s)", { "text-anchor": "middle" }),
  text(16, (TOP + bottom) / 2, unit, { "text-anchor": "middle", transform: `rotate(-90 16 ${(TOP + bottom) / 2})` }), names);
  saveBlob(new Blob([new XMLSerializer().serializeToString(drawing)], { type: "image/svg+xml" }), name);
}
