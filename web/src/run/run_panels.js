// Below a run's animation: its figures, warnings, scenario and downloads.

import { copy } from "../actions/run_actions.js";
import { currentToken, isGuest } from "../base/access.js";
import { ticketed } from "../base/api.js";
import { h, iconButton, link } from "../base/dom.js";
import { saveWithCommas } from "../base/files.js";
import { fixed, modelOf, moment, number, parts, percent, quantity, readable, span } from "../base/format.js";
import { formatJson } from "../base/json_text.js";
import { usesComma } from "../base/numbers.js";
import { tellFault } from "../base/toast.js";

function facts(rows) {
  return h("dl", { class: "facts" }, rows.filter(Boolean).map(([name, value]) =>
    h("div", {}, h("dt", {}, name), h("dd", {}, value))));
}

function overlap({ largest_overlap_m: m, largest_overlap_share: share }) {
  return `${quantity(m * 1000, "mm")} (${percent(share, 1)} of a radius)`;
}

// What became of the parts of a run that has ended.
function cargoFacts(s) {
  return facts([
    ["Parts at start", parts(s.parts_start, 6)],
    s.parts_entered === undefined ? null : ["Parts that entered", parts(s.parts_entered, 6)],
    ["Parts through", parts(s.parts_left)],
    s.parts_fallen === undefined ? null : ["Parts that fell off the belts", parts(s.parts_fallen)],
    ["Parts still on the belt", parts(s.parts_end)],
    s.end_reason === undefined ? null : ["Ended by", s.end_reason],
  ]);
}

// Cells of unlike edges where none divides the domain. Summaries of older versions do not tell the edges.
function cellsText({ cells, cell_m: edges }) {
  if (!edges) return number(cells, 9);
  const [x, y] = edges.map((edge) => number(edge * 1000, 4));
  return `${number(cells, 9)} of ${x === y ? x : `${x} × ${y}`} mm`;
}

// What the solver did.
function solverRows(s) {
  const isMicro = s.model === "micro";
  const speed = isMicro ? s.particle_steps_per_s : s.cell_steps_per_s;
  return [
    ["Largest density", `${percent(s.largest_density, 1)} of close packing`],
    isMicro ? ["Largest overlap", overlap(s)] : null,
    isMicro ? ["Contacts at the end", number(s.contacts, 6)] : ["Cells", cellsText(s)],
    ["Time step", quantity(s.step_s * 1000, "ms")],
    ["Steps", number(s.steps, 9)],
    ["Computing time", span(s.wall_time_s)],
    speed === null ? null : ["Speed", `${number(speed / 1e6)} million ${isMicro ? "part" : "cell"} steps/s`],
    ["Threads", number(s.threads)],
    ["Solver", `${modelOf(s)}, version ${s.solver_version}`],
  ].filter(Boolean);
}

// What is there on demand: a title and one sentence, and below them the rest.
function details(title, sentence, ...content) {
  return h("details", { class: "fold" }, h("summary", {}, h("span", { class: "fold-title" }, title), h("span", { class: "hint" }, sentence)), content);
}

export function fold(...all) {
  return h("section", { class: "card" }, details(...all));
}

// A column for each run that has ended; headOf(k): its heading, an element.
export function solverTable(runs, headOf) {
  const columns = runs.map(({ summary }) => new Map(summary ? solverRows(summary) : []));
  const names = [...new Set(columns.flatMap((column) => [...column.keys()]))];
  return h("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": "Table of computations" },
    h("table", { class: "measures" },
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, h("span", { class: "hidden" }, "Fact")),
        runs.map((data, k) => h("th", { scope: "col" }, headOf(k))))),
      h("tbody", {}, names.map((name) => h("tr", {}, h("th", { scope: "row" }, name),
        columns.map((column) => h("td", {}, column.get(name) ?? "–")))))));
}

function runFacts({ run, scenario }) {
  return facts([
    ["Model", modelOf(run)],
    ["Simulated time", quantity(scenario.duration_s, "s")],
    ["Created", moment(run.created_at)],
    run.started_at ? ["Started", moment(run.started_at)] : null,
    run.finished_at ? ["Finished", moment(run.finished_at)] : null,
    ["Priority", fixed(run.priority, 0)],
  ]);
}

// What a warning means; the figures of the solver on demand.
function warningItem({ title, meaning, detail }) {
  return h("li", {}, h("strong", {}, title), " ", readable(meaning),
    detail ? h("details", {}, h("summary", {}, "Details"), readable(detail)) : null);
}

// The server's sentences; what a planner can do stands at their ends.
// What the server says of a run or of several, to stand before all numbers.
export function verdictPanel() {
  return h("div", { class: "card says", role: "group", "aria-label": "What this says", hidden: true });
}

export function verdictLines(verdicts = []) {
  return verdicts.map(({ kind, text }) => h("p", { class: "verdict", data: { kind } }, readable(text)));
}

export function summaryPanel(data) {
  const { summary, run } = data;
  const faults = run.error ? [h("li", { class: "fault" }, readable(run.error.detail))] : [];
  const warnings = summary?.warning_details?.map(warningItem) ?? (summary?.warnings ?? []).map((text) => h("li", {}, readable(text)));
  return h("section", { class: "card", "aria-labelledby": "summary-title" },
    h("h2", { id: "summary-title" }, "Summary"),
    faults.length + warnings.length > 0
      ? h("ul", { class: "warnings", "aria-label": "Warnings" }, faults, warnings) : null,
    summary?.validity?.like ? h("p", { class: "hint" }, readable(summary.validity.like.detail)) : null,
    summary ? [cargoFacts(summary),
      details("Computation", "What the solver did; it says nothing about the belt.", facts(solverRows(summary)))] : runFacts(data));
}

