// Lines: what runs and studies belong to, and those that are being edited in this browser.

import { listRuns, listStudies } from "./api.js";
import { savedLines } from "./board/lines.js";
import { h, link } from "./dom.js";
import { age, moment } from "./format.js";
import { address } from "./router.js";

const PAGES = 5; // of 200 runs and studies each: older ones are found by the search of the list
const columns = ["Line", "Versions", "Runs", "Studies", "Last used", "Newest version"];

// The newest items of a list, newest first.
async function newest(list, name) {
  const found = [];
  for (let page = 0, cursor = ""; page < PAGES && cursor !== null; page++) {
    const answer = await list({ limit: 200, cursor });
    found.push(...answer[name]);
    ({ cursor } = answer);
  }
  return found;
}

// [{ line, at, versions, runs, studies, newest }], the last used one first; newest: its newest run, if it has any.
export function linesOf(runs, studies) {
  const lines = new Map();
  const lineOf = ({ line, created_at: at }) => {
    if (!lines.has(line)) lines.set(line, { line, at, versions: 0, runs: 0, studies: 0, newest: null });
    const known = lines.get(line);
    if (known.at < at) known.at = at;
    return known;
  };
  for (const run of runs.filter(({ line }) => line)) {
    const known = lineOf(run);
    known.runs++;
    known.versions = Math.max(known.versions, run.line_version);
    known.newest ??= run;
  }
  for (const study of studies.filter(({ line }) => line)) lineOf(study).studies++;
  return [...lines.values()].sort((a, b) => (a.at < b.at ? 1 : -1));
}

export class LinesView {
  constructor() {
    this.title = "Lines";
  }

  async mount(root) {
    root.append(h("p", { class: "loading" }, "Loading …"));
    const [runs, studies] = await Promise.all([newest(listRuns, "runs"), newest(listStudies, "studies")]);
    if (this.isGone) return;
    const lines = linesOf(runs, studies);
    root.replaceChildren(h("div", { class: "view-head" }, h("h1", {}, "Lines"), link(address("new", "", { blank: 1 }), "New line", { class: "button primary" })),
      h("section", { class: "card list", "aria-label": "Lines" }, lines.length > 0 ? this.table(lines)
        : h("div", { class: "empty" }, h("p", {}, "No line yet. Runs and studies that belong to one line are kept together here, with its versions."))),
      ...this.edited());
  }

  unmount() {
    this.isGone = true;
  }

  table(lines) {
    const time = (at) => h("time", { datetime: at, title: moment(at) }, age(at));
    return h("table", { class: "studies" }, h("thead", {}, h("tr", {}, columns.map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, lines.map(({ line, at, versions, runs, studies, newest: run }) => h("tr", {},
        h("th", { scope: "row", class: "name" }, link(address("runs", "", { line }), line)),
        [versions, runs, studies].map((n) => h("td", { class: "figures" }, n === 0 ? "–" : String(n))), h("td", {}, time(at)),
        h("td", {}, run ? link(address("new", "", { from: run.id }), "Change and run", { class: "button", "aria-label": `Change and run ${line}` }) : null)))));
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
