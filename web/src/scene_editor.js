// The belt as it will be, with the plates' ends to be drawn by pointer and by keys. It snaps to a lattice and to the walls.

import { drawDevices } from "./devices.js";
import { h } from "./dom.js";
import { angleOf, plateOf, tidy } from "./plate.js";
import { drawScenery } from "./scenery.js";
import { color, onTheme } from "./theme.js";
import { ViewBox } from "./view_box.js";

const SNAP_M = 0.01;
const FINE_M = 0.001;
const WHOLE = { factor: 1, x: 0.5, y: 0.5 }; // the whole belt is seen
const NEAR_WALL_M = 0.015;
const names = ["text", "muted", "light", "dark", "plate", "rim", "feed", "blocked"];

const snap = (value, step) => tidy(Math.round(value / step) * step, 9);

// Where parts are at the start, as far as the scenario says it by itself.
function places({ positions_m: positions, hexagonal }) {
  if (positions) return positions;
  if (!hexagonal) return [];
  const { rows, columns, first_m: [x0, y0], spacing_m: spacing } = hexagonal;
  return Array.from({ length: rows * columns }, (_, k) => {
    const row = Math.floor(k / columns);
    return [x0 + (k % columns + (row % 2) / 2) * spacing, y0 + row * spacing * (Math.sqrt(3) / 2)];
  });
}

function radiusOf(cargo) {
  const { shape } = Array.isArray(cargo) ? cargo[0] : cargo;
  return shape.radius_m ?? Math.hypot(shape.length_m ?? 0.02, shape.width_m ?? 0.02) / 2;
}

// What can be drawn: { name, at, move([x, y]) -> plate } of a plate in a domain.
function handlesOf(plate, { y_m: [y0, y1] }) {
  const { from, to } = plate;
  const wall = Math.abs(from[1] - y0) < NEAR_WALL_M ? y0 : Math.abs(from[1] - y1) < NEAR_WALL_M ? y1 : null;
  const far = to[1] >= from[1] ? y1 : y0;
  const onWall = ([x, y]) => [x, wall !== null && Math.abs(y - wall) < 4 * NEAR_WALL_M ? wall : y];
  return [
    { name: "foot", at: from, move: (at) => ({ from: onWall(at), to }) },
    { name: "tip", at: to, move: (at) => ({ from, to: at }) },
    // The opening changes along the plate, whose angle stays.
    { name: "opening", at: [to[0], (to[1] + far) / 2], move: ([, y]) => {
      const tip = 2 * y - far;
      const share = to[1] === from[1] ? 1 : (tip - from[1]) / (to[1] - from[1]);
      return { from, to: share > 0.05 ? [tidy(from[0] + share * (to[0] - from[0]), 9), tidy(tip, 9)] : to };
    } },
  ];
}

const words = { foot: ([x, y]) => `x ${x} m, y ${y} m`, tip: ([x, y]) => `x ${x} m, y ${y} m` };

export class SceneEditor {
  // onPlate(k, { from, to }): plate k shall stand there.
  constructor(onPlate) {
    Object.assign(this, { onPlate, handles: new Map() });
    this.canvas = h("canvas");
    this.above = h("canvas");
    this.frame = h("div", { class: "stage-frame scene-frame", role: "group", "aria-label": "The belt from above" }, this.canvas, this.above);
    this.hint = h("p", { class: "hint" }, "Draw a deflector’s foot, tip or opening; arrow keys move what has the focus, with Shift by millimetres.");
    this.element = h("div", { class: "scene" }, h("div", { class: "stage" }, this.frame), this.hint);
    this.observer = new ResizeObserver(() => this.draw());
    this.observer.observe(this.element);
    this.stopTheme = onTheme(() => this.draw());
  }

  dispose() {
    this.observer.disconnect();
    this.stopTheme();
  }

  // written: the scenario as it is edited; resolved: as the server completed it last.
  show(written, resolved) {
    this.plates = (written?.obstacles ?? []).map(plateOf);
    this.scenario = resolved && {
      ...resolved,
      obstacles: resolved.obstacles.map((obstacle, k) => (this.plates[k] ? { ...obstacle, path_m: [this.plates[k].from, this.plates[k].to] } : obstacle)),
    };
    this.draw();
  }

