// What of a scenario a study can vary, from where to where, and how the scenario is written for it.

import { stemOf } from "../scenario/differences.js";
import { parameterAt, parametersOf } from "../scenario/parameters.js";
import { angleOf, plateOf, tidy, withPlate } from "../scenario/plate.js";

const radians = (degrees) => (degrees * Math.PI) / 180;
const around = (value) => [0.7, 1.3].map((share) => tidy(value * share, 2)).sort((a, b) => a - b);

// A plate that stands at the wall stays there: it is made so long that its foot does not leave it at any of the angles and tips.
function writePlate(scenario, k, { from, to }, valuesOf) {
  const plate = withPlate(scenario.obstacles[k], { from, to });
  const wall = scenario.domain?.y_m?.[0] ?? from[1];
  const isAtWall = Math.abs(from[1] - wall) < 1e-6;
  const angles = valuesOf(`/obstacles/${k}/angle_deg`) ?? [angleOf({ from, to })];
  const tips = valuesOf(`/obstacles/${k}/end_m/1`) ?? [to[1]];
  const least = Math.max(...angles.flatMap((angle) => tips.map((tip) => (tip - from[1]) / Math.sin(radians(angle)))));
  scenario.obstacles[k] = isAtWall ? { ...plate, length_m: tidy(Math.max(plate.length_m, least)) } : plate;
}

function ofPlate(scenario, k) {
  const plate = plateOf(scenario.obstacles[k]);
  if (!plate) return [];
  const [x, y] = plate.to;
  const who = scenario.obstacles.length === 1 ? "" : `${scenario.obstacles[k].id ?? k + 1} `;
  const at = (name, label, unit, value, range) => ({ pointer: `/obstacles/${k}/${name}`, label: `${who}${label}`, unit, value, range,
    write: (copy, valuesOf) => writePlate(copy, k, plate, valuesOf) });
  return [
    at("angle_deg", "angle", "°", angleOf(plate), [45, 90]),
    at("end_m/1", "tip y", "m", y, [tidy(y - 0.05), tidy(y + 0.05)]),
    at("end_m/0", "tip x", "m", x, [tidy(x - 0.1), tidy(x + 0.1)]),
  ];
}

function member(pointer, label, unit, value) {
  return typeof value === "number" && value !== 0 ? [{ pointer, label, unit, value, range: around(value), write: () => {} }] : [];
}

const more = ["/contacts/handling_cargo/friction", "/contacts/conveyor_cargo/friction", "/contacts/cargo_cargo/friction",
  "/macro/mollifier_per_m2", "/macro/dispersion_m_s"];

function valueAt(scenario, pointer) {
  return pointer.slice(1).split("/").reduce((item, name) => item?.[name], scenario);
}

// Writes a number into a scenario whose other members may stay with their defaults.
function writeAt(scenario, pointer, value) {
  const names = pointer.slice(1).split("/");
  const last = names.pop();
  let item = scenario;
  for (const name of names) item = item[name] ??= {};
  item[last] = value;
}

// [{ pointer, label, unit, value, range, write(copy, valuesOf) }]. resolved: the same scenario with its defaults, or null.
export function studyParameters(scenario, resolved) {
  const { obstacles = [], belts = [], feeds = [] } = scenario;
  const others = more.flatMap((pointer) => {
    const { label, unit } = parameterAt(pointer, scenario);
    const value = valueAt(scenario, pointer) ?? valueAt(resolved ?? {}, pointer);
    return member(pointer, label, unit, value).map((item) => ({ ...item, write: (copy) => writeAt(copy, pointer, value) }));
  });
  return [
    ...obstacles.flatMap((_, k) => ofPlate(scenario, k)),
    ...belts.flatMap(({ velocity_m_s: velocity = [] }, k) => velocity.flatMap((value, axis) => {
      const pointer = `/belts/${k}/velocity_m_s/${axis}`;
      const { label, unit } = parameterAt(pointer, scenario);
      return member(pointer, label, unit, value);
    })),
    ...belts.flatMap(({ id, incline_deg: incline }, k) =>
      incline ? member(`/belts/${k}/incline_deg`, belts.length === 1 ? "belt incline" : `${id ?? k + 1} belt incline`, "°", incline) : []),
    ...feeds.flatMap(({ id, rate_per_s: rate }, k) =>
      member(`/feeds/${k}/rate_per_s`, feeds.length === 1 ? "feed" : `${id ?? k + 1} feed`, "parts/s", rate)),
    ...others,
  ];
}

// What names say of the list that a number is in: of a component of a belt's velocity, its speed and direction.
const labelsAbove = (pointer, scenario) => parametersOf(scenario).filter((one) => pointer.startsWith(`${one.pointer}/`)).map(({ label }) => label);

// The scenario as a study of these parameters wants it; its name, which all trials have, does not say them.
// varied: [{ parameter, values }], with the values, or the ends of the range, that are tried.
export function baseFor(scenario, varied) {
  const copy = structuredClone(scenario);
  const valuesOf = (pointer) => varied.find(({ parameter }) => parameter.pointer === pointer)?.values;
  for (const { parameter } of varied) parameter.write(copy, valuesOf);
  if (copy.name) copy.name = stemOf(copy.name, varied.flatMap(({ parameter }) => [parameter.label, ...labelsAbove(parameter.pointer, scenario)]));
  return copy;
}
