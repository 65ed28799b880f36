// Lines: what runs and studies belong to, and those that are being edited in this browser.

import { listLines } from "../base/api.js";
import { h, link } from "../base/dom.js";
import { age, moment } from "../base/format.js";
import { address } from "../base/router.js";
import { savedLines } from "../board/lines.js";

const LIMIT = 200;

export class LinesView {
  constructor() {
    this.title = "Lines";
  }

  async mount(root, { query }) {
    root.append(h("p", { class: "loading" }, "Loading …"));
    const { lines, cursor } = await listLines({ limit: LIMIT, cursor: query.get("cursor") ?? "" });
    if (this.isGone) return;
    root.replaceChildren(h("div", { class: "view-head" }, h("h1", {}, "Lines"), link(address("new", "", { blank: 1 }), "New line", { class: "button primary" })),
      h("section", { class: "card list", "aria-label": "Lines" }, lines.length > 0 ? this.table(lines)
        : h("div", { class: "empty" }, h("p", {}, "No line yet. Runs and studies that belong to one line are kept together here, with its versions."))),
      cursor === null ? "" : h("p", {}, link(address("lines", "", { cursor }), "Lines used earlier →")),
      ...this.edited());
  }

  unmount() {
    this.isGone = true;
  }

  // Whose a line is stands beside it where it may be somebody else's.
  table(lines) {
    const time = (at) => h("time", { datetime: at, title: moment(at) }, age(at));
    const isShared = new Set(lines.map(({ owner }) => owner)).size > 1;
    const columns = ["Line", ...(isShared ? ["Owner"] : []), "Versions", "Runs", "Studies", "Last used", "Newest version"];
    return h("table", { class: "studies" }, h("thead", {}, h("tr", {}, columns.map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, lines.map(({ line, owner, used_at: at, versions, runs, studies, newest_run: run }) => h("tr", {},
        h("th", { scope: "row", class: "name" }, link(address("runs", "", { line, ...(isShared && owner ? { owner } : {}) }), line)),
        isShared ? h("td", {}, owner ?? "–") : null,
        [versions, runs, studies].map((n) => h("td", { class: "figures" }, n === 0 ? "–" : String(n))), h("td", {}, time(at)),
        h("td", {}, run ? link(address("new", "", { from: run }), "Change and run", { class: "button", "aria-label": `Change and run ${line}` }) : null)))));
  }

  edited() {
    const lines = savedLines();
    if (lines.length === 0) return [];
    return [h("section", { class: "card below", "aria-labelledby": "edited-title" }, h("h2", { id: "edited-title" }, "Edited in this browser"),
      h("p", { class: "hint" }, "Kept as they were left, whether they were run or not."),
      h("ul", {}, lines.map(({ id, scenario, saved_at: at }) => h("li", {},
        link(address("new", "", { line: id }), scenario.name || "without a name"), " ", h("small", { class: "hint" }, age(at))))))];
  }
}