  draw() {
    const width = this.element.clientWidth;
    if (!this.scenario || width === 0) return;
    this.view = new ViewBox(this.scenario.domain, width, Math.max(240, innerHeight * 0.5), Math.min(devicePixelRatio || 1, 2), WHOLE);
    const { view, scenario } = this;
    for (const canvas of [this.canvas, this.above]) {
      Object.assign(canvas, { width: view.width, height: view.height });
      canvas.style.width = `${view.cssWidth}px`;
      canvas.style.height = `${view.cssHeight}px`;
    }
    this.frame.style.width = `${view.cssWidth}px`;
    this.frame.style.height = `${view.cssHeight}px`;
    const colors = Object.fromEntries(names.map((name) => [name, color(`draw-${name}`)]));
    const context = this.canvas.getContext("2d");
    drawScenery(context, view, scenario, colors);
    this.drawCargo(context);
    drawDevices(this.above.getContext("2d"), view, scenario,
      { plates: scenario.obstacles.map(() => ({ turn: 0, isPresent: true })), eyes: (scenario.photo_eyes ?? []).map(() => null) }, colors);
    this.placeHandles();
  }

  // The belt and the parts at the start lie below the scenery.
  drawCargo(context) {
    const { view, scenario } = this;
    const { x, y, width, height } = view.inner;
    context.save();
    context.globalCompositeOperation = "destination-over";
    view.clip(context);
    const parts = new Path2D();
    const radius = Math.max(1, radiusOf(scenario.cargo) * view.scale);
    for (const [px, py] of places(scenario.initial ?? {})) {
      parts.moveTo(view.x(px) + radius, view.y(py));
      parts.arc(view.x(px), view.y(py), radius, 0, 2 * Math.PI);
    }
    context.lineWidth = view.ratio;
    context.strokeStyle = color("draw-part-line");
    context.stroke(parts);
    context.fillStyle = color("draw-part");
    context.fill(parts);
    context.fillStyle = color("draw-belt");
    context.fillRect(x, y, width, height);
    context.restore();
  }

  placeHandles() {
    const seen = new Set();
    this.plates.forEach((plate, k) => {
      if (!plate || !this.scenario.obstacles[k]) return;
      for (const handle of handlesOf(plate, this.scenario.domain)) {
        const key = `${k} ${handle.name}`;
        seen.add(key);
        if (!this.handles.has(key)) this.handles.set(key, this.makeHandle(k, handle.name));
        this.placeHandle(this.handles.get(key), handle, plate, this.scenario.obstacles[k].id);
      }
    });
    for (const [key, { element }] of this.handles) {
      if (seen.has(key)) continue;
      element.remove();
      this.handles.delete(key);
    }
  }

  placeHandle(made, handle, plate, id) {
    const { view } = this;
    made.handle = handle;
    const { element } = made;
    element.style.transform = `translate(${view.x(handle.at[0]) / view.ratio}px, ${view.y(handle.at[1]) / view.ratio}px)`;
    const { y_m: [y0, y1] } = this.scenario.domain;
    const wide = plate.to[1] >= plate.from[1] ? y1 - plate.to[1] : plate.to[1] - y0;
    const said = handle.name === "opening" ? `${tidy(wide, 4)} m` : words[handle.name](handle.at.map((value) => tidy(value, 4)));
    element.title = `${handle.name}: ${said}`;
    element.setAttribute("aria-label", `${id}, ${handle.name}: ${said}, angle ${tidy(angleOf(plate), 4)}°`);
  }

  makeHandle(k, name) {
    const made = { handle: null };
    made.element = h("button", { type: "button", class: "handle", data: { name }, on: {
      pointerdown: (event) => {
        event.preventDefault();
        made.element.focus();
        made.element.setPointerCapture(event.pointerId);
      },
      pointermove: (event) => made.element.hasPointerCapture(event.pointerId) && this.moveTo(k, made.handle, this.placeOf(event), event.shiftKey ? FINE_M : SNAP_M),
      keydown: (event) => this.moveByKey(event, k, made.handle),
    } });
    this.frame.append(made.element);
    return made;
  }

  placeOf(event) {
    const box = this.frame.getBoundingClientRect();
    return this.view.place(event.clientX - box.left, event.clientY - box.top);
  }

  moveByKey(event, k, handle) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!way) return;
    event.preventDefault();
    const step = event.shiftKey ? FINE_M : SNAP_M;
    // The handle of the opening stands in its middle: it moves by half of what the tip does.
    const scale = handle.name === "opening" ? step / 2 : step;
    this.moveTo(k, handle, [handle.at[0] + way[0] * scale, handle.at[1] + way[1] * scale], FINE_M / 2);
  }

  moveTo(k, handle, at, step) {
    const { x_m: [x0, x1], y_m: [y0, y1] } = this.scenario.domain;
    const kept = [Math.min(Math.max(snap(at[0], step), x0), x1), Math.min(Math.max(snap(at[1], step), y0), y1)];
    const plate = handle.move(kept);
    if (Math.hypot(plate.to[0] - plate.from[0], plate.to[1] - plate.from[1]) > 2 * SNAP_M) this.onPlate(k, plate);
  }
}
