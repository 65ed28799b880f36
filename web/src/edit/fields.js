// The few numbers of a scenario that matter to a planner: one line each. `at` are the pointers whose faults
// belong to the field; `get` and `set` work on a scenario as it was written, and are given the table of goods as well. Those of
// the solvers are folded away.

import { limitFault, readNumber } from "../base/numbers.js";
import { angleOf, plateOf, tidy, turnedTo, withPlate } from "../scenario/plate.js";
import { goodsFields } from "./goods.js";

const LEAST_DEGREES = 10;
const MOST_DEGREES = 170;
const NEAR = 1e-6; // m, or of the value

// The first plate, if it is a straight one across the belt; a guide along it has no opening.
function plateIn(scenario) {
  const plate = plateOf(scenario.obstacles?.[0]);
  const angle = plate ? Math.abs(angleOf(plate)) : 0;
  return angle >= LEAST_DEGREES && angle <= MOST_DEGREES ? plate : null;
}

function setAngle(scenario, angle) {
  scenario.obstacles[0] = { ...withPlate(scenario.obstacles[0], turnedTo(plateIn(scenario), angle)), angle_deg: angle };
}

function speedOf(scenario) {
  const velocity = scenario.belts?.[0]?.velocity_m_s ?? [0.395, 0];
  return tidy(Math.hypot(...velocity), 9);
}

// All belts in proportion, as their directions are. None is stopped: a speed of 0, as one types 0.25, would lose both.
function setSpeed(scenario, speed) {
  const now = speedOf(scenario);
  scenario.belts = (scenario.belts?.length ? scenario.belts : [{ id: "main", velocity_m_s: [0.395, 0] }]).map((belt) => (
    { ...belt, velocity_m_s: (belt.velocity_m_s ?? [0.395, 0]).map((value) => tidy((value * speed) / now)) }));
}

// How far the rectangle that is looked at goes along an axis; what stands on it stays.
function sizeOf(axis) {
  return {
    get: ({ domain }) => (Array.isArray(domain?.[axis]) ? tidy(domain[axis][1] - domain[axis][0]) : null),
    set: (scenario, value) => (scenario.domain = { ...scenario.domain, [axis]: [scenario.domain[axis][0], tidy(scenario.domain[axis][0] + value)] }),
  };
}

function member(section, name, fallback) {
  return {
    get: (scenario) => scenario[section]?.[name] ?? fallback,
    set: (scenario, value) => (scenario[section] = { ...scenario[section], [name]: value }),
  };
}

// A field of the first plate's ends: get(plate, domain), and set(plate, value, domain), which returns another plate. What would
// leave no plate across the belt is refused: the plate's fields would be hidden with it.
function ofPlate(get, set) {
  const moved = ({ obstacles, domain }, value) => withPlate(obstacles[0], set(plateIn({ obstacles }), value, domain));
  const isNear = (plate, domain, value) => Math.abs(get(plate, domain) - value) <= NEAR * Math.max(1, Math.abs(value));
  return {
    get: (scenario) => (plateIn(scenario) && scenario.domain?.y_m ? tidy(get(plateIn(scenario), scenario.domain)) : null),
    set: (scenario, value) => (scenario.obstacles[0] = moved(scenario, value)),
    faultIn: (scenario, value) => {
      const plate = plateIn({ obstacles: [moved(scenario, value)] });
      return plate && isNear(plate, scenario.domain, value) ? "" : `must leave a deflector across the belt, at ${LEAST_DEGREES} to ${MOST_DEGREES} degrees`;
    },
  };
}

// The side that a plate's tip points to, and the way there.
const farSide = ({ from, to }, { y_m: [y0, y1] }) => (to[1] >= from[1] ? [y1, 1] : [y0, -1]);

function openingOf(plate, domain) {
  const [side, way] = farSide(plate, domain);
  return Math.round((side - plate.to[1]) * way * 1e9) / 1e9;
}

// Along the plate, whose foot and angle stay.
function setOpening(plate, opening, domain) {
  const { from, to } = plate;
  const [side, way] = farSide(plate, domain);
  const share = (side - way * opening - from[1]) / (to[1] - from[1]);
  return { from, to: share > 0 ? [from[0] + share * (to[0] - from[0]), side - way * opening] : to };
}

