// What stands still: axes, walls, belts with their direction, counters, sinks, feeds. Drawn once for each size,
// above the cargo.

import { arcPlace, beltOutline, beltUnder, beltVelocity, isInside, mayReverse, sectionsOf } from "../scenario/geometry.js";

const FONT = "11px system-ui, sans-serif";
const RIM = 3; // CSS pixels that walls stand outside of the belt

// 1, 2 or 5 times a power of ten, so that about n steps fill the span.
export function niceStep(span, n) {
  const raw = span / n;
  const power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= raw * 0.999);
}

// [{ value, text }] of about n steps that are easily read.
export function ticksOf(from, to, n) {
  const step = niceStep(to - from, n);
  const places = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const list = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + step * 1e-9; k++) {
    list.push({ value: k * step, text: (k * step).toFixed(places) });
  }
  return list;
}

// A path twice: wide and dark below, thin and light above, so that it shows on every colour.
export function strokeTwice(context, path, { width, color, halo, dash = [] }, ratio) {
  context.setLineDash(dash.map((n) => n * ratio));
  context.lineWidth = (width + 2) * ratio;
  context.strokeStyle = halo;
  context.stroke(path);
  context.lineWidth = width * ratio;
  context.strokeStyle = color;
  context.stroke(path);
  context.setLineDash([]);
}

// The same for a line of text; x, y is its upper left corner. One that would stick out at the right of the canvas, or at its top, is moved onto it.
export function writeTwice(context, text, [x, y], color, halo, ratio) {
  context.font = FONT.replace("11", 11 * ratio);
  context.textBaseline = "top";
  context.textAlign = "left";
  context.lineWidth = 3 * ratio;
  context.strokeStyle = halo;
  context.lineJoin = "round";
  const [most, high] = [context.canvas.width - context.measureText(text).width - 2 * ratio, 11 * ratio];
  const place = [x < context.canvas.width ? Math.min(x, most) : x, y > -high ? Math.max(y, ratio) : y];
  context.strokeText(text, ...place);
  context.fillStyle = color;
  context.fillText(text, ...place);
}

function drawAxes(context, view, { x_m, y_m }, colors) {
  const { inner, ratio } = view;
  context.fillStyle = colors.muted;
  context.strokeStyle = colors.muted;
  context.lineWidth = ratio;
  context.font = FONT.replace("11", 11 * ratio);
  const marks = new Path2D();
  const bottom = inner.y + inner.height;
  context.textAlign = "center";
  context.textBaseline = "top";
  const across = ticksOf(...x_m, Math.max(2, inner.width / ratio / 90));
  for (const { value, text } of across) {
    marks.moveTo(view.x(value), bottom + 3 * ratio);
    marks.lineTo(view.x(value), bottom + 7 * ratio);
    context.fillText(value === across.at(-1).value ? `${text} m` : text, view.x(value), bottom + 9 * ratio);
  }
  context.textAlign = "right";
  context.textBaseline = "middle";
  const up = ticksOf(...y_m, Math.max(2, inner.height / ratio / 60));
  for (const { value, text } of up) {
    marks.moveTo(inner.x - 7 * ratio, view.y(value));
    marks.lineTo(inner.x - 3 * ratio, view.y(value));
    context.fillText(value === up.at(-1).value && text.length < 4 ? `${text} m` : text, inner.x - 10 * ratio, view.y(value));
  }
  context.stroke(marks);
}

function drawEdges(context, view, edges, colors) {
  const { x, y, width, height } = view.whole;
  const r = view.ratio;
  const sides = ["west", "east", "north", "south"];
  for (const side of sides) {
    const isWall = edges[side] === "wall";
    const out = isWall ? 1.5 * r : 0; // a wall stands outside, where it shows against the page
    const [x0, y0, x1, y1] = {
      west: [x - out, y, x - out, y + height],
      east: [x + width + out, y, x + width + out, y + height],
      north: [x, y - out, x + width, y - out],
      south: [x, y + height + out, x + width, y + height + out],
    }[side];
    context.beginPath();
    context.setLineDash(isWall ? [] : [3 * r, 4 * r]);
    context.lineWidth = (isWall ? 3 : 1) * r;
    context.strokeStyle = isWall ? colors.text : colors.muted;
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
    context.stroke();
  }
  context.setLineDash([]);
}

