// What is drawn in a DXF or SVG file as lines of points, y upwards. It is loaded when such a file is opened.

import { DxfParser } from "dxf-parser";
import { pointsOnPath } from "points-on-path";

const METRES = { 1: 0.0254, 2: 0.3048, 4: 0.001, 5: 0.01, 6: 1, 14: 0.1 }; // of the values of $INSUNITS
const CHORDS = 48; // of a circle
const DEPTH_MAX = 8; // of blocks in blocks
const POINTS_MAX = 50000;

function arc({ x, y }, radius, from, to) {
  const n = Math.max(2, Math.ceil((CHORDS * Math.abs(to - from)) / (2 * Math.PI)));
  return Array.from({ length: n + 1 }, (_, k) => {
    const angle = from + ((to - from) * k) / n;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}

// The arc between two vertices; bulge: the tangent of a quarter of its angle, positive to the left.
function bulging(a, b, bulge) {
  const angle = 4 * Math.atan(bulge);
  const away = (1 - bulge * bulge) / (4 * bulge); // of the centre from the chord, in chords
  const centre = { x: (a.x + b.x) / 2 - away * (b.y - a.y), y: (a.y + b.y) / 2 + away * (b.x - a.x) };
  const from = Math.atan2(a.y - centre.y, a.x - centre.x);
  return arc(centre, Math.hypot(a.x - centre.x, a.y - centre.y), from, from + angle);
}

function polyline({ vertices, shape: isClosed }) {
  const corners = isClosed ? [...vertices, vertices[0]] : vertices;
  return corners.flatMap((b, k) => {
    const a = corners[k - 1];
    return a?.bulge ? bulging(a, b, a.bulge).slice(1) : [[b.x, b.y]];
  });
}

const known = {
  LINE: polyline, LWPOLYLINE: polyline, POLYLINE: polyline,
  CIRCLE: ({ center, radius }) => arc(center, radius, 0, 2 * Math.PI),
  ARC: ({ center, radius, startAngle, endAngle }) => arc(center, radius, startAngle, endAngle > startAngle ? endAngle : endAngle + 2 * Math.PI),
};

const countPoints = (lines) => lines.reduce((sum, line) => sum + line.length, 0);

function refuseMany(n) {
  if (n > POINTS_MAX) throw new Error(`It has more than ${POINTS_MAX.toLocaleString("en")} points: leave out layers that are not needed.`);
}

// Where the points of a block come to lie.
function insertion({ position = { x: 0, y: 0 }, xScale = 1, yScale = 1, rotation = 0 }, { position: base = { x: 0, y: 0 } }) {
  const angle = (rotation * Math.PI) / 180;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return ([x, y]) => {
    const [u, v] = [(x - base.x) * xScale, (y - base.y) * yScale];
    return [position.x + c * u - s * v, position.y + s * u + c * v];
  };
}

// Texts, hatches and whatever else there is are left out, and so are blocks within themselves. An entity counts as a point, too, as
// blocks without lines may hold each other many times.
function linesIn(entities, blocks, inside, count) {
  return entities.flatMap((entity) => {
    refuseMany(count.n += 1);
    const block = entity.type === "INSERT" && !inside.includes(entity.name) && inside.length < DEPTH_MAX ? blocks[entity.name] : undefined;
    const lines = block?.entities ? linesIn(block.entities, blocks, [...inside, entity.name], count).map((line) => line.map(insertion(entity, block)))
      : known[entity.type] ? [known[entity.type](entity)] : [];
    if (!block) refuseMany(count.n += countPoints(lines));
    return lines;
  });
}

function parseDxf(text) {
  if (text.startsWith("AutoCAD Binary DXF")) throw new Error("It is a binary DXF file: save it as an ASCII one.");
  try {
    return new DxfParser().parseSync(text);
  } catch {
    throw new Error("It is no DXF file, or a damaged one.");
  }
}

// { lines: [[[x, y], ...], ...], metres: of a unit, or null }.
export function linesOfDxf(text) {
  const drawing = parseDxf(text);
  const lines = linesIn(drawing?.entities ?? [], drawing?.blocks ?? {}, [], { n: 0 });
  return { lines, metres: METRES[drawing?.header?.$INSUNITS] ?? null };
}

const numbers = (element, ...names) => names.map((name) => Number.parseFloat(element.getAttribute(name)) || 0);

// The outline of a shape as the data of a path.
function pathOf(shape) {
  if (shape.localName === "path") return shape.getAttribute("d") ?? "";
  if (shape.localName === "rect") {
    const [x, y, width, height] = numbers(shape, "x", "y", "width", "height");
    return `M${x} ${y}h${width}v${height}h${-width}z`;
  }
  if (shape.localName === "line") {
    const [x1, y1, x2, y2] = numbers(shape, "x1", "y1", "x2", "y2");
    return `M${x1} ${y1}L${x2} ${y2}`;
  }
  if (shape.localName.startsWith("poly")) return `M${shape.getAttribute("points")}${shape.localName === "polygon" ? "z" : ""}`;
  const [cx, cy, r, rx, ry] = numbers(shape, "cx", "cy", "r", "rx", "ry");
  const [a, b] = [rx || r, ry || r];
  return `M${cx - a} ${cy}a${a} ${b} 0 1 0 ${2 * a} 0a${a} ${b} 0 1 0 ${-2 * a} 0z`;
}

// The same with all transformations of what it stands in.
function shapeLines(shape, tolerance) {
  const lines = pointsOnPath(pathOf(shape), tolerance, tolerance).filter((line) => line.length > 1);
  for (let element = shape; element; element = element.parentElement) {
    const matrix = element.transform?.baseVal?.consolidate()?.matrix;
    if (!matrix) continue;
    for (const line of lines) line.forEach(([x, y], k) => (line[k] = [matrix.a * x + matrix.c * y + matrix.e, matrix.b * x + matrix.d * y + matrix.f]));
  }
  return lines.map((line) => line.map(([x, y]) => [x, -y]));
}

const LENGTHS = { mm: 0.001, cm: 0.01, m: 1, in: 0.0254, pt: 0.0254 / 72 };

// Styles, which the page's policy refuses even in a document that is not shown.
const STYLES = /\sstyle\s*=\s*(?:"[^"]*"|'[^']*')|<style\b[^]*?<\/style\s*>/g;

// The same of an SVG file; a unit has a length where the file says how wide it is.
export function linesOfSvg(text) {
  const { documentElement: svg } = new DOMParser().parseFromString(text.replace(STYLES, ""), "image/svg+xml");
  if (svg.localName !== "svg") throw new Error("It is no SVG file.");
  const [, width, unit] = /^([\d.]+)(mm|cm|m|in|pt)$/.exec(svg.getAttribute("width") ?? "") ?? [];
  const [, , wide, high] = (svg.getAttribute("viewBox") ?? "").split(/[\s,]+/).map(Number);
  const tolerance = Math.max(wide || 0, high || 0, 100) / 2000;
  const lines = [];
  let n = 0;
  for (const shape of svg.querySelectorAll("path, line, polyline, polygon, rect, circle, ellipse")) {
    if (shape.closest("defs, clipPath, mask, symbol, pattern, marker")) continue;
    const more = shapeLines(shape, tolerance);
    refuseMany(n += countPoints(more));
    lines.push(...more);
  }
  return { lines, metres: width && wide ? (Number(width) * LENGTHS[unit]) / wide : null };
}