export const fields = [
  { id: "angle", label: "Deflector angle", unit: "°", at: ["/obstacles/0", "/obstacles"], least: LEAST_DEGREES, most: MOST_DEGREES, step: 5,
    hint: "from the direction of x; its tip and the opening stay", get: (scenario) => (plateIn(scenario) ? angleOf(plateIn(scenario)) : null), set: setAngle },
  { id: "opening", label: "Opening", unit: "m", at: [], least: 0, step: 0.01, hint: "from the tip to the far side; the angle stays",
    ...ofPlate(openingOf, setOpening) },
  { id: "tip-x", label: "Tip, x", unit: "m", at: [], step: 0.01, hint: "the foot stays",
    ...ofPlate(({ to }) => to[0], ({ from, to }, x) => ({ from, to: [x, to[1]] })) },
  { id: "foot-x", label: "Foot, x", unit: "m", at: [], step: 0.01, hint: "the tip stays",
    ...ofPlate(({ from }) => from[0], ({ from, to }, x) => ({ from: [x, from[1]], to })) },
  { id: "domain-length", label: "Line, along x", unit: "m", at: ["/domain/x_m"], above: 0, step: 0.1, hint: "what is looked at; what stands there stays", ...sizeOf("x_m") },
  { id: "domain-width", label: "Line, along y", unit: "m", at: ["/domain/y_m"], above: 0, step: 0.05, hint: "the belt’s width, where it fills it", ...sizeOf("y_m") },
  { id: "speed", label: "Belt speed", unit: "m/s", at: ["/belts/0/velocity_m_s"], above: 0, step: 0.005, hint: "of the first belt; others in proportion",
    get: (scenario) => speedOf(scenario) || null, set: setSpeed },
  { id: "rate", label: "Feed", unit: "parts/s", at: ["/feeds/0/rate_per_s"], above: 0, step: 1, hint: "how many parts arrive, of the first feed",
    get: (scenario) => scenario.feeds?.[0]?.rate_per_s, set: (scenario, value) => (scenario.feeds[0].rate_per_s = value) },
  { id: "duration", label: "Duration", unit: "s", at: ["/duration_s"], above: 0, step: 0.5, hint: "simulated time",
    get: (scenario) => scenario.duration_s, set: (scenario, value) => (scenario.duration_s = value) },
  { id: "warmup", label: "Warm-up", unit: "s", at: ["/warmup_s"], least: 0, step: 0.5, hint: "is not counted; shorter than the duration",
    get: (scenario) => scenario.warmup_s, set: (scenario, value) => (scenario.warmup_s = value) },
  ...goodsFields,
  { id: "closure", isSolvers: true, label: "Closure", unit: "", at: ["/macro/closure"], model: "macro",
    choices: [["congested", "congested: packing is held"], ["dispersive", "dispersive (paper)"]], ...member("macro", "closure", "congested") },
  { id: "cell", isSolvers: true, label: "Cell", unit: "m", at: ["/macro/cell_m"], above: 0, step: 0.001, auto: true,
    hint: "edge of a cell of the density; empty: by the size of the parts", ...member("macro", "cell_m", "auto") },
  { id: "macro-step", isSolvers: true, label: "Time step", unit: "s", at: ["/macro/step_s"], above: 0, step: 0.00025, model: "macro", auto: true,
    hint: "empty: the largest stable one",
    get: ({ macro }) => macro?.step_s ?? (macro?.closure === "dispersive" && (macro.cell_m ?? "auto") !== "auto" ? 0.00125 : "auto"),
    set: (scenario, value) => (scenario.macro = { ...scenario.macro, step_s: value }) },
  { id: "integrator", isSolvers: true, label: "Integration", unit: "", at: ["/micro/integrator"], model: "micro",
    choices: [["auto", "chosen: implicit"], ["verlet", "Verlet (paper)"], ["implicit", "implicit, longer steps"]], ...member("micro", "integrator", "auto") },
  { id: "micro-step", isSolvers: true, label: "Time step", unit: "s", at: ["/micro/step_s"], above: 0, step: 0.00001, model: "micro", auto: true,
    hint: "empty: chosen, and stable",
    get: (scenario) => scenario.micro?.step_s ?? (scenario.micro?.integrator === "verlet" ? 1e-5 : "auto"),
    set: (scenario, value) => (scenario.micro = { ...scenario.micro, step_s: value }) },
];

// The fault of a number that is not set in the scenario; the daemon validates the rest.
export function faultOf(field, text, scenario) {
  if (field.choices) return "";
  if (text.trim() === "") return field.auto ? "" : "must be given";
  const { value, fault } = readNumber(text);
  return fault || limitFault(field, value) || (field.faultIn?.(scenario, value) ?? "");
}

// The limits of a field in words.
export function limitsOf({ above, least, most, unit }) {
  const text = (value) => `${value}${unit === "°" ? "°" : unit ? ` ${unit}` : ""}`;
  if (least !== undefined && most !== undefined) return `${text(least)} to ${text(most)}`;
  if (least !== undefined) return `at least ${text(least)}`;
  return above === undefined ? "" : `more than ${text(above)}`;
}
