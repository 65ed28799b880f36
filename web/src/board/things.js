// The things that stand on a line, by the lists of a scenario that have them: what they are called, what a new one is, and how one is
// moved, turned and mirrored. A list that is not named here has things that are made of its schema.

import { plateOf, tidy, withPlate } from "../scenario/plate.js";
import { boxOf, formOf, labelOf, resolve } from "./schema.js";

// A share of the way, to a tenth or less of its length.
function at([low, high], share) {
  const step = 10 ** (Math.floor(Math.log10(high - low)) - 1);
  return tidy(Math.round((low + share * (high - low)) / step) * step, 6);
}

// A gate opens and closes by turns, a flap swings, a pusher goes to and fro; all begin as they are drawn.
const GATE = { t_s: [0, 5], value: [false, true], repeat_s: 10 };
const PUSHER = ({ y_m: [from, to] }) => ({ t_s: [0, 4, 4.5, 5, 5.5], shift_m: [0, 0, 1, 1, 0].map((share) => [0, tidy(0.4 * share * (to - from), 4)]), repeat_s: 10 });
const FLAP = { t_s: [0, 4, 5, 9, 10], turn_deg: [0, 0, 30, 30, 0], repeat_s: 10 };

function deflector({ x_m: xs, y_m: ys }) {
  const across = 0.7 * (ys[1] - ys[0]);
  return { end_m: [at(xs, 0.75), tidy(ys[0] + across, 4)], angle_deg: 60, length_m: tidy(across / Math.sin(Math.PI / 3), 6) };
}

const across = ({ x_m: xs, y_m: ys }, share) => [[at(xs, share), ys[0]], [at(xs, share), ys[1]]];
const plateAcross = (domain) => ({ from_m: across(domain, 0.6)[0], to_m: across(domain, 0.6)[1] });
// Along the lower side of the middle third.
const beside = ({ x_m: xs, y_m: ys }) => ({ from_m: [at(xs, 0.4), at(ys, 0.05)], to_m: [at(xs, 0.6), at(ys, 0.05)] });
const guide = ({ x_m: xs, y_m: ys }) => ({ from_m: [at(xs, 0.1), at(ys, 0.3)], to_m: [at(xs, 0.9), at(ys, 0.3)] });

const rectangle = ([left, right], [low, high]) => [[left, low], [right, low], [right, high], [left, high]];

// A belt that brings cargo from the left onto the first one, where the line is wider than that; else the middle third.
function belt({ x_m: xs, y_m: ys }, ids, { belts: [first] }) {
  const side = Math.max(...(first.polygon_m ?? []).map(([, y]) => y));
  if (side > ys[0] && side < ys[1]) return { velocity_m_s: [0, -0.4], polygon_m: rectangle([at(xs, 0.2), at(xs, 0.35)], [side, ys[1]]) };
  return { velocity_m_s: [0.4, 0], polygon_m: rectangle([at(xs, 1 / 3), at(xs, 2 / 3)], ys) };
}

// Across the beginning of a belt that belt() made at the side, else null.
function beginOf({ polygon_m: outline = [], velocity_m_s: [vx, vy] = [] } = {}) {
  if (outline.length !== 4 || vx !== 0 || !(vy < 0)) return null;
  const [xs, ys] = [0, 1].map((axis) => outline.map((corner) => corner[axis])).map((all) => [Math.min(...all), Math.max(...all)]);
  return [0.15, 0.85].map((share) => [at(xs, share), at(ys, 0.7)]);
}

const hasOutline = ({ polygon_m: polygon, arc, path }) => polygon || arc || path;

// An S to the left. It goes on from a belt that runs along the whole line, as a curve does; else it stands in the middle.
function path(domain, ids, { belts: [belt, ...others], feeds = [] }) {
  const { x_m: xs, y_m: ys } = domain, [vx, vy] = belt.velocity_m_s;
  const goesOn = others.length === 0 && vx > 0 && vy === 0 && !hasOutline(belt);
  const width = goesOn ? ys[1] - ys[0] : tidy(0.1 * Math.min(xs[1] - xs[0], ys[1] - ys[0]), 4);
  const [x, y] = goesOn ? [xs[1], (ys[0] + ys[1]) / 2] : [at(xs, 0.4), at(ys, 0.4)];
  if (goesOn) {
    belt.polygon_m = rectangle(xs, ys);
    for (const feed of feeds) if (feed.edge === "west") feed.y_m ??= [...ys];
    Object.assign(domain, { x_m: [xs[0], tidy(xs[1] + 3.5 * width, 4)], y_m: [ys[0], tidy(ys[1] + 1.5 * width, 4)] });
  }
  return { velocity_m_s: [goesOn ? vx : 0.4, 0], path: { points_m: [[0, 0], [1, 0], [2.5, 1.5], [3.5, 1.5]].map(([i, j]) => [tidy(x + i * width, 4), tidy(y + j * width, 4)]),
    radius_m: [tidy(width, 4), tidy(width, 4)], width_m: tidy(width, 4) } };
}

