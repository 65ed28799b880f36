// Plane geometry that the drawings need.

// Corners of the convex hull of points, counter-clockwise (Andrew's monotone chain).
export function convexHull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (list) => {
    const chain = [];
    for (const p of list) {
      while (chain.length > 1 && turn(chain.at(-2), chain.at(-1), p) <= 0) chain.pop();
      chain.push(p);
    }
    chain.pop();
    return chain;
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

function turn(a, b, c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// Signed area and centroid of a polygon.
export function areaOf(polygon) {
  let area = 0;
  let x = 0;
  let y = 0;
  polygon.forEach((p, k) => {
    const q = polygon[(k + 1) % polygon.length];
    const cross = p[0] * q[1] - q[0] * p[1];
    area += cross / 2;
    x += ((p[0] + q[0]) * cross) / 6;
    y += ((p[1] + q[1]) * cross) / 6;
  });
  return { area, centre: area === 0 ? polygon[0] : [x / area, y / area] };
}

export function isInside(polygon, [x, y]) {
  let inside = false;
  polygon.forEach((p, k) => {
    const q = polygon[(k + 1) % polygon.length];
    if (p[1] > y !== q[1] > y && x < p[0] + ((y - p[1]) / (q[1] - p[1])) * (q[0] - p[0])) inside = !inside;
  });
  return inside;
}

// A point of an arc at a radius, a share of the way from its beginning to its end.
export function arcPlace({ centre_m: [x, y], from_deg: from, to_deg: to }, radius, share) {
  const angle = ((from + share * (to - from)) * Math.PI) / 180;
  return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
}

const along = ([x, y], [dx, dy], way) => [x + way * dx, y + way * dy];

// A belt as straights and arcs, in their order: a path has several.
export function sectionsOf(belt) {
  if (!belt.path) return [belt];
  const { points_m: points, radius_m: radii = [], width_m: width } = belt.path;
  const speed = Math.hypot(...belt.velocity_m_s);
  const directions = points.slice(1).map(([x, y], k) => {
    const [dx, dy] = [x - points[k][0], y - points[k][1]];
    return [dx / Math.hypot(dx, dy), dy / Math.hypot(dx, dy)];
  });
  const sections = [];
  let start = points[0];
  directions.forEach((direction, k) => {
    const next = directions[k + 1] ?? direction, radius = radii[k] ?? 0;
    const angle = Math.atan2(direction[0] * next[1] - direction[1] * next[0], direction[0] * next[0] + direction[1] * next[1]);
    const cut = radius * Math.tan(Math.abs(angle) / 2);
    const end = along(points[k + 1], direction, -cut);
    const aside = [-direction[1] * width / 2, direction[0] * width / 2];
    sections.push({ velocity_m_s: direction.map((part) => speed * part), line_m: [start, end],
      polygon_m: [along(start, aside, -1), along(end, aside, -1), along(end, aside, 1), along(start, aside, 1)] });
    start = along(points[k + 1], next, cut);
    if (cut === 0) return;
    const inward = [-direction[1] * Math.sign(angle), direction[0] * Math.sign(angle)];
    const from = (Math.atan2(-inward[1], -inward[0]) * 180) / Math.PI;
    sections.push({ velocity_m_s: [speed, 0], arc: { centre_m: along(end, inward, radius), inner_radius_m: radius - width / 2, outer_radius_m: radius + width / 2,
      from_deg: from, to_deg: from + (angle * 180) / Math.PI } });
  });
  return sections;
}

// The border of a section, to its left (1) or right (-1), in its direction.
function sideOf({ polygon_m: corners, arc }, side) {
  if (!arc) return side > 0 ? [corners[3], corners[2]] : [corners[0], corners[1]];
  const radius = (arc.to_deg - arc.from_deg) * side > 0 ? arc.inner_radius_m : arc.outer_radius_m;
  const n = Math.ceil(Math.abs(arc.to_deg - arc.from_deg) / 2);
  return Array.from({ length: n + 1 }, (_, k) => arcPlace(arc, radius, k / n));
}

// The corners of a belt; undefined of one that covers the domain.
export function beltOutline(belt) {
  const { polygon_m: polygon, arc, path } = belt;
  if (path) return [...sectionsOf(belt).flatMap((section) => sideOf(section, -1)), ...sectionsOf(belt).flatMap((section) => sideOf(section, 1)).reverse()];
  if (!arc) return polygon;
  const n = Math.ceil(Math.abs(arc.to_deg - arc.from_deg) / 2);
  const side = (radius) => Array.from({ length: n + 1 }, (_, k) => arcPlace(arc, radius, k / n));
  return [...side(arc.outer_radius_m), ...side(arc.inner_radius_m).reverse()];
}

// The size of an arc's velocity is its speed at the reference radius.
function arcVelocity({ velocity_m_s: velocity, arc }, [x, y]) {
  const radius = arc.reference_radius_m ?? (arc.inner_radius_m + arc.outer_radius_m) / 2;
  const turn = (Math.sign(arc.to_deg - arc.from_deg) * Math.hypot(...velocity)) / radius;
  return [-turn * (y - arc.centre_m[1]), turn * (x - arc.centre_m[0])];
}

// The belt under a point, or undefined; the later of overlapping belts wins.
export function beltUnder(scenario, at) {
  return scenario.belts.findLast((belt) => {
    const outline = beltOutline(belt);
    return !outline || isInside(outline, at);
  });
}

// Velocity of the belt under a point.
export function beltVelocity(scenario, at) {
  const belt = beltUnder(scenario, at);
  const section = belt?.path ? sectionsOf(belt).find((one) => isInside(beltOutline(one), at)) : belt;
  return section?.arc ? arcVelocity(section, at) : section?.velocity_m_s ?? [0, 0];
}

// True if a belt runs backwards at some time, or an action may let it.
export function mayReverse({ actions = [] }, { id, speed_schedule: schedule }) {
  return Boolean(schedule?.factor.some((factor) => factor < 0)) || actions.some(({ do: what }) => what.belt === id && what.factor < 0);
}

// Centre of mass of the convex hull of points in space, from its level slices: between two heights
// every edge that crosses is a segment between two of the points.
export function hullCentre(points, n = 200) {
  const heights = points.map((p) => p[2]);
  const low = Math.min(...heights);
  const step = (Math.max(...heights) - low) / n;
  const sum = [0, 0, 0];
  let volume = 0;
  for (let k = 0; k < n; k++) {
    const z = low + (k + 0.5) * step;
    const { area, centre } = areaOf(convexHull(crossings(points, z)));
    volume += area;
    [centre[0], centre[1], z].forEach((value, c) => (sum[c] += value * area));
  }
  return sum.map((value) => value / volume);
}

function crossings(points, z) {
  const below = points.filter((p) => p[2] <= z);
  const above = points.filter((p) => p[2] > z);
  return below.flatMap((p) => above.map((q) => {
    const share = (z - p[2]) / (q[2] - p[2]);
    return [p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])];
  }));
}
