// What of a scenario can be drawn on its belt: the ends of plates and their openings, the sides of counters, the ends of
// feeds; of the thing that is chosen its corners, and itself.

import { middleOf, movedBy } from "../board/things.js";
import { angleOf, plateOf, tidy, withPlate } from "../scenario/plate.js";

const NEAR_WALL_M = 0.015;
const HELD_M = 4 * NEAR_WALL_M; // a foot at the wall leaves it only when it is drawn so far

const metres = (value) => `${tidy(value, 4)} m`;
const place = ([x, y]) => `x ${metres(x)}, y ${metres(y)}`;

// Along the plate, whose foot and angle stay; at is in the middle of the opening.
function opened({ from, to }, far, [, y]) {
  const tip = 2 * y - far;
  const share = to[1] === from[1] ? 0 : (tip - from[1]) / (to[1] - from[1]);
  return { from, to: share > 0.05 ? [tidy(from[0] + share * (to[0] - from[0])), tidy(tip)] : to };
}

function ofPlate(written, k, id, { y_m: [y0, y1] }) {
  const plate = plateOf(written);
  if (!plate) return [];
  const { from, to } = plate;
  const wall = Math.abs(from[1] - y0) < NEAR_WALL_M ? y0 : Math.abs(from[1] - y1) < NEAR_WALL_M ? y1 : null;
  const far = to[1] >= from[1] ? y1 : y0;
  const onWall = ([x, y]) => [x, wall !== null && Math.abs(y - wall) < HELD_M ? wall : y];
  const handle = (kind, at, said, moved, step = 1) => ({ key: `plate ${k} ${kind}`, kind, at, step, said: `${id}, ${kind}: ${said}, angle ${tidy(angleOf(plate), 4)}°`,
    write: (scenario, to2) => (scenario.obstacles[k] = withPlate(scenario.obstacles[k], moved(to2))) });
  return [
    handle("foot", from, place(from), (at) => ({ from: onWall(at), to })),
    handle("tip", to, place(to), (at) => ({ from, to: at })),
    // The handle stands in the middle of the opening, and so moves half as far as the tip.
    handle("opening", [to[0], (to[1] + far) / 2], metres(Math.abs(far - to[1])), (at) => opened(plate, far, at), 0.5),
  ];
}

// One end of a pair of numbers, along one axis.
function ofEnd(key, kind, said, at, pair, end, axis, write) {
  return { key, kind, at, step: 1, said: `${said}: ${metres(pair[end])}`, write: (scenario, to) => {
    const moved = pair.map((value, side) => (side === end ? tidy(to[axis]) : value));
    if (moved[0] < moved[1]) write(scenario, moved);
  } };
}

// Sides of counters that meet have handles at several heights.
function ofCounter(written, k, { id, x_m: xs, y_m: [y0, y1] }) {
  const y = y0 + (0.5 - 0.12 * (k % 3)) * (y1 - y0);
  return [0, 1].map((end) => ofEnd(`counter ${k} ${end}`, "counter", `${id}, ${end === 0 ? "upstream" : "downstream"} side of the counter, x`,
    [xs[end], y], xs, end, 0, (scenario, pair) => (scenario.counters[k].x_m = pair)));
}

function ofFeed(written, k, { id, edge, x_m: xs, y_m: ys }, { x_m: [x0, x1], y_m: [y0, y1] }) {
  if (!edge) return [];
  const isUpright = edge === "west" || edge === "east";
  const [name, pair] = isUpright ? ["y_m", written.y_m ?? ys ?? [y0, y1]] : ["x_m", written.x_m ?? xs ?? [x0, x1]];
  const side = { west: x0, east: x1, south: y0, north: y1 }[edge];
  return [0, 1].map((end) => ofEnd(`feed ${k} ${end}`, "feed", `${id}, ${["first", "second"][end]} end of the feed, ${isUpright ? "y" : "x"}`,
    isUpright ? [side, pair[end]] : [pair[end], side], pair, end, isUpright ? 1 : 0, (scenario, moved) => (scenario.feeds[k][name] = moved)));
}