export function scenarioPanel({ scenario, id }) {
  const text = formatJson(scenario);
  const code = h("code", {}, text);
  return h("section", { class: "card", "aria-labelledby": "scenario-title" },
    h("h2", { id: "scenario-title" }, "Scenario"),
    h("p", { class: "hint" }, "As it was solved, with every default filled in."),
    h("details", {}, h("summary", {}, "Show the JSON"),
      h("pre", { class: "json", tabindex: "0", role: "region", "aria-label": "Scenario as JSON" }, code)),
    h("p", { class: "row" },
      isGuest() ? null : link(`#/new?from=${id}`, "Run again with changes", { class: "button" }),
      iconButton("copy", "Copy the JSON", () => copy(text, code), { shown: true })));
}

const WITH_COMMAS = "CSV 1,5"; // as the reader's spreadsheet opens it

// What can be had of a run: name, what it is, address below the run, name of the file.
function offers(data, n) {
  const number6 = String(n).padStart(6, "0");
  const isMicro = data.hasParts();
  const hasFigures = data.run.links.key_figures !== undefined;
  return [
    ["Curve", "CSV", "curve.csv", "curve.csv"],
    ["Curve", "JSON", "curve", "curve.json"],
    hasFigures ? ["Key figures", "CSV", "key_figures.csv", "key-figures.csv"] : null,
    hasFigures ? ["Key figures", "JSON", "key_figures", "key-figures.json"] : null,
    ["Density shown", "NPY", `snapshots/${n}.npy`, `density-${number6}.npy`],
    ["Density shown", "PNG", `snapshots/${n}.png?width=1200`, `density-${number6}.png`],
    isMicro ? ["Parts shown", "NPY", `parts/${n}.npy`, `parts-${number6}.npy`] : null,
    isMicro ? ["Parts shown", "CSV", `parts/${n}.csv`, `parts-${number6}.csv`] : null,
    ["Summary", "JSON", "summary", "summary.json"],
    ["Scenario", "JSON", "scenario", "scenario.json"],
    data.run.links.results ? ["Everything", "ZIP", "results.zip", "results.zip"] : null,
  ].filter(Boolean).flatMap((one) => (one[1] === "CSV" && usesComma() ? [one, [one[0], WITH_COMMAS, one[2], one[3]]] : [one]));
}

export class DownloadsPanel {
  constructor(data, savePicture) {
    this.data = data;
    this.savePicture = savePicture;
    this.n = 0;
    this.chosen = 0;
    this.list = h("ul", { class: "offers" });
    this.curl = h("code", { class: "curl" });
    this.element = h("section", { class: "card", "aria-labelledby": "downloads-title" },
      h("h2", { id: "downloads-title" }, "Downloads"), this.list,
      h("div", { class: "curl-line" }, h("pre", { tabindex: "0", role: "region", "aria-label": "curl line" }, this.curl),
        iconButton("copy", "Copy the curl line", () => copy(this.curl.textContent, this.curl), { class: "bare" })));
    this.show(0);
  }

  // n: the snapshot that is shown.
  show(n) {
    if (n === this.n && this.list.childElementCount > 0) return;
    this.n = n;
    const items = offers(this.data, n);
    if (this.list.childElementCount === 0) this.build(items);
    items.forEach(([, , target, file], k) => this.aim(k, target, file));
    this.showCurl();
  }

  build(items) {
    const show = (k) => {
      this.chosen = k;
      this.showCurl();
    };
    this.links = items.map(([what, format], k) => link("#", format, { "aria-label": `${what}, ${format}`,
      on: { focus: () => show(k), pointerenter: () => show(k), click: (event) => this.save(event, format) } }));
    const groups = new Map();
    items.forEach(([what], k) => groups.set(what, [...(groups.get(what) ?? []), this.links[k]]));
    this.list.append(
      ...[...groups].map(([what, links]) => h("li", {}, h("span", {}, what), h("span", { class: "formats" }, links))),
      h("li", {}, h("span", {}, "Picture as seen"), h("span", { class: "formats" },
        h("button", { type: "button", on: { click: this.savePicture } }, "PNG"))));
  }

  aim(k, target, file) {
    const address = `v1/runs/${this.data.id}/${target}`;
    this.links[k].setAttribute("href", address);
    this.links[k].setAttribute("download", file);
    this.links[k].dataset.file = file;
  }

  showCurl() {
    const { href, dataset } = this.links[this.chosen];
    const header = currentToken() === null ? "" : " -H \"Authorization: Bearer $TOKEN\"";
    this.curl.textContent = `curl -sS${header} -o ${dataset.file} '${href}'`;
  }

  // A link that is clicked is fetched without our headers, so with a token by an address that has a ticket. What the page makes
  // of an answer it fetches itself.
  async save(event, format) {
    if (currentToken() === null && format !== WITH_COMMAS) return;
    event.preventDefault();
    const chosen = event.currentTarget;
    try {
      if (format === WITH_COMMAS) {
        await saveWithCommas(chosen.getAttribute("href"), chosen.dataset.file);
        return;
      }
      link(await ticketed(chosen.getAttribute("href")), "", { download: chosen.dataset.file }).click();
    } catch (error) {
      tellFault(error);
    }
  }
}