// A quarter of a ring to the left. It goes on from a belt that runs along the whole line: the belt gets the outline that it has there,
// and the line grows by the curve, over whose end cargo leaves. Else it stands in the middle.
function curve(domain, ids, scenario) {
  const { x_m: xs, y_m: ys } = domain, { belts: [belt, ...others], feeds = [] } = scenario;
  const [vx, vy] = belt.velocity_m_s;
  if (others.length === 0 && vx > 0 && vy === 0 && !hasOutline(belt)) {
    const width = ys[1] - ys[0], inner = tidy(width / 2, 4), outer = tidy(inner + width, 4);
    belt.polygon_m = rectangle(xs, ys);
    for (const feed of feeds) if (feed.edge === "west") feed.y_m ??= [...ys];
    scenario.edges = { ...scenario.edges, north: "outflow" };
    Object.assign(domain, { x_m: [xs[0], tidy(xs[1] + outer, 4)], y_m: [ys[0], tidy(ys[1] + inner, 4)] });
    return { velocity_m_s: [vx, 0], arc: { centre_m: [xs[1], domain.y_m[1]], inner_radius_m: inner, outer_radius_m: outer, from_deg: -90, to_deg: 0 } };
  }
  const room = Math.min(xs[1] - xs[0], ys[1] - ys[0]);
  return { velocity_m_s: [0.4, 0], arc: { centre_m: [at(xs, 0.5), at(ys, 0.9)], inner_radius_m: tidy(0.2 * room, 4), outer_radius_m: tidy(0.45 * room, 4),
    from_deg: -90, to_deg: 0 } };
}

// stem: of the ids of new ones; first: what the list has where nothing is written; makes: [title, make(domain, ids, scenario)], where
// ids(list) are those that can be named; needs: a list that must have something.
const known = {
  belts: { one: "Belt", stem: "belt", first: [{ id: "main", velocity_m_s: [0.395, 0] }],
    makes: [["Belt", belt], ["Curve", curve], ["Path", path]] },
  obstacles: { one: "Plate", stem: "plate", makes: [["Deflector", deflector], ["Guide", guide],
    ["Gate", (domain) => ({ ...plateAcross(domain), present: GATE })], ["Flap", (domain) => ({ ...deflector(domain), motion: FLAP })],
    ["Pusher", (domain) => ({ ...beside(domain), motion: PUSHER(domain) })]] },
  feeds: { one: "Feed", stem: "feed", makes: [["Feed", () => ({ edge: "west", rate_per_s: 5, arrivals: "poisson" })],
    ["Feed on a line", (domain, ids, { belts = [] }) => ({ line_m: beginOf(belts.at(-1)) ?? across(domain, 0.1), rate_per_s: 5, arrivals: "poisson" })]] },
  counters: { one: "Counter", stem: "counter", first: [{ id: "upstream" }],
    makes: [["Counter", ({ x_m: xs }) => ({ x_m: [xs[0], at(xs, 0.5)] })]] },
  photo_eyes: { one: "Photo eye", stem: "eye",
    makes: [["Photo eye", (domain) => ({ line_m: across(domain, 0.6), block_time_s: 0.5, clear_time_s: 0.5 })]] },
  sinks: { one: "Sink", stem: "sink",
    makes: [["Sink", ({ x_m: xs, y_m: ys }) => ({ polygon_m: rectangle([at(xs, 0.7), at(xs, 0.8)], ys) })]] },
  actions: { one: "Rule", needs: "photo_eyes", makes: [["Rule", (_, ids) => ({ when: { photo_eye: ids("photo_eyes")[0], state: "blocked" },
    do: { belt: ids("belts")[0] ?? "main", factor: 0 } })]] },
  merges: { one: "Merge", stem: "merge", needs: "photo_eyes", makes: [["Merge", (_, ids) => ({
    lanes: [0, 1].map((k) => ({ belt: ids("belts").at(k) ?? "main", photo_eye: ids("photo_eyes").at(k) ?? ids("photo_eyes")[0] })) })]] },
};

const singular = (list) => labelOf(list).replace(/s$/, "");

export function kindOf({ list, schema }) {
  return known[list] ?? { one: singular(list), stem: singular(list).toLowerCase(), makes: [[singular(list), () => sample(schema)]] };
}

