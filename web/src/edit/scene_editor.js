// The belt as it will be, on which plates, counters and feeds are drawn by pointer and by keys. It snaps to a lattice and to
// the walls.

import { h } from "../base/dom.js";
import { color, onTheme } from "../base/theme.js";
import { drawDevices } from "../player/devices.js";
import { PartsLayer } from "../player/parts_layer.js";
import { drawScenery } from "../player/scenery.js";
import { bodyStyle } from "../player/stage.js";
import { ViewBox } from "../player/view_box.js";
import { cargoOf } from "../scenario/cargo.js";
import { tidy } from "../scenario/plate.js";
import { asWritten, handlesOf } from "./scene_handles.js";

const SNAP_M = 0.01;
const FINE_M = 0.001;
const WHOLE = { factor: 1, x: 0.5, y: 0.5 }; // the whole belt is seen
const names = ["text", "muted", "light", "dark", "plate", "rim", "feed", "blocked"];

const snap = (value, step) => tidy(Math.round(value / step) * step, 9);

const COLUMNS = ["kind", "x_m", "y_m", "heading_rad", "vx_m_s", "vy_m_s"];

// A picture for a PartsLayer of the parts at the start, at rest.
function pictureOf(parts) {
  const data = Float64Array.from(parts.flatMap((part) => COLUMNS.map((column) => part[column] ?? 0)));
  return { frame: { shape: [parts.length, COLUMNS.length], data }, next: null, share: 0, gap: 0 };
}

export class SceneEditor {
  // underlay: a drawing that is shown beneath it, once it is given. onChange(set, key): what was drawn by this handle goes into the scenario by set(scenario); onChoose(list, k): a handle of this thing has the focus.
  constructor(onChange, onChoose = () => {}) {
    Object.assign(this, { onChange, onChoose, handles: new Map(), underlay: null });
    this.field = h("canvas");
    this.scenery = h("canvas");
    this.devices = h("canvas");
    this.frame = h("div", { class: "stage-frame scene-frame", role: "group", "aria-label": "The belt from above" }, this.field, this.scenery, this.devices);
    this.hint = h("p", { class: "hint" }, "Draw a deflector’s foot, tip or opening, a counter’s sides, a feed’s ends; arrow keys move what has the focus, with Shift by millimetres.");
    this.element = h("div", { class: "scene" }, h("div", { class: "stage" }, this.frame), this.hint);
    this.observer = new ResizeObserver(() => this.draw());
    this.observer.observe(this.element);
    this.stopTheme = onTheme(() => this.draw());
  }

  dispose() {
    this.observer.disconnect();
    this.stopTheme();
  }

  // written: the scenario as it is edited; validation: the server's last one, with the parts at the start; chosen: { list, k } of
  // the thing that has all its handles, or null.
  show(written, validation, chosen = null) {
    const isShown = written && validation;
    this.scenario = isShown ? asWritten(written, validation.resolved) : null;
    this.drawable = isShown ? handlesOf(written, validation.resolved, chosen) : [];
    if (isShown && validation !== this.validation) {
      this.layer = new PartsLayer(COLUMNS, cargoOf(validation.resolved), []);
      this.picture = pictureOf(validation.parts);
      this.validation = validation;
    }
    this.draw();
  }

  draw() {
    const width = this.element.clientWidth;
    if (!this.scenario || width === 0) return;
    this.view = new ViewBox(this.scenario.domain, width, Math.max(240, innerHeight * 0.5), Math.min(devicePixelRatio || 1, 2), WHOLE);
    const { view, scenario } = this;
    for (const canvas of [this.field, this.scenery, this.devices]) {
      Object.assign(canvas, { width: view.width, height: view.height });
      canvas.style.width = `${view.cssWidth}px`;
      canvas.style.height = `${view.cssHeight}px`;
    }
    this.frame.style.width = `${view.cssWidth}px`;
    this.frame.style.height = `${view.cssHeight}px`;
    const colors = Object.fromEntries(names.map((name) => [name, color(`draw-${name}`)]));
    this.drawCargo(this.field.getContext("2d"));
    this.underlay?.draw(this.field.getContext("2d"), view, colors);
    drawScenery(this.scenery.getContext("2d"), view, scenario, colors);
    drawDevices(this.devices.getContext("2d"), view, scenario,
      { plates: scenario.obstacles.map(() => ({ turn: 0, shift: [0, 0], isPresent: true })), eyes: (scenario.photo_eyes ?? []).map(() => null),
        failures: scenario.belts.map(() => []) }, colors);
    this.placeHandles();
  }

  drawCargo(context) {
    const { view } = this;
    const { x, y, width, height } = view.inner;
    context.save();
    view.clip(context);
    context.fillStyle = color("draw-belt");
    context.fillRect(x, y, width, height);
    this.layer.draw(context, view, this.picture, bodyStyle());
    context.restore();
  }

  // Each is made once, so that the focus and the pointer stay with it.
  placeHandles() {
    const { view } = this;
    const keys = new Set(this.drawable.map(({ key }) => key));
    for (const [key, { element }] of this.handles) {
      if (keys.has(key)) continue;
      element.remove();
      this.handles.delete(key);
    }
    for (const handle of this.drawable) {
      if (!this.handles.has(handle.key)) this.handles.set(handle.key, this.makeHandle(handle.kind));
      const made = this.handles.get(handle.key);
      made.handle = handle;
      made.element.style.transform = `translate(${view.x(handle.at[0]) / view.ratio}px, ${view.y(handle.at[1]) / view.ratio}px)`;
      made.element.title = handle.said;
      made.element.setAttribute("aria-label", handle.said);
    }
  }

  makeHandle(kind) {
    const made = { handle: null };
    made.element = h("button", { type: "button", class: "handle", data: { kind }, on: {
      pointerdown: (event) => {
        event.preventDefault();
        made.element.focus();
        made.element.setPointerCapture(event.pointerId);
      },
      pointermove: (event) => made.element.hasPointerCapture(event.pointerId) && this.moveTo(made.handle, this.placeOf(event), event.shiftKey ? FINE_M : SNAP_M),
      keydown: (event) => this.moveByKey(event, made.handle),
      focus: () => this.onChoose(...made.handle.thing),
    } });
    this.frame.append(made.element);
    return made;
  }

  placeOf(event) {
    const box = this.frame.getBoundingClientRect();
    return this.view.place(event.clientX - box.left, event.clientY - box.top);
  }

  moveByKey(event, handle) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!way) return;
    event.preventDefault();
    const by = (event.shiftKey ? FINE_M : SNAP_M) * handle.step;
    this.moveTo(handle, handle.at.map((value, axis) => value + way[axis] * by), FINE_M / 2);
  }

  moveTo(handle, at, step) {
    const { x_m, y_m } = this.scenario.domain;
    const kept = [x_m, y_m].map(([low, high], axis) => Math.min(Math.max(snap(at[axis], step), low), high));
    this.onChange((scenario) => handle.write(scenario, kept), handle.key);
  }
}