// The outlines of arcs and paths, chevrons, each in the direction of the belt below it, and back to back in both of one that may run backwards, on a
// lattice and along the middle of arcs and paths, and how much belts rise or fall in that direction.
function drawBelts(context, view, scenario, colors) {
  const { inner, ratio } = view;
  const path = new Path2D();
  const outlines = new Path2D();
  const gap = 120 * ratio;
  const put = (at) => {
    const [vx, vy] = beltVelocity(scenario, at);
    if (vx === 0 && vy === 0) return;
    const [x, y, angle] = [view.x(at[0]), view.y(at[1]), Math.atan2(-vy, vx)];
    const reverses = mayReverse(scenario, beltUnder(scenario, at));
    const [dx, dy] = [Math.cos(angle), Math.sin(angle)].map((part) => (reverses ? 8 * ratio * part : 0));
    addChevron(path, x + dx, y + dy, angle, 6 * ratio);
    if (reverses) addChevron(path, x - dx, y - dy, angle + Math.PI, 6 * ratio);
  };
  const hasLine = ({ arc, path: line }) => arc || line;
  for (const belt of scenario.belts.filter(hasLine)) {
    beltOutline(belt).forEach(([x, y], k) => outlines[k === 0 ? "moveTo" : "lineTo"](view.x(x), view.y(y)));
    outlines.closePath();
    for (const section of sectionsOf(belt)) {
      const { inner_radius_m: r, outer_radius_m: R, from_deg: from, to_deg: to } = section.arc ?? {};
      const [start, end] = section.line_m ?? [];
      const length = section.arc ? (((r + R) / 2) * Math.abs(to - from) * Math.PI) / 180 : Math.hypot(end[0] - start[0], end[1] - start[1]);
      const n = Math.max(1, Math.round((length * view.scale) / gap));
      const place = (share) => (section.arc ? arcPlace(section.arc, (r + R) / 2, share) : [0, 1].map((axis) => start[axis] + share * (end[axis] - start[axis])));
      for (let k = 0; k < n; k++) put(place((k + 0.5) / n));
    }
  }
  const n = [Math.max(2, Math.round(inner.width / gap)), Math.max(2, Math.round(inner.height / gap))];
  for (let i = 0; i < n[0]; i++) {
    for (let j = 0; j < n[1]; j++) {
      const px = inner.x + ((i + 0.5) * inner.width) / n[0];
      const py = inner.y + ((j + 0.5) * inner.height) / n[1];
      const at = view.place(px / ratio, py / ratio);
      if (!scenario.belts.some((belt) => hasLine(belt) && isInside(beltOutline(belt), at))) put(at);
    }
  }
  context.globalAlpha = 0.4;
  strokeTwice(context, outlines, { width: 1, color: colors.light, halo: colors.dark }, ratio);
  context.globalAlpha = 0.65;
  strokeTwice(context, path, { width: 1.5, color: colors.light, halo: colors.dark }, ratio);
  context.globalAlpha = 1;
  for (const { polygon_m: polygon, incline_deg: incline } of scenario.belts.filter(({ incline_deg: angle }) => angle)) {
    const { x_m: xs, y_m: ys } = scenario.domain;
    const corners = polygon ?? [[xs[0], ys[0]], [xs[1], ys[1]]];
    const [x, y] = [0, 1].map((k) => corners.reduce((sum, corner) => sum + corner[k], 0) / corners.length);
    writeTwice(context, `${Math.abs(incline)}° ${incline > 0 ? "up" : "down"}`, [view.x(x), view.y(y)], colors.light, colors.dark, ratio);
  }
}

function addChevron(path, x, y, angle, size) {
  const [c, s] = [Math.cos(angle) * size, Math.sin(angle) * size];
  path.moveTo(x - 0.5 * c + s, y - 0.5 * s - c);
  path.lineTo(x + 0.5 * c, y + 0.5 * s);
  path.lineTo(x - 0.5 * c - s, y - 0.5 * s + c);
}

function drawCounters(context, view, scenario, colors) {
  const { ratio } = view;
  scenario.counters.forEach(({ id, x_m: [x0, x1], y_m: [y0, y1] }, k) => {
    const path = new Path2D();
    path.rect(view.x(x0), view.y(y1), (x1 - x0) * view.scale, (y1 - y0) * view.scale);
    strokeTwice(context, path, { width: 1.25, color: colors.light, halo: colors.dark, dash: [6, 5] }, ratio);
    writeTwice(context, id, [view.x(x0) + 7 * ratio, view.y(y1) + (7 + 15 * k) * ratio], colors.light, colors.dark, ratio);
  });
}

