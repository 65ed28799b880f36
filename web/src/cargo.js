// What the parts of a run look like from above: outlines of their shapes, and which part is of which kind.

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

function countsOf(kinds, n) {
  const all = kinds.reduce((sum, { share }) => sum + share, 0);
  let left = n;
  const counts = kinds.map(({ share }) => {
    const quota = Math.min(n * (share / all), left);
    left -= Math.floor(quota);
    return { whole: Math.floor(quota), rest: quota - Math.floor(quota) };
  });
  for (; left > 0; left--) {
    const most = counts.reduce((best, count) => (count.rest > best.rest ? count : best));
    most.whole += 1;
    most.rest -= 1;
  }
  return counts.map(({ whole }) => whole);
}

// xoshiro256** seeded by splitmix64, as the solver draws.
function generator(seed) {
  const cut = (x) => BigInt.asUintN(64, x);
  const rotate = (x, by) => cut((x << by) | (x >> (64n - by)));
  let mixed = BigInt(seed);
  const s = Array.from({ length: 4 }, () => {
    mixed = cut(mixed + 0x9e3779b97f4a7c15n);
    let z = cut((mixed ^ (mixed >> 30n)) * 0xbf58476d1ce4e5b9n);
    z = cut((z ^ (z >> 27n)) * 0x94d049bb133111ebn);
    return z ^ (z >> 31n);
  });
  return () => {
    const bits = cut(rotate(cut(s[1] * 5n), 7n) * 9n);
    const shifted = cut(s[1] << 17n);
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= shifted;
    s[3] = rotate(s[3], 45n);
    return Number(bits >> 11n) * 2 ** -53;
  };
}

// The kind of each of n parts of a mix, as in the solver: counts by the largest remainder, in
// an order drawn from cargo_seed.
export function dealKinds(cargo, seed, n) {
  const kinds = new Uint8Array(n);
  let at = 0;
  countsOf(cargo, n).forEach((count, kind) => {
    kinds.fill(kind, at, at + count);
    at += count;
  });
  const draw = generator(seed);
  for (let left = n; left > 1; left--) {
    const k = Math.floor(draw() * left);
    [kinds[left - 1], kinds[k]] = [kinds[k], kinds[left - 1]];
  }
  return kinds;
}

// { kinds, kindOfPart(k) } of a resolved scenario with n parts at the start.
export function cargoOf(scenario, n) {
  const list = Array.isArray(scenario.cargo) ? scenario.cargo : [scenario.cargo];
  const kinds = list.map(kindOf);
  if (list.length === 1) return { kinds, kindOfPart: () => 0 };
  const dealt = dealKinds(list, scenario.cargo_seed, n);
  return { kinds, kindOfPart: (k) => dealt[k] };
}
