// A straight plate: its foot (where it starts) and its tip (where it ends), in whichever of the three forms it was written.

import { beltVelocity } from "./geometry.js";

export function tidy(value, digits = 9) {
  return Number(value.toPrecision(digits));
}

const EXACT = 13; // digits with which the foot stays where it was drawn

const radians = (degrees) => (degrees * Math.PI) / 180;

// { from, to } of an obstacle that is one straight plate and does not turn, else null.
export function plateOf(obstacle) {
  if (!obstacle || obstacle.motion) return null;
  const { end_m: end, length_m: length, angle_deg: angle, from_m: from, to_m: to, path_m: path } = obstacle;
  if (end && length > 0) {
    return { from: [end[0] - length * Math.cos(radians(angle)), end[1] - length * Math.sin(radians(angle))], to: end };
  }
  if (from && to) return { from, to };
  return path?.length === 2 ? { from: path[0], to: path[1] } : null;
}

// Degrees from the direction of x.
export function angleOf({ from, to }, digits = 6) {
  return tidy((Math.atan2(to[1] - from[1], to[0] - from[0]) * 180) / Math.PI, digits);
}

// The same obstacle in the form that has an angle, with a plate from here to there.
export function withPlate(obstacle, { from, to }) {
  const { id, end_m, angle_deg, length_m, from_m, to_m, path_m, ...more } = obstacle;
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  return { ...(id ? { id } : {}), end_m: to.map((value) => tidy(value)), angle_deg: angleOf({ from, to }, EXACT),
    length_m: tidy(Math.max(length, 1e-6), EXACT), ...more };
}

// The plate's tip and its extent across the belt, and so the opening, are unchanged; its foot moves.
export function turnedTo({ from, to }, degrees) {
  const across = to[1] - from[1];
  return { from: [to[0] - across / Math.tan(radians(degrees)), from[1]], to };
}

const GUIDE_SINE = 1.745e-3; // of the angle to its belt, 0.1 degrees, up to which a piece is a guide
const JOINED = 8; // pieces on either side of a guide of which it takes the side

// 1: the left side of piece k of a path is upstream, -1: the right one is, 0: the piece is a guide; undefined: there is none.
function sideOf(scenario, path, k) {
  if (k < 0 || k + 1 >= path.length) return undefined;
  const [[ax, ay], [bx, by]] = [path[k], path[k + 1]];
  const [vx, vy] = beltVelocity(scenario, [(ax + bx) / 2, (ay + by) / 2]);
  const cross = (bx - ax) * vy - (by - ay) * vx;
  if (Math.abs(cross) <= GUIDE_SINE * Math.hypot(bx - ax, by - ay) * Math.hypot(vx, vy)) return 0;
  return cross > 0 ? -1 : 1;
}

// Corners of the body of piece k of a plate's path. It lies downstream of the path; that of a guide on the side of the nearest
// piece that is none, else it is centred (core/scene/surroundings.h).
export function bodyOf(scenario, path, k, thickness) {
  let side = sideOf(scenario, path, k);
  for (let m = 1; m <= JOINED && side === 0; m++) side = sideOf(scenario, path, k - m) || sideOf(scenario, path, k + m) || 0;
  const [[ax, ay], [bx, by]] = [path[k], path[k + 1]];
  const length = Math.hypot(bx - ax, by - ay) || 1;
  const left = [-(by - ay) / length, (bx - ax) / length];
  const at = ([x, y], height) => [x + height * left[0], y + height * left[1]];
  const [from, to] = side === 0 ? [-thickness / 2, thickness / 2] : [0, -side * thickness];
  return [at(path[k], from), at(path[k + 1], from), at(path[k + 1], to), at(path[k], to)];
}
