// What the parts of a run look like from above: the outlines of their kinds.

import { areaOf, convexHull, hullCentre } from "./geometry.js";

const RIM = 24; // points for the rim of a cylinder that lies or leans

function ring(radius, z) {
  return Array.from({ length: RIM }, (_, k) => {
    const angle = (2 * Math.PI * k) / RIM;
    return [radius * Math.cos(angle), radius * Math.sin(angle), z];
  });
}

function bothEnds(outline, height) {
  return [-height / 2, height / 2].flatMap((z) => outline.map(([x, y]) => [x, y, z]));
}

// Corners about the centre of mass.
function cornersOf(shape) {
  if (shape.type === "cylinder") {
    return [...ring(shape.radius_m, -shape.height_m / 2), ...ring(shape.radius_m, shape.height_m / 2)];
  }
  if (shape.type === "box") {
    const [a, b] = [shape.length_m / 2, shape.width_m / 2];
    return bothEnds([[-a, -b], [a, -b], [a, b], [-a, b]], shape.height_m);
  }
  if (shape.type === "prism") {
    const { centre } = areaOf(shape.outline_m);
    return bothEnds(shape.outline_m.map(([x, y]) => [x - centre[0], y - centre[1]]), shape.height_m);
  }
  const centre = hullCentre(shape.vertices_m);
  return shape.vertices_m.map((p) => p.map((value, c) => value - centre[c]));
}

const mm = (m) => Math.round(m * 10000) / 10;

function nameOf(shape) {
  if (shape.type === "cylinder") return `cylinder, ${mm(2 * shape.radius_m)} mm across`;
  return shape.type === "box" ? `box, ${mm(shape.length_m)} × ${mm(shape.width_m)} mm` : shape.type;
}

// { name, isRound, radius, corners, outline }: radius is that of the disc of the same area, outline the upright
// part's from above.
function kindOf({ id, shape }) {
  const corners = cornersOf(shape);
  const outline = convexHull(corners);
  const isRound = shape.type === "cylinder";
  const radius = isRound ? shape.radius_m : Math.sqrt(areaOf(outline).area / Math.PI);
  return { name: id ?? nameOf(shape), isRound, radius, corners, outline };
}

// { kinds, kindOfPart(k) } of a resolved scenario; dealt: the kinds of its parts in their order, as the server names them, or
// undefined where there is one kind or each snapshot has a column of them.
export function cargoOf(scenario, dealt) {
  const list = Array.isArray(scenario.cargo) ? scenario.cargo : [scenario.cargo];
  return { kinds: list.map(kindOf), kindOfPart: (k) => dealt?.[k] ?? 0 };
}
