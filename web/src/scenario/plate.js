// A straight plate: its foot (where it starts) and its tip (where it ends), in whichever of the three forms it was written.

import { beltVelocity } from "./geometry.js";

export function tidy(value, digits = 9) {
  return Number(value.toPrecision(digits));
}

const EXACT = 13; // digits with which the foot stays where it was drawn

const radians = (degrees) => (degrees * Math.PI) / 180;

// { from, to } of an obstacle that is one straight plate and does not move, else null.
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
const JOINED = 8; // pieces from an end, or a guide, that a side is taken from

// Piece k of a path: its middle, the belt's velocity there, and its upstream side: 1 left, -1 right, 0 of a guide; undefined: there
// is none.
function pieceOf(scenario, path, k) {
  if (k < 0 || k + 1 >= path.length) return undefined;
  const [[ax, ay], [bx, by]] = [path[k], path[k + 1]];
  const middle = [(ax + bx) / 2, (ay + by) / 2];
  const belt = beltVelocity(scenario, middle);
  const cross = (bx - ax) * belt[1] - (by - ay) * belt[0];
  const isGuide = Math.abs(cross) <= GUIDE_SINE * Math.hypot(bx - ax, by - ay) * Math.hypot(...belt);
  return { middle, belt, side: isGuide ? 0 : cross > 0 ? -1 : 1 };
}

function sideOf(scenario, path, k) {
  return pieceOf(scenario, path, k)?.side;
}

// The upstream side of a path as a whole, of the pieces at its ends; 0: they are all guides.
function pathSide(scenario, path) {
  const n = path.length - 1;
  const near = (at) => Array.from({ length: JOINED + 1 }, (_, m) => pieceOf(scenario, path, at(m))).find((piece) => piece?.side);
  const [first, last] = [near((m) => m), near((m) => n - 1 - m)];
  if (!first || !last || first.side === last.side) return (first ?? last)?.side ?? 0;
  const ahead = [0, 1].reduce((sum, d) => sum + (last.middle[d] - first.middle[d]) * (first.belt[d] + last.belt[d]), 0);
  return (ahead < 0 ? last : first).side;
}

// Corners of the body of piece k of a plate's path. That of the path lies on one side of it, downstream of the piece at its upstream
// end that is no guide; else that of a guide lies on the side of the nearest such piece, or is centred (core/scene/surroundings.h).
export function bodyOf(scenario, path, k, thickness) {
  let side = pathSide(scenario, path) || sideOf(scenario, path, k);
  for (let m = 1; m <= JOINED && side === 0; m++) side = sideOf(scenario, path, k - m) || sideOf(scenario, path, k + m) || 0;
  const [[ax, ay], [bx, by]] = [path[k], path[k + 1]];
  const length = Math.hypot(bx - ax, by - ay) || 1;
  const left = [-(by - ay) / length, (bx - ax) / length];
  const at = ([x, y], height) => [x + height * left[0], y + height * left[1]];
  const [from, to] = side === 0 ? [-thickness / 2, thickness / 2] : [0, -side * thickness];
  return [at(path[k], from), at(path[k + 1], from), at(path[k + 1], to), at(path[k], to)];
}
