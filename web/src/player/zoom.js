// What is seen of the belts: the whole, or a part that buttons, keys, the wheel with Ctrl and dragging choose; the same part on
// all stages under a clock.

import { h, iconButton } from "../base/dom.js";

const MOST = 16;
const STEP = 1.5;
const MOVE = 0.2; // of what is seen, by a key

// A centre that keeps what is seen within the domain.
function within(centre, factor) {
  const half = 0.5 / factor;
  return Math.min(Math.max(centre, half), 1 - half);
}

export class Zoom {
  constructor(onChange) {
    Object.assign(this, { onChange, factor: 1, x: 0.5, y: 0.5 });
    this.wider = iconButton("minus", "Zoom out (−)", () => this.by(1 / STEP), { class: "round" });
    this.whole = h("button", { type: "button", title: "Whole belt (0)", on: { click: () => this.set(1, 0.5, 0.5) } }, "Whole belt");
    this.element = h("div", { class: "zoom", role: "group", "aria-label": "Zoom" }, this.wider,
      iconButton("add", "Zoom in (+)", () => this.by(STEP), { class: "round" }), this.whole);
    this.showButtons();
  }

  // "2.25,0.5,0.7", for the address; "" is the whole.
  text() {
    return this.factor === 1 ? "" : [this.factor, this.x, this.y].map((value) => Number(value.toFixed(4))).join(",");
  }

  read(text) {
    const [factor, x, y] = (text ?? "").split(",").map(Number);
    if ([factor, x, y].every(Number.isFinite)) this.set(factor, x, y);
  }

  set(factor, x, y) {
    this.factor = Math.min(Math.max(factor, 1), MOST);
    if (this.factor < 1.01) this.factor = 1;
    this.x = within(x, this.factor);
    this.y = within(y, this.factor);
    this.showButtons();
    this.onChange();
  }

  // at: what stays where it is, as shares of what is seen, by default the middle.
  by(times, [u, v] = [0.5, 0.5]) {
    const factor = Math.min(Math.max(this.factor * times, 1), MOST);
    const [px, py] = [this.x + (u - 0.5) / this.factor, this.y + (v - 0.5) / this.factor];
    this.set(factor, px - (u - 0.5) / factor, py - (v - 0.5) / factor);
  }

  // Moves what is seen, by shares of it.
  move(dx, dy) {
    this.set(this.factor, this.x + dx / this.factor, this.y + dy / this.factor);
  }

  showButtons() {
    const isWhole = this.factor === 1;
    this.wider.disabled = this.whole.disabled = isWhole;
  }

  // view(): the ViewBox of what the frame shows.
  attach(frame, view) {
    const sharesOf = (event) => {
      const { inner, ratio } = view();
      const box = frame.getBoundingClientRect();
      return [((event.clientX - box.left) * ratio - inner.x) / inner.width, 1 - ((event.clientY - box.top) * ratio - inner.y) / inner.height];
    };
    let from = null;
    frame.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      this.by(Math.exp(-event.deltaY / 200), sharesOf(event));
    }, { passive: false });
    frame.addEventListener("dblclick", (event) => this.by(STEP, sharesOf(event)));
    frame.addEventListener("pointerdown", (event) => {
      if (this.factor === 1) return;
      frame.setPointerCapture(event.pointerId);
      from = sharesOf(event);
    });
    frame.addEventListener("pointermove", (event) => {
      if (from === null) return;
      const to = sharesOf(event);
      this.move(from[0] - to[0], from[1] - to[1]);
      from = to;
    });
    for (const type of ["pointerup", "pointercancel"]) frame.addEventListener(type, () => (from = null));
  }

  // Whether a key was one of these.
  take({ key }) {
    const actions = { "+": () => this.by(STEP), "=": () => this.by(STEP), "-": () => this.by(1 / STEP), 0: () => this.set(1, 0.5, 0.5),
      a: () => this.move(-MOVE, 0), d: () => this.move(MOVE, 0), s: () => this.move(0, -MOVE), w: () => this.move(0, MOVE) };
    actions[key]?.();
    return actions[key] !== undefined;
  }
}
