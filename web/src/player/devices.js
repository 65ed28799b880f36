// What moves or changes above the cargo: plates as they stand at a time, belts that are down, and photo eyes with their states.

import { beltOutline } from "../scenario/geometry.js";
import { bodyOf } from "../scenario/plate.js";
import { strokeTwice, writeTwice } from "./scenery.js";

// Where a point of an obstacle is that has turned by degrees about its pivot and is shifted.
function moved({ path_m: path, motion }, { turn: degrees, shift: [dx, dy] }) {
  const [px, py] = motion?.pivot_m ?? path[0];
  const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
  return ([x, y]) => [px + dx + c * (x - px) - s * (y - py), py + dy + s * (x - px) + c * (y - py)];
}

function addPlate(plates, view, scenario, obstacle, state) {
  const { path_m: path, thickness_m: thickness } = obstacle;
  const least = (2 * view.ratio) / view.scale; // a plate is never thinner than two pixels
  const place = moved(obstacle, state);
  for (let k = 0; k + 1 < path.length; k++) {
    bodyOf(scenario, path, k, Math.max(thickness, least)).map(place).forEach(([x, y], c) => (c === 0 ? plates.moveTo(view.x(x), view.y(y)) : plates.lineTo(view.x(x), view.y(y))));
    plates.closePath();
  }
}

// Those that are away are outlines.
function drawPlates(context, view, scenario, states, colors) {
  const [here, away] = [new Path2D(), new Path2D()];
  scenario.obstacles.forEach((obstacle, k) =>
    addPlate(states[k].isPresent ? here : away, view, scenario, obstacle, states[k]));
  context.lineJoin = "round";
  strokeTwice(context, here, { width: 1.5, color: colors.plate, halo: colors.rim }, view.ratio);
  context.fillStyle = colors.plate;
  context.fill(here);
  context.lineWidth = view.ratio;
  context.setLineDash([2 * view.ratio, 3 * view.ratio]);
  context.strokeStyle = colors.plate;
  context.stroke(away);
  context.setLineDash([]);
}

// A dashed beam between two ends; blocked, it has a colour and its word.
function drawEye(context, view, { id, line_m: line }, isBlocked, colors) {
  const { ratio } = view;
  const color = isBlocked ? colors.blocked : colors.light;
  const [beam, ends] = [new Path2D(), new Path2D()];
  line.forEach(([x, y], k) => {
    if (k === 0) beam.moveTo(view.x(x), view.y(y));
    else beam.lineTo(view.x(x), view.y(y));
    ends.rect(view.x(x) - 3 * ratio, view.y(y) - 3 * ratio, 6 * ratio, 6 * ratio);
  });
  strokeTwice(context, beam, { width: isBlocked ? 2.5 : 1.5, color, halo: colors.dark, dash: [4, 4] }, ratio);
  strokeTwice(context, ends, { width: 1, color, halo: colors.dark }, ratio);
  context.fillStyle = color;
  context.fill(ends);
  const [x, y] = line[0][1] > line[1][1] ? line[0] : line[1]; // the upper end
  writeTwice(context, isBlocked ? `${id} blocked` : id, [view.x(x) + 7 * ratio, view.y(y) + 7 * ratio], color, colors.dark, ratio);
}

// The outline of a belt that is down, and by what.
function drawFailed(context, view, { domain: { x_m: [x0, x1], y_m: [y0, y1] } }, belt, failures, colors) {
  const { ratio } = view;
  const corners = beltOutline(belt) ?? [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
  const outline = new Path2D();
  corners.forEach(([x, y], k) => (k === 0 ? outline.moveTo(view.x(x), view.y(y)) : outline.lineTo(view.x(x), view.y(y))));
  outline.closePath();
  strokeTwice(context, outline, { width: 2.5, color: colors.blocked, halo: colors.dark, dash: [8, 5] }, ratio);
  const at = [Math.min(...corners.map(([x]) => view.x(x))) + 7 * ratio, Math.min(...corners.map(([, y]) => view.y(y))) + 7 * ratio];
  writeTwice(context, `${belt.id} down: ${failures.join(", ")}`, at, colors.blocked, colors.dark, ratio);
}

// state: of Equipment.at(). Onto a transparent canvas of the view's size.
export function drawDevices(context, view, scenario, state, colors) {
  context.clearRect(0, 0, view.width, view.height);
  context.save();
  view.clip(context);
  scenario.belts.forEach((belt, k) => state.failures[k].length > 0 && drawFailed(context, view, scenario, belt, state.failures[k], colors));
  drawPlates(context, view, scenario, state.plates, colors);
  context.restore();
  context.save();
  if (!view.isWhole) view.clip(context);
  (scenario.photo_eyes ?? []).forEach((eye, k) => drawEye(context, view, eye, state.eyes[k], colors));
  context.restore();
}
