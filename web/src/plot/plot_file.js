// A plot as a file, for a paper or a slide: its curves as SVG, to be worked on, or as a PNG of what is seen.

import { h, iconButton, svg } from "../base/dom.js";
import { saveBlob } from "../base/files.js";
import { fileNameOf, number } from "../base/format.js";
import { color } from "../base/theme.js";
import { ticksOf } from "../player/scenery.js";

const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM, ROW] = [900, 440, 70, 20, 16, 46, 20];
const POINTS_MAX = 4000; // of a curve: more are closer than a file can show

const thinned = (items) => {
  const step = Math.ceil(items.length / POINTS_MAX);
  return items.filter((_, k) => k % step === 0 || k === items.length - 1);
};

// The range of the axis of values: from 0 on, if it is that of a time.
function rangeOf(curves, hasZero) {
  const known = curves.flatMap(({ v, low = [], high = [] }) => [v, low, high].flatMap((values) => {
    const shown = thinned(values).filter(Number.isFinite);
    return shown.length > 0 ? [Math.min(...shown), Math.max(...shown)] : [];
  }));
  const [least, most] = [Math.min(...known, hasZero ? 0 : Infinity), Math.max(...known, hasZero ? 1 : -Infinity)];
  const room = 0.05 * (most - least || Math.abs(most) || 1);
  return [least === 0 ? 0 : least - room, most + room];
}

// curves: as CurvePlot has them, or points with intervals (low to high, and left to right); axes: what they are called; from, to: of the first axis.
function saveCurves({ curves, from, to, axes: [across, unit], title }) {
  const [low, high] = rangeOf(curves, from === 0);
  const bottom = HEIGHT - BOTTOM;
  const x = (t) => LEFT + ((WIDTH - LEFT - RIGHT) * (t - from)) / (to - from || 1);
  const y = (v) => bottom - ((bottom - TOP) * (v - low)) / (high - low);
  const at = (value) => value.toFixed(2);
  const text = (px, py, words, more = {}) => svg("text", { x: at(px), y: at(py), ...more }, words);
  const lines = curves.map(({ color: c, dash, points, t, v, low: lows = [], high: highs = [], left: lefts = [], right: rights = [] }) => {
    const places = thinned(t.map((time, k) => [x(time), y(v[k])]).filter((place) => place.every(Number.isFinite)));
    const span = (d) => svg("path", { d, stroke: color(c), "stroke-width": "1.5" });
    const spans = t.flatMap((time, k) => [Number.isFinite(lows[k]) ? span(`M${at(x(time))} ${at(y(lows[k]))}V${at(y(highs[k]))}`) : [],
      Number.isFinite(lefts[k]) ? span(`M${at(x(lefts[k]))} ${at(y(v[k]))}H${at(x(rights[k]))}`) : []].flat());
    if (points) return svg("g", { fill: color(c) }, spans, places.map(([px, py]) => svg("circle", { cx: at(px), cy: at(py), r: "2.5" })));
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
  ...ticksOf(from, to || 1, 8).flatMap(({ value, text: words }) => [
    svg("line", { x1: at(x(value)), x2: at(x(value)), y1: String(TOP), y2: String(bottom), stroke: "#d5dbe1" }), text(x(value), bottom + 18, words, { "text-anchor": "middle" })])];
  const height = HEIGHT + ROW * curves.length;
  const drawing = svg("svg", { viewBox: `0 0 ${WIDTH} ${height}`, width: String(WIDTH), height: String(height),
    "font-family": "system-ui, sans-serif", "font-size": "13", fill: "#1b2430" },
  svg("title", {}, title), svg("rect", { width: "100%", height: "100%", fill: "#fff" }), grid, lines,
  text((LEFT + WIDTH - RIGHT) / 2, bottom + 38, across, { "text-anchor": "middle" }),
  text(16, (TOP + bottom) / 2, unit, { "text-anchor": "middle", transform: `rotate(-90 16 ${(TOP + bottom) / 2})` }), names);
  saveBlob(new Blob([new XMLSerializer().serializeToString(drawing)], { type: "image/svg+xml" }), `${fileNameOf(title)}.svg`);
}

// The drawing of a uPlot as it is seen, below what it is and above what its curves are.
function savePicture(plot, { curves, title }) {
  const { canvas: seen } = plot.ctx;
  const ratio = devicePixelRatio;
  const [margin, row] = [16 * ratio, 20 * ratio];
  const canvas = h("canvas", { width: String(seen.width + 2 * margin), height: String(seen.height + (curves.length + 3) * row) });
  const context = canvas.getContext("2d");
  const write = (text, x, y, weight = "") => {
    context.font = `${weight} ${13 * ratio}px system-ui, sans-serif`;
    context.fillStyle = color("text");
    context.fillText(text, x, y);
  };
  context.fillStyle = color("surface");
  context.fillRect(0, 0, canvas.width, canvas.height);
  write(title, margin, 1.2 * row, "600");
  context.drawImage(seen, margin, 1.5 * row);
  curves.forEach(({ name, group, color: c, dash = [], points }, k) => {
    const y = seen.height + (2.5 + k) * row;
    context.strokeStyle = color(c);
    context.lineWidth = (points ? 6 : 2) * ratio;
    context.setLineDash(points ? [] : dash.map((length) => length * ratio));
    context.beginPath();
    context.moveTo(margin, y - 4 * ratio);
    context.lineTo(margin + (points ? 6 : 24) * ratio, y - 4 * ratio);
    context.stroke();
    write(group ? `${group}: ${name}` : name, margin + 32 * ratio, y);
  });
  canvas.toBlob((blob) => saveBlob(blob, `${fileNameOf(title)}.png`), "image/png");
}

// Buttons that save a plot: what() as for saveCurves(), plot() the uPlot, or null.
export function saveButtons(what, plot) {
  return [iconButton("download", "Save the curves as SVG", () => saveCurves(what()), { class: "bare" }),
    iconButton("picture", "Save the plot as PNG", () => plot() && savePicture(plot(), what()), { class: "bare" })];
}