// The least that a schema asks for.
export function sample(schema, ids = () => []) {
  const form = formOf(schema);
  return Object.fromEntries((form.required ?? []).map((member) => [member, sampleOf(boxOf(member, form.properties[member]), ids)]));
}

export function sampleOf({ kind, member, schema, choices }, ids) {
  const values = { choice: () => choices[0], truth: () => true, text: () => "", id: () => ids(`${member}s`)[0] ?? "", point: () => [0, 0],
    points: () => Array.from({ length: schema.minItems ?? 1 }, () => [0, 0]), list: () => [0], objects: () => [sample(resolve(schema.items), ids)],
    object: () => sample(schema, ids), "one-or-many": () => sample(resolve(schema.oneOf.find((one) => one.type !== "array")), ids), number: () => schema.minimum ?? (schema.exclusiveMinimum === undefined ? 0 : schema.exclusiveMinimum + 1) };
  return values[kind]?.() ?? null;
}

// The id of thing k, as it is written or, without one, as the server names it; rules have none.
export const idOf = (scenario, resolved, list, k) => scenario[list]?.[k]?.id ?? resolved?.[list]?.[k]?.id ?? null;

// Of things; of "kinds" those of the cargo.
export function idsOf(scenario, resolved, list) {
  if (list === "kinds") return [scenario.cargo].flat().map((kind, k) => kind?.id ?? (k === 0 ? "cargo" : `cargo-${k + 1}`));
  return (scenario[list] ?? known[list]?.first ?? []).map((item, k) => item.id ?? idOf(scenario, resolved, list, k)).filter(Boolean);
}

export function freshId(scenario, resolved, list, stem) {
  const taken = new Set(idsOf(scenario, resolved, list));
  for (let n = 1; ; n++) if (!taken.has(`${stem}-${n}`)) return `${stem}-${n}`;
}

function does({ belt, factor, obstacle, turn_deg: turn, shift_m: shift, present, feed, hold }) {
  if (belt !== undefined) return factor === 0 ? `stop ${belt}` : `${belt} ${factor < 0 ? "backwards " : ""}at ${Math.abs(factor)} of its speed`;
  if (turn !== undefined) return `turn ${obstacle} to ${turn}°`;
  if (shift !== undefined) return shift.some((way) => way !== 0) ? `shift ${obstacle} by ${shift.join(", ")} m` : `shift ${obstacle} back`;
  if (feed !== undefined) return `${hold ? "hold" : "release"} ${feed}`;
  return present ? `${obstacle} comes` : `${obstacle} goes`;
}

// Without a limit of its own a release is of one part.
function releases({ lanes, order, parts, time_s: time }) {
  const most = time ? parts : parts ?? 1;
  const limits = [most && `${most} part${most === 1 ? "" : "s"}`, time && `${time} s`].filter(Boolean);
  return `${[lanes].flat().map((lane) => lane?.belt).join(", ")} ${order === "priority" ? "by priority" : "in turn"}, ${limits.join(" or ")} each`;
}

// What a thing is called: a rule in words, a merge with its rule, all others by their ids.
export function nameOfThing(scenario, resolved, list, k) {
  const { when, do: what, delay_s: delay } = scenario[list][k];
  if (when?.kind && what) return `When ${when.photo_eye} ${when.state === "blocked" ? "sees" : "has seen"} ${when.kind}${delay ? `, ${delay} s later` : ""}: ${does(what)}`;
  if (when && what) return `When ${when.photo_eye} is ${when.state}${delay ? ` for ${delay} s` : ""}: ${does(what)}`;
  const id = idOf(scenario, resolved, list, k) ?? String(k + 1);
  return list === "merges" ? `${id}: ${releases(scenario.merges[k])}` : id;
}

// Another id, also where rules, merges, feeds, counters and sinks name it.
export function rename(scenario, list, from, to) {
  const member = list.replace(/s$/, "");
  for (const share of (scenario.feeds ?? []).flatMap(({ cargo }) => cargo ?? [])) if (share[member] === from) share[member] = to;
  for (const sink of scenario.sinks ?? []) if (list === "kinds" && sink.kinds) sink.kinds = sink.kinds.map((id) => (id === from ? to : id));
  for (const counter of scenario.counters ?? []) if (list === "kinds" && counter.kind === from) counter.kind = to;
  for (const lane of (scenario.merges ?? []).flatMap(({ lanes }) => lanes ?? [])) if (lane?.[member] === from) lane[member] = to;
  for (const { when, do: what } of scenario.actions ?? []) {
    for (const part of [when, what]) if (part?.[member] === from) part[member] = to;
  }
}

const AT_SIDE_M = 1e-6;

