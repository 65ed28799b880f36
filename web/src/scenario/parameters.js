// What a scenario says, parameter by parameter, in the words of a planner: first those that are usually varied, then every
// other member by the words of its pointer. Works on scenarios as they were written and as the API resolved them.

import { quantity } from "../base/format.js";
import { angleOf, plateOf } from "./plate.js";

const RANKED = /^\/(name|duration_s|belts\/\d+\/velocity_m_s|feeds\/\d+\/rate_per_s)$/;
const PLATE = /^\/obstacles\/(\d+)\/(path_m|from_m|to_m|end_m|angle_deg|length_m)$/;
const UNITS = [["_per_m2", "/m²"], ["_per_h", "/h"], ["_per_s", "/s"], ["_m_s2", "m/s²"], ["_m_s", "m/s"], ["_deg", "°"], ["_kg", "kg"], ["_pa", "Pa"],
  ["_m", "m"], ["_s", "s"]];
const UNSAID = new Set(["obstacles", "belts", "feeds", "counters", "photo_eyes", "shape", "hexagonal", "random", "output"]);
const SAID = {
  "/macro/cell_m": "cell", "/macro/closure": "closure", "/macro/mollifier_per_m2": "mollifier", "/macro/dispersion_m_s": "dispersion speed",
  "/cargo/goods": "goods", "/micro/integrator": "integrator", "/contacts/handling_cargo/friction": "friction at plates and walls",
  "/contacts/wall_friction": "friction at walls", "/contacts/conveyor_cargo/friction": "friction on the belt", "/contacts/cargo_cargo/friction": "friction between parts",
};

// The pointers of members that have words of their own, by these words.
export const pointersOfLabels = Object.fromEntries(Object.entries(SAID).map(([pointer, label]) => [label, pointer]));

// [the end of a member's name that says its unit, the unit]
export function unitOf(name) {
  return UNITS.find(([end]) => name.endsWith(end)) ?? ["", ""];
}

// "75°", "0.5 m/s", "yes", "0.75, 0.5 m"; null: the list is too long to be said.
export function valueText(value, unit = "") {
  if (value === undefined) return "none";
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (Array.isArray(value)) {
    const isShort = value.length <= 3 && value.every((item) => typeof item === "number");
    return isShort ? withUnit(value.map((item) => quantity(item, "", 4)).join(", "), unit) : null;
  }
  if (typeof value !== "number") return String(value);
  return withUnit(quantity(value, "", 4), unit);
}

function withUnit(text, unit) {
  if (unit === "") return text;
  return unit === "°" ? `${text}°` : `${text} ${unit}`;
}

// Of several members of a kind each one is called by its id.
function called(items, k, only) {
  return items.length === 1 ? only : `${items[k].id ?? k + 1} ${only}`;
}

// Where a plate meets the belt's side, however far it reaches beyond it, in whole micrometres.
function footOf({ from: [, y] }, { y_m: [low, high] = [-Infinity, Infinity] } = {}) {
  return Math.round(Math.min(Math.max(y, low), high) * 1e6) / 1e6 + 0;
}

function ofPlates({ obstacles = [], domain }) {
  return obstacles.flatMap((obstacle, k) => {
    const plate = plateOf(obstacle);
    if (!plate) return [];
    const at = (what, value, member, unit) =>
      ({ pointer: `/obstacles/${k}/${member}`, label: called(obstacles, k, what), unit, value, isUsual: true });
    return [at("angle", angleOf(plate), "angle_deg", "°"), at("tip", plate.to, "end_m", "m"), at("foot at y", footOf(plate, domain), "from_m/1", "m")];
  });
}

function ofBelts(belts) {
  return belts.flatMap((belt, k) => {
    const [vx, vy] = belt.velocity_m_s ?? [0.395, 0];
    const pointer = `/belts/${k}/velocity_m_s`;
    const direction = vx === 0 && vy === 0 ? 0 : (Math.atan2(vy, vx) * 180) / Math.PI;
    return [{ pointer, label: called(belts, k, "belt speed"), unit: "m/s", value: Math.hypot(vx, vy), isUsual: true },
      { pointer, label: called(belts, k, "belt direction"), unit: "°", value: direction, isUsual: true }];
  });
}

function ofFeeds(feeds) {
  return feeds.flatMap((feed, k) => (feed.rate_per_s === undefined ? [] : [{ pointer: `/feeds/${k}/rate_per_s`,
    label: called(feeds, k, "feed"), unit: "parts/s", value: feed.rate_per_s, isUsual: true }]));
}

// The words and the unit of a member, by the names on its way.
function wordsOf(pointer, scenario) {
  const said = [];
  let item = scenario;
  for (const name of pointer.slice(1).split("/")) {
    item = item?.[name];
    if (/^\d+$/.test(name)) said.push(item?.id ?? String(Number(name) + 1));
    else if (!UNSAID.has(name)) said.push(name);
  }
  const [suffix, unit] = unitOf(pointer);
  const last = said.pop() ?? "";
  const words = [...said, suffix ? last.slice(0, -suffix.length) : last].join(" ").replaceAll("_", " ");
  return { label: SAID[pointer] ?? words, unit };
}

const isListOfObjects = (value) => Array.isArray(value) && typeof value[0] === "object" && !Array.isArray(value[0]);
const isPlain = (value) => value === null || typeof value !== "object" || (Array.isArray(value) && !isListOfObjects(value));

function addLeaves(found, value, pointer) {
  if (isPlain(value)) found.push([pointer, value]);
  else for (const [name, item] of Object.entries(value)) addLeaves(found, item, `${pointer}/${name}`);
}

// [{ pointer, label, unit, value, isUsual }], the usual ones first. A label is said once.
export function parametersOf(scenario) {
  const { obstacles = [], belts = [], feeds = [] } = scenario;
  const usual = [...ofPlates(scenario), ...ofBelts(belts), ...ofFeeds(feeds),
    { pointer: "/duration_s", label: "duration", unit: "s", value: scenario.duration_s, isUsual: true }];
  const leaves = [];
  addLeaves(leaves, scenario, "");
  const isSaid = (pointer) => RANKED.test(pointer) || (PLATE.test(pointer) && plateOf(obstacles[PLATE.exec(pointer)[1]]) !== null);
  const others = leaves.filter(([pointer]) => !isSaid(pointer))
    .map(([pointer, value]) => ({ pointer, value, isUsual: false, ...wordsOf(pointer, scenario) }));
  return [...usual, ...others];
}

const ENDS = { from_m: "foot", to_m: "tip", end_m: "tip" };

// { label, unit } of what a pointer names, which may be part of a member's list.
export function parameterAt(pointer, scenario) {
  const usual = parametersOf(scenario).find((parameter) => parameter.isUsual && parameter.pointer === pointer);
  if (usual) return usual;
  const [, k, end, axis] = /^\/obstacles\/(\d+)\/(from_m|to_m|end_m)\/([01])$/.exec(pointer) ?? [];
  if (end) return { label: called(scenario.obstacles, Number(k), `${ENDS[end]} ${"xy"[axis]}`), unit: "m" };
  const [, belt, along] = /^\/belts\/(\d+)\/velocity_m_s\/([01])$/.exec(pointer) ?? [];
  if (belt) {
    const isOblique = scenario.belts[belt].velocity_m_s?.every((value) => value !== 0);
    return { label: called(scenario.belts, Number(belt), isOblique ? `belt speed along ${"xy"[along]}` : "belt speed"), unit: "m/s" };
  }
  return wordsOf(pointer, scenario);
}
