// What is conveyed: usual goods by name, from the table of GET /v1/goods, with the numbers that they stand for; each can be
// outranked. Fields of the form as in fields.js, with the table as the last argument of choices, get and set.

import { tidy } from "../scenario/plate.js";

const STEEL = 7850; // kg/m³, of cargo without a mass
const PAPER = { cargo_cargo: 0.15, conveyor_cargo: 1, handling_cargo: 0.19 };
const BESIDE = { conveyor: "acetal", handling: "steel" }; // where nothing is said

export const noGoods = { goods: [], surfaces: [], frictions: [] };

const isOne = ({ cargo }) => cargo !== null && typeof cargo === "object" && !Array.isArray(cargo);
const itemOf = ({ cargo }, table) => table.goods.find(({ name }) => name === cargo.goods);

function shapeOf(scenario, table) {
  const given = scenario.cargo.shape ?? {};
  const own = itemOf(scenario, table)?.shape ?? { type: "cylinder", radius_m: 0.012, height_m: 0.008 };
  return given.type && given.type !== own.type ? given : { ...own, ...given };
}

function massOf(scenario, table) {
  const { type, radius_m: r, length_m: l, width_m: w, height_m: h } = shapeOf(scenario, table);
  const volume = { cylinder: Math.PI * r * r * h, box: l * w * h }[type];
  return scenario.cargo.mass_kg ?? itemOf(scenario, table)?.mass_kg ?? (volume ? tidy(STEEL * volume, 9) : null);
}

const surfaceOf = (scenario, table) => scenario.cargo.surface ?? itemOf(scenario, table)?.surface ?? null;

function frictionOf(scenario, table, pair) {
  const given = scenario.contacts?.[pair]?.friction;
  const own = surfaceOf(scenario, table);
  if (given !== undefined || own === null) return given ?? PAPER[pair];
  const side = pair.split("_")[0];
  const other = side === "cargo" ? own : scenario.surfaces?.[side] ?? BESIDE[side];
  return table.frictions.find(({ a, b }) => (a === own && b === other) || (a === other && b === own))?.friction ?? null;
}

// What followed from other surfaces follows anew.
function forgetFrictions(scenario, pairs) {
  const contacts = { ...scenario.contacts };
  for (const pair of pairs.filter((name) => contacts[name])) {
    const { friction: _, ...rest } = contacts[pair];
    if (Object.keys(rest).length > 0) contacts[pair] = rest;
    else delete contacts[pair];
  }
  if (pairs.includes("handling_cargo")) delete contacts.wall_friction;
  if (Object.keys(contacts).length > 0) scenario.contacts = contacts;
  else delete scenario.contacts;
}

// Goods instead of what the cargo was; without goods their numbers stay.
function setGoods(scenario, name, table) {
  const { goods: _, surface: __, ...cargo } = scenario.cargo;
  if (name === "") {
    scenario.cargo = { ...cargo, shape: shapeOf(scenario, table), mass_kg: massOf(scenario, table) };
    delete scenario.surfaces;
  } else {
    const { shape: _shape, mass_kg: _mass, spin_friction_radius_m: _lever, ...rest } = cargo;
    scenario.cargo = { ...rest, goods: name };
  }
  forgetFrictions(scenario, Object.keys(PAPER));
  // Levers and packing that were worked out for another shape.
  if (scenario.micro) delete scenario.micro.spin_friction_radius_m;
  if (scenario.macro) delete scenario.macro.packing_density_per_m2;
}

function sizeField(id, label, type, member, factor) {
  return { id, label, unit: "m", at: [`/cargo/shape/${member}`], above: 0, step: 0.001, hint: "of a part",
    get(scenario, table) {
      const shape = isOne(scenario) ? shapeOf(scenario, table) : {};
      return type.includes(shape.type) && shape[member] !== undefined ? tidy(shape[member] * factor, 9) : null;
    },
    set: (scenario, value, table) =>
      (scenario.cargo = { ...scenario.cargo, shape: { ...shapeOf(scenario, table), [member]: tidy(value / factor, 9) } }) };
}

function surfaceField(side, label) {
  return { id: `surface-${side}`, label, unit: "", at: [`/surfaces/${side}`], model: "micro",
    hint: "says the friction that is not given", choices: ({ surfaces }) => surfaces.map(({ name, title }) => [name, title]),
    get: (scenario, table) => (isOne(scenario) && surfaceOf(scenario, table) ? scenario.surfaces?.[side] ?? BESIDE[side] : null),
    set(scenario, value) {
      scenario.surfaces = { ...scenario.surfaces, [side]: value };
      forgetFrictions(scenario, [`${side}_cargo`]);
    } };
}

function frictionField(pair, label) {
  return { id: `friction-${pair.split("_")[0]}`, label, unit: "", at: [`/contacts/${pair}`], least: 0, step: 0.01, model: "micro",
    get: (scenario, table) => (isOne(scenario) ? frictionOf(scenario, table, pair) : null),
    set: (scenario, value) => (scenario.contacts = { ...scenario.contacts, [pair]: { ...scenario.contacts?.[pair], friction: value } }) };
}

export const goodsFields = [
  { id: "goods", label: "Goods", unit: "", at: ["/cargo/goods", "/cargo"], hint: "size, mass and frictions; each can be changed",
    choices: ({ goods }) => [["", "by their numbers"], ...goods.map(({ name, title }) => [name, title])],
    get: (scenario) => (isOne(scenario) ? scenario.cargo.goods ?? "" : null), set: setGoods },
  sizeField("diameter", "Diameter", ["cylinder"], "radius_m", 2),
  sizeField("length", "Length", ["box"], "length_m", 1),
  sizeField("width", "Width", ["box"], "width_m", 1),
  sizeField("height", "Height", ["cylinder", "box"], "height_m", 1),
  { id: "mass", label: "Mass", unit: "kg", at: ["/cargo/mass_kg"], above: 0, step: 0.01, hint: "of a part",
    get: (scenario, table) => (isOne(scenario) ? massOf(scenario, table) : null),
    set: (scenario, value) => (scenario.cargo = { ...scenario.cargo, mass_kg: value }) },
  surfaceField("conveyor", "Belts are of"),
  surfaceField("handling", "Plates and walls are of"),
  frictionField("conveyor_cargo", "Friction on the belt"),
  frictionField("handling_cargo", "Friction at plates"),
  frictionField("cargo_cargo", "Friction between parts"),
];