// A plate whose foot stood at a side of the line, and which is turned, has it there again: it is as long as that takes. old: as it was.
export function keepAtSide(plate, old, { y_m: sides }) {
  const was = plateOf(old);
  const side = was && sides.find((y) => Math.abs(y - was.from[1]) < AT_SIDE_M);
  const length = (was?.to[1] - side) / Math.sin((plate.angle_deg * Math.PI) / 180);
  if (length > 0 && Number.isFinite(length)) plate.length_m = tidy(length);
}

const POINTS = ["end_m", "from_m", "to_m", "pivot_m", "centre_m"];
const ANGLES = ["angle_deg", "from_deg", "to_deg"];
const LISTS = ["path_m", "polygon_m", "line_m", "points_m"];

// The same thing with all its places and directions changed: point([x, y]), vector([x, y]), angle(degrees) and turn(degrees) of
// what it turns by; intervals(name, [from, to]) of its sides along an axis.
function changed(item, { point, vector = (v) => v, angle = (a) => a, turn = (a) => a, interval = (_, pair) => pair }) {
  const round = (pair) => pair.map((value) => tidy(value));
  return Object.fromEntries(Object.entries(item).map(([name, value]) => {
    if (POINTS.includes(name)) return [name, round(point(value))];
    if (LISTS.includes(name)) return [name, value.map((pair) => round(point(pair)))];
    if (name === "x_m" || name === "y_m") return [name, round(interval(name, value))];
    if (name === "velocity_m_s") return [name, round(vector(value))];
    if (ANGLES.includes(name)) return [name, tidy(angle(value))];
    if (name === "turn_deg" && Array.isArray(value)) return [name, value.map(turn)];
    if (name === "shift_m" && Array.isArray(value[0])) return [name, value.map((pair) => round(vector(pair)))];
    if (name === "motion") return [name, changed(value, { point, vector, turn })];
    if (name === "arc" || name === "path") return [name, changed(value, { point, angle })];
    return [name, value];
  }));
}

function placesOf(item) {
  const plate = plateOf(item);
  const pairs = plate ? [plate.from, plate.to] : [...POINTS, ...LISTS].flatMap((name) => (LISTS.includes(name) ? item[name] ?? [] : item[name] ? [item[name]] : []));
  return [...pairs, ...(item.arc ? [item.arc.centre_m] : []), ...(item.path?.points_m ?? []), ...(item.x_m && item.y_m ? [[item.x_m[0], item.y_m[0]], [item.x_m[1], item.y_m[1]]] : [])];
}

// The middle of what it covers, or null where it has no place.
export function middleOf(item) {
  const places = placesOf(item);
  if (places.length === 0) return null;
  return [0, 1].map((axis) => {
    const values = places.map((place) => place[axis]);
    return tidy((Math.min(...values) + Math.max(...values)) / 2);
  });
}

export const movedBy = (item, [dx, dy]) => changed(item, { point: ([x, y]) => [x + dx, y + dy],
  interval: (name, pair) => pair.map((value) => value + (name === "x_m" ? dx : dy)) });

const opposite = { north: "south", south: "north" };

// Across the middle line of the domain along x.
export function mirrored(item, { y_m: [y0, y1] }) {
  const flip = (y) => y0 + y1 - y;
  const made = changed(item, { point: ([x, y]) => [x, flip(y)], vector: ([x, y]) => [x, -y], angle: (a) => -a, turn: (a) => -a,
    interval: (name, [from, to]) => (name === "y_m" ? [flip(to), flip(from)] : [from, to]) });
  return opposite[made.edge] ? { ...made, edge: opposite[made.edge] } : made;
}

// By a right angle to the left about its middle.
export function turned(item) {
  const [cx, cy] = middleOf(item);
  const both = item.x_m && item.y_m;
  const sides = both && { x_m: item.y_m.map((y) => cx - cy + y), y_m: item.x_m.map((x) => cy - cx + x) };
  return changed({ ...item, ...sides }, { point: ([x, y]) => [cx - (y - cy), cy + (x - cx)], vector: ([x, y]) => [-y, x], angle: (a) => a + 90 });
}

// A plate in another of its forms; of other things, what both forms have and the least of the new one.
export function converted(list, item, form, ids) {
  const kept = Object.fromEntries(Object.entries(item).filter(([name]) => form.properties[name]));
  const plate = list === "obstacles" ? plateOf(item) ?? (item.path_m && { from: item.path_m[0], to: item.path_m.at(-1) }) : null;
  if (plate) {
    if (form.properties.path_m) return { ...kept, path_m: [plate.from, plate.to] };
    if (form.properties.from_m) return { ...kept, from_m: plate.from, to_m: plate.to };
    return withPlate(kept, plate);
  }
  return { ...sample({ ...form, oneOf: undefined }, ids), ...kept };
}
