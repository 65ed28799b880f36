// What can be done with the runs that are selected.

import { cancel } from "../actions/run_actions.js";
import { isOver } from "../base/api.js";
import { h, setText } from "../base/dom.js";
import { address, go } from "../base/router.js";
import { COMPARED_MAX } from "../compare/compare_view.js";
import { selected } from "./selection.js";

export class Tray {
  // onRemove(runs); onChange(): what is selected has changed.
  constructor(onRemove, onChange) {
    const button = (text, onClick, kind) => h("button", { type: "button", class: kind ?? null, on: { click: onClick } }, text);
    const runs = () => [...selected.values()];
    this.count = h("span", { class: "count", role: "status" });
    this.compare = button("", () => go(address("compare", "", { runs: [...selected.keys()].join(",") })), "primary");
    this.clone = button("New run like it", () => go(address("new", "", { from: runs()[0].id })));
    this.cancel = button("Cancel", () => {
      for (const run of runs().filter((one) => !isOver(one))) cancel(run);
    });
    this.remove = button("Delete", () => onRemove(runs()));
    this.clear = button("Clear", () => {
      selected.clear();
      onChange();
    }, "quiet");
    this.element = h("div", { class: "tray", role: "group", "aria-label": "Selected runs", hidden: true },
      this.count, this.compare, this.clone, this.cancel, this.remove, this.clear);
  }

  show() {
    const n = selected.size;
    this.element.hidden = n === 0;
    setText(this.count, `${n} selected`);
    this.compare.disabled = n < 2 || n > COMPARED_MAX;
    setText(this.compare, n < 2 ? "Select another run to compare" : n > COMPARED_MAX ? `Compare at most ${COMPARED_MAX}` : `Compare ${n} runs`);
    this.clone.hidden = n !== 1;
    this.cancel.hidden = [...selected.values()].every(isOver);
  }
}
