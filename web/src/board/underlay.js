// A drawing under the line, from a DXF or SVG file: placed and scaled, shown thin beneath what stands on the line. Its lines are gone
// through one by one, and become belts and guides.

import { h, iconButton } from "../base/dom.js";
import { readNumber, writeNumber } from "../base/numbers.js";
import { fileButton } from "../compare/measured.js";
import { tidy } from "../scenario/plate.js";

const FILE_MAX = 20e6; // bytes
const KEPT_MAX = 400e3; // characters in the browser
const DIGITS = 4; // of a metre

const sizeOf = (lines, axis) => {
  let [low, high] = [Infinity, -Infinity];
  for (const line of lines) for (const point of line) [low, high] = [Math.min(low, point[axis]), Math.max(high, point[axis])];
  return [low, high];
};

const isClosed = (line) => line.length > 3 && line[0].every((value, axis) => Math.abs(value - line.at(-1)[axis]) < 1e-6);

// { name, lines, metres }: lines in units of the file from its lower left corner; metres: of a unit, such that it is as long as the
// line where the file does not say.
async function readDrawing(file, [west, east]) {
  if (file.size > FILE_MAX) throw new Error(`It has more than ${FILE_MAX / 1e6} MB.`);
  const { linesOfDxf, linesOfSvg } = await import("./drawing_files.js");
  const read = /\.svg$/i.test(file.name) ? linesOfSvg : linesOfDxf;
  const { lines: found, metres } = read(await file.text());
  const lines = found.filter((line) => line.length > 1 && line.flat().every(Number.isFinite));
  if (lines.length === 0) throw new Error("There are no lines in it.");
  const [[x0, x1], [y0, y1]] = [sizeOf(lines, 0), sizeOf(lines, 1)];
  // What turns and shifts leave of rounding is far below this, and 0 again.
  const grain = 1e-9 * (Math.max(x1 - x0, y1 - y0) || 1);
  const onGrain = (value) => tidy(Math.round(value / grain) * grain, 9);
  return { name: file.name, metres: metres ?? tidy((east - west) / (x1 - x0 || 1), 9),
    lines: lines.map((line) => line.map(([x, y]) => [onGrain(x - x0), onGrain(y - y0)])) };
}

export class Underlay {
  // onChange(): it is placed anew, or another line of it is looked at; onTake(list, item): a line becomes a thing; onSize(x_m, y_m): the domain becomes as large.
  constructor({ onChange, onTake, onSize }) {
    Object.assign(this, { onChange, onTake, onSize, drawing: null, domain: null, k: 0 });
    this.fault = h("small", { class: "fault", role: "alert", hidden: true });
    this.stand = h("div", {});
    this.element = h("div", { class: "underlay" }, this.stand, this.fault);
    this.rebuild();
  }

  // drawing: { name, lines, metres, at }, or null.
  begin(drawing) {
    Object.assign(this, { drawing: drawing ?? null, k: 0 });
    this.rebuild();
  }

  // What a line keeps of it in the browser: too large a drawing is opened again.
  get kept() {
    return JSON.stringify(this.drawing).length <= KEPT_MAX ? this.drawing : null;
  }

  async open(file) {
    try {
      this.begin({ ...(await readDrawing(file, this.domain.x_m)), at: [this.domain.x_m[0], this.domain.y_m[0]] });
      this.say("");
    } catch (error) {
      this.say(`${file.name}: ${error.message}`);
    }
    this.onChange();
  }

  say(text) {
    this.fault.textContent = text;
    this.fault.hidden = text === "";
  }

  placed(line) {
    const { metres, at } = this.drawing;
    return line.map((point) => point.map((value, axis) => tidy(at[axis] + metres * value, DIGITS)));
  }

  rebuild() {
    const chooser = (text) => fileButton(text, (file) => this.open(file), { accept: ".dxf,.svg,image/svg+xml" });
    if (!this.drawing) return this.stand.replaceChildren(chooser("Drawing under the line …"));
    const { name, metres, at } = this.drawing;
    const box = (label, unit, value, take) => {
      const input = h("input", { type: "text", inputmode: "decimal", autocomplete: "off", on: { input: () => {
        const read = readNumber(input.value);
        this.say(read.fault && `${label} ${read.fault}`);
        if (read.fault) return;
        take(read.value);
        this.showLine();
        this.onChange();
      } } });
      input.value = writeNumber(value);
      return h("label", { class: "field" }, h("span", {}, label), h("span", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)));
    };
    this.said = h("span", { role: "status" });
    const button = (text, onClick) => h("button", { type: "button", on: { click: onClick } }, text);
    this.beltButton = button("As a belt", () => this.takeBelt());
    this.stand.replaceChildren(h("fieldset", {}, h("legend", {}, `Drawing ${name}`),
      h("div", { class: "fields" }, box("A unit of it is", "m", metres, (value) => (this.drawing.metres = value)),
        box("Its left edge is at x =", "m", at[0], (value) => (at[0] = value)), box("Its lower edge is at y =", "m", at[1], (value) => (at[1] = value))),
      h("div", { class: "palette" }, iconButton("previous", "The line of it before", () => this.step(-1)), iconButton("next", "The next line of it", () => this.step(1)), this.said),
      h("div", { class: "palette" }, this.beltButton, button("As a guide", () => this.takeGuide()), button("Line as large as the drawing", () => this.takeSize()),
        chooser("Another drawing …"), button("Without the drawing", () => this.remove()))));
    this.showLine();
  }

  get line() {
    return this.drawing.lines[this.k];
  }

  showLine() {
    const { line } = this;
    const [[x0, x1], [y0, y1]] = [0, 1].map((axis) => sizeOf([this.placed(line)], axis));
    this.said.textContent = `${this.k + 1} of ${this.drawing.lines.length} lines: ${isClosed(line) ? "an outline" : `${line.length} points`}, ${tidy(x1 - x0, 3)} × ${tidy(y1 - y0, 3)} m`;
    this.beltButton.disabled = !isClosed(line);
  }

  step(by) {
    const n = this.drawing.lines.length;
    this.k = (this.k + by + n) % n;
    this.showLine();
    this.onChange();
  }

  takeBelt() {
    this.onTake("belts", { velocity_m_s: [0.4, 0], polygon_m: this.placed(this.line).slice(0, -1) });
  }

  takeGuide() {
    const points = this.placed(this.line);
    this.onTake("obstacles", points.length === 2 ? { from_m: points[0], to_m: points[1] } : { path_m: points });
  }

  takeSize() {
    const all = this.drawing.lines.map((line) => this.placed(line));
    this.onSize(sizeOf(all, 0), sizeOf(all, 1));
  }

  remove() {
    this.begin(null);
    this.onChange();
  }

  // Thin, and the line that is looked at thick.
  draw(context, view, { muted, feed }) {
    if (!this.drawing) return;
    context.save();
    view.clip(context);
    for (const line of this.drawing.lines) {
      const path = new Path2D();
      for (const [x, y] of this.placed(line)) path.lineTo(view.x(x), view.y(y));
      context.strokeStyle = line === this.line ? feed : muted;
      context.lineWidth = (line === this.line ? 3 : 1) * view.ratio;
      context.stroke(path);
    }
    context.restore();
  }
}
