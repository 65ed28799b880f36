// A straight plate: its foot (where it starts) and its tip (where it ends), in whichever of the three forms it was written.

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