// Outlines, hatched, with what is known of the rate.
function drawSinks(context, view, scenario, colors) {
  const { ratio } = view;
  for (const { id, polygon_m: corners, rate_per_s: rate } of scenario.sinks ?? []) {
    const [outline, hatch] = [new Path2D(), new Path2D()];
    const [xs, ys] = [corners.map(([x]) => view.x(x)), corners.map(([, y]) => view.y(y))];
    const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    corners.forEach((_, k) => outline[k === 0 ? "moveTo" : "lineTo"](xs[k], ys[k]));
    outline.closePath();
    for (let x = left - (bottom - top); x < right; x += 8 * ratio) {
      hatch.moveTo(x, bottom);
      hatch.lineTo(x + bottom - top, top);
    }
    context.save();
    context.clip(outline);
    context.globalAlpha = 0.5;
    strokeTwice(context, hatch, { width: 1, color: colors.feed, halo: colors.dark }, ratio);
    context.restore();
    strokeTwice(context, outline, { width: 2, color: colors.feed, halo: colors.dark }, ratio);
    writeTwice(context, rate === undefined ? id : `${id}, ${rate}/s`, [left + 5 * ratio, top + 4 * ratio], colors.feed, colors.dark, ratio);
  }
}

// { line, way } of a feed: where parts enter, and which way: over a side inwards, else with the belt.
function lineOf(scenario, { edge, x_m: xs, y_m: ys, line_m: line }) {
  const { x_m: [x0, x1], y_m: [y0, y1] } = scenario.domain;
  if (!edge) return { line, way: beltVelocity(scenario, [(line[0][0] + line[1][0]) / 2, (line[0][1] + line[1][1]) / 2]) };
  const [xa, xb] = xs ?? [x0, x1];
  const [ya, yb] = ys ?? [y0, y1];
  return {
    west: { line: [[x0, ya], [x0, yb]], way: [1, 0] },
    east: { line: [[x1, ya], [x1, yb]], way: [-1, 0] },
    south: { line: [[xa, y0], [xb, y0]], way: [0, 1] },
    north: { line: [[xa, y1], [xb, y1]], way: [0, -1] },
  }[edge];
}

// The lines that parts enter on.
export function feedLines(scenario) {
  return (scenario.feeds ?? []).map((feed) => lineOf(scenario, feed).line);
}

// The line with arrow heads on it.
function drawFeeds(context, view, scenario, colors) {
  const { ratio } = view;
  for (const feed of scenario.feeds ?? []) {
    const { line: [from, to], way: [vx, vy] } = lineOf(scenario, feed);
    const [x0, y0, x1, y1] = [view.x(from[0]), view.y(from[1]), view.x(to[0]), view.y(to[1])];
    const n = Math.max(1, Math.round(Math.hypot(x1 - x0, y1 - y0) / (60 * ratio)));
    const [line, heads] = [new Path2D(), new Path2D()];
    line.moveTo(x0, y0);
    line.lineTo(x1, y1);
    for (let k = 0; k < n; k++) {
      const share = (k + 0.5) / n;
      addHead(heads, x0 + share * (x1 - x0), y0 + share * (y1 - y0), Math.atan2(-vy, vx), 9 * ratio);
    }
    strokeTwice(context, line, { width: 3, color: colors.feed, halo: colors.dark }, ratio);
    strokeTwice(context, heads, { width: 1, color: colors.feed, halo: colors.dark }, ratio);
    context.fillStyle = colors.feed;
    context.fill(heads);
    writeTwice(context, feed.id, [Math.min(x0, x1) + 14 * ratio, Math.max(y0, y1) - 18 * ratio], colors.feed, colors.dark, ratio);
  }
}

function addHead(path, x, y, angle, size) {
  const [c, s] = [Math.cos(angle) * size, Math.sin(angle) * size];
  path.moveTo(x + c, y + s);
  path.lineTo(x - 0.7 * s, y + 0.7 * c);
  path.lineTo(x + 0.7 * s, y - 0.7 * c);
  path.closePath();
}

// Everything onto a transparent canvas of the view's size.
export function drawScenery(context, view, scenario, colors) {
  context.clearRect(0, 0, view.width, view.height);
  drawAxes(context, view, view.visible, colors);
  context.save();
  view.clip(context);
  drawBelts(context, view, scenario, colors);
  drawCounters(context, view, scenario, colors);
  drawSinks(context, view, scenario, colors);
  context.restore();
  context.save();
  if (!view.isWhole) view.clip(context, RIM);
  drawEdges(context, view, scenario.edges, colors);
  drawFeeds(context, view, scenario, colors);
  context.restore();
}
