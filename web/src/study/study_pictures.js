// The belt at one time, once for each of some points of a study, side by side. Runs of trials have no snapshots, so that they are
// solved again when somebody wants to see them.

import { getJson, isOver, paths, post, ticketed } from "../base/api.js";
import { h, link, setText } from "../base/dom.js";
import { quantity } from "../base/format.js";
import { address } from "../base/router.js";
import { tellFault } from "../base/toast.js";

const SHOWN_MAX = 8;
const PERIOD_MS = 500;
const WIDTH = 320;

// At most so many, spread evenly, with the first and the last one.
function spread(items) {
  if (items.length <= SHOWN_MAX) return items;
  return Array.from({ length: SHOWN_MAX }, (_, k) => items[Math.round((k * (items.length - 1)) / (SHOWN_MAX - 1))]);
}

export class StudyPictures {
  constructor(data) {
    Object.assign(this, { data, points: [], shown: [] });
    this.button = h("button", { type: "button", on: { click: () => this.solve().catch(tellFault) } });
    this.time = h("input", { type: "range", min: "0", max: "1", step: "0.01", value: "0.5", "aria-label": "Time of the pictures",
      on: { input: () => this.draw() } });
    this.clock = h("span", { class: "figures" });
    this.row = h("label", { class: "row", hidden: true }, h("span", { class: "hint" }, "At"), this.time, this.clock);
    this.list = h("ul", { class: "pictures" });
    this.element = h("section", { class: "card", "aria-labelledby": "pictures-title", hidden: true },
      h("div", { class: "card-head" }, h("h2", { id: "pictures-title" }, "The jam at each point"), this.row, this.button), this.list);
  }

  get hasAny() {
    return this.list.childElementCount > 0;
  }

  dispose() {
    this.isGone = true;
  }

  // points: [{ label, x, trials }], one for each picture that there may be.
  show(points) {
    this.points = spread([...points].sort((a, b) => a.x - b.x));
    this.element.hidden = this.points.length === 0;
    const n = this.points.length;
    setText(this.button, this.isSolving ? "Solving …" : `Solve ${n === 1 ? "it" : `these ${n}`} again and show`);
    this.button.hidden = this.shown.length >= n && !this.isSolving;
  }

  async solve() {
    if (this.isSolving) return;
    this.isSolving = true;
    this.button.disabled = true;
    try {
      this.shown = [];
      this.list.replaceChildren();
      for (const point of this.points) await this.add(point);
    } finally {
      this.isSolving = false;
      this.button.disabled = false;
      this.show(this.points);
    }
  }

  async add({ label, trials: [trial] }) {
    let run = await post(`${this.data.path}/trials/${trial.trial}/run`, "");
    while (!isOver(run)) {
      await new Promise((done) => {
        setTimeout(done, PERIOD_MS);
      });
      if (this.isGone) return;
      run = await getJson(paths.run(run.id));
    }
    const { snapshots } = await getJson(paths.of(run.id, "snapshots"));
    if (this.isGone || snapshots.length === 0) return;
    const image = h("img", { width: String(WIDTH), alt: "" });
    this.list.append(h("li", {}, link(address("runs", run.id), "", { "aria-label": `${label}, open the run` }), h("span", {}, label)));
    this.list.lastChild.firstChild.append(image);
    this.shown.push({ image, snapshots, id: run.id, label });
    this.row.hidden = false;
    await this.draw();
  }

  async draw() {
    await Promise.all(this.shown.map(async (picture) => {
      const { image, snapshots, id, label } = picture;
      const n = Math.round(Number(this.time.value) * (snapshots.length - 1));
      const text = quantity(snapshots[n].t_s, "s", 3);
      setText(this.clock, text);
      image.alt = `Density of cargo at ${text}, ${label}`;
      if (picture.n === n) return;
      picture.n = n;
      image.src = await ticketed(paths.of(id, `snapshots/${snapshots[n].n ?? n}.png?width=${2 * WIDTH}`));
    }));
  }
}