// Corners of belts and sinks, beams and lines of feeds, and those of plates that are not straight; the whole thing by its middle.
function ofChosen(written, { list, k }, id) {
  const item = written[list]?.[k];
  if (!item) return [];
  const corners = ["polygon_m", "line_m", "path_m"].filter((name) => Array.isArray(item[name]) && !(list === "obstacles" && plateOf(item)))
    .flatMap((name) => item[name].map((at, c) => ({ key: `${list} ${k} ${name} ${c}`, kind: "corner", at, step: 1, said: `${id}, corner ${c + 1}: ${place(at)}`,
      write: (scenario, to) => (scenario[list][k][name][c] = to.map((value) => tidy(value))) })));
  const ofPath = (item.path?.points_m ?? []).map((at, c) => ({ key: `${list} ${k} path ${c}`, kind: "corner", at, step: 1, said: `${id}, corner ${c + 1}: ${place(at)}`,
    write: (scenario, to) => (scenario[list][k].path.points_m[c] = to.map((value) => tidy(value))) }));
  const middle = middleOf(item);
  const whole = middle && { key: `${list} ${k} whole`, kind: "whole", at: middle, step: 1, said: `${id}, as a whole: ${place(middle)}`,
    write: (scenario, to) => (scenario[list][k] = movedBy(scenario[list][k], to.map((value, axis) => value - middleOf(scenario[list][k])[axis]))) };
  return [...corners, ...ofPath, ...(whole ? [whole] : [])];
}

// [{ key, kind, thing: [list, k], at: [x, y], said, step, write(scenario, [x, y]) }]; step: how far it moves where the other end of
// what it means moves by 1. written: as it is edited; resolved: with all defaults; chosen: { list, k } of the board, or null.
export function handlesOf(written, resolved, chosen = null) {
  const { domain } = resolved;
  const of = (name, list) => (resolved[name] ?? []).flatMap((item, k) => (written[name]?.[k] ? list(written[name][k], k, item) : [])
    .map((handle) => ({ ...handle, thing: [name, k] })));
  return [
    ...(chosen ? ofChosen(written, chosen, resolved[chosen.list]?.[chosen.k]?.id ?? chosen.list)
      .map((handle) => ({ ...handle, thing: [chosen.list, chosen.k] })) : []),
    ...of("counters", ofCounter),
    ...of("feeds", (feed, k, known) => ofFeed(feed, k, known, domain)),
    ...of("obstacles", (obstacle, k, { id }) => ofPlate(obstacle, k, id, domain)),
  ];
}

// The resolved scenario with what is being drawn.
export function asWritten(written, resolved) {
  const put = (name, change) => (resolved[name] ?? []).map((item, k) => ({ ...item, ...(written[name]?.[k] ? change(written[name][k]) : {}) }));
  const sides = ({ x_m: xs, y_m: ys }) => ({ ...(xs ? { x_m: xs } : {}), ...(ys ? { y_m: ys } : {}) });
  const line = ({ line_m: ends, polygon_m: corners, arc, path }) => ({ ...(ends ? { line_m: ends } : {}), ...(corners ? { polygon_m: corners } : {}), ...(arc ? { arc } : {}), ...(path ? { path } : {}) });
  return { ...resolved, belts: put("belts", line), photo_eyes: put("photo_eyes", line), sinks: put("sinks", line), counters: put("counters", sides),
    feeds: put("feeds", (feed) => ({ ...sides(feed), ...line(feed) })), obstacles: put("obstacles", (obstacle) => {
    const plate = plateOf(obstacle);
    return plate ? { path_m: [plate.from, plate.to] } : obstacle.path_m ? { path_m: obstacle.path_m } : {};
  }) };
}
