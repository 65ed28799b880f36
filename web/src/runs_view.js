// The list of runs: updated by events, filtered, paged by the API's cursor.

import { isOver, listRuns } from "./api.js";
import { onConnection } from "./connection.js";
import { h, link } from "./dom.js";
import { applyToRun, follow } from "./events.js";
import { address, go } from "./router.js";
import { cancel, isGoing, removeLater } from "./run_actions.js";
import { RunRow, states } from "./runs_table.js";
import { Through } from "./through.js";
import { Variants } from "./variants.js";

const PERIOD_MS = 2000;
const LIMIT = 50;
const COMPARED_MAX = 4;
const columns = ["Compare", "Run", "Model", "State", "Progress", "Parts through", "Throughput", "Age", "Actions"];

const trail = []; // cursors of the pages before this one, for the way back

export class RunsView {
  constructor() {
    this.title = "Runs";
    this.rows = new Map();
    this.selected = new Map(); // id -> run
    this.through = new Through((id, value) => this.rows.get(id)?.showThrough(value));
    this.variants = new Variants((id, chips) => this.rows.get(id)?.showChips(chips));
    this.stopEvents = () => {};
    this.followed = "";
  }

  mount(root, { query }) {
    this.query = query;
    root.append(this.head(), this.filters(), this.table(), this.foot());
    this.stopConnection = onConnection((isAway) => !isAway && this.refresh());
    this.onShow = () => !document.hidden && this.refresh();
    document.addEventListener("visibilitychange", this.onShow);
    this.refresh();
  }

  unmount() {
    clearTimeout(this.timer);
    this.isGone = true;
    this.abort?.abort();
    this.stopEvents();
    this.stopConnection();
    document.removeEventListener("visibilitychange", this.onShow);
  }

  head() {
    return h("div", { class: "view-head" }, h("h1", {}, "Runs"),
      link(address("new"), "New run", { class: "button primary" }));
  }

  filters() {
    const select = (name, label, values) => {
      const box = h("select", { on: { change: () => this.filter({ [name]: box.value }) } },
        h("option", { value: "" }, "all"), values.map((value) => h("option", { value }, value)));
      box.value = this.query.get(name) ?? "";
      return h("label", { class: "field inline" }, h("span", {}, label), box);
    };
    let timer = 0;
    this.labelBox = h("input", { type: "search", placeholder: "exact label", autocomplete: "off", spellcheck: "false",
      on: { input: () => {
        clearTimeout(timer);
        timer = setTimeout(() => this.filter({ label: this.labelBox.value.trim() }), 300);
      } } });
    this.labelBox.value = this.query.get("label") ?? "";
    return h("form", { class: "filters", role: "search", "aria-label": "Filter runs",
      on: { submit: (event) => event.preventDefault() } },
      select("status", "State", states), select("model", "Model", ["macro", "micro"]),
      h("label", { class: "field inline" }, h("span", {}, "Label"), this.labelBox));
  }

  // Another filter begins at the newest run again, in the same view so that the field keeps its focus.
  filter(change) {
    trail.length = 0;
    this.move({ cursor: "", ...change });
  }

  move(change) {
    const query = { ...Object.fromEntries(this.query), ...change };
    const target = address("runs", "", query);
    this.query = new URLSearchParams(Object.entries(query).filter(([, value]) => value));
    history.replaceState(null, "", target === "#/runs" ? "#/" : target);
    this.refresh();
  }

  table() {
    this.body = h("tbody", { role: "rowgroup" });
    this.state = h("div", { class: "empty" }, h("p", {}, "Loading …"));
    const header = columns.map((name, k) => h("th", { role: "columnheader", scope: "col", class: k === 5 || k === 6 ? "right" : null },
      k === 0 || k === columns.length - 1 ? h("span", { class: "hidden" }, name) : name));
    this.list = h("table", { class: "runs", role: "table", hidden: true },
      h("thead", { role: "rowgroup" }, h("tr", { role: "row" }, header)), this.body);
    return h("section", { class: "card list", "aria-label": "Runs" }, this.list, this.state);
  }

  foot() {
    const button = (text, onClick) => h("button", { type: "button", hidden: true, on: { click: onClick } }, text);
    this.newer = button("← Newer", () => this.move({ cursor: trail.pop() ?? "" }));
    this.older = button("Older →", () => {
      trail.push(this.query.get("cursor") ?? "");
      this.move({ cursor: this.next });
      this.list.scrollIntoView({ block: "start" });
    });
    this.compare = h("button", { type: "button", class: "primary", on: {
      click: () => go(address("compare", "", { runs: [...this.selected.keys()].join(",") })) } });
    const clear = h("button", { type: "button", class: "quiet", on: { click: () => this.clearSelection() } }, "Clear");
    this.tray = h("div", { class: "tray", hidden: true }, this.compare, clear);
    return h("div", { class: "list-foot" }, h("nav", { class: "pager", "aria-label": "Pages" }, this.newer, this.older), this.tray);
  }

  clearSelection() {
    this.selected.clear();
    for (const row of this.rows.values()) row.check.checked = false;
    this.showTray();
  }

  select(run, isChosen) {
    if (isChosen) this.selected.set(run.id, run);
    else this.selected.delete(run.id);
    this.showTray();
  }

  showTray() {
    const n = this.selected.size;
    this.tray.hidden = n === 0;
    this.compare.disabled = n < 2;
    this.compare.textContent = n < 2 ? "Select another run to compare" : `Compare ${n} runs`;
    for (const row of this.rows.values()) row.check.disabled = n >= COMPARED_MAX && !row.check.checked;
  }

  async refresh() {
    clearTimeout(this.timer);
    this.abort?.abort();
    const abort = new AbortController();
    this.abort = abort;
    try {
      const query = { limit: LIMIT, ...Object.fromEntries(this.query) };
      const { runs, cursor } = await listRuns(query, { signal: abort.signal });
      if (this.isGone || abort.signal.aborted) return;
      this.next = cursor;
      this.show(runs);
    } catch (error) {
      if (error.name === "AbortError" || this.isGone) return;
      this.explain(error);
    }
    if (!document.hidden) this.timer = setTimeout(() => this.refresh(), PERIOD_MS);
  }

  explain(error) {
    if (this.rows.size > 0 && error.status === 0) return; // the banner says it
    this.body.replaceChildren();
    this.rows.clear();
    this.list.hidden = true;
    this.state.hidden = false;
    this.state.replaceChildren(h("p", { class: "fault" }, error.message));
  }

  show(all) {
    const runs = all.filter((run) => !isGoing(run.id));
    const seen = new Set(runs.map((run) => run.id));
    for (const [id, row] of this.rows) {
      if (seen.has(id)) continue;
      row.element.remove();
      this.rows.delete(id);
      this.selected.delete(id);
    }
    runs.forEach((run, k) => this.showRow(run, k));
    this.newer.hidden = !this.query.get("cursor");
    this.older.hidden = this.next === null;
    this.showTray();
    this.showEmpty(runs.length);
    this.through.want(runs);
    this.variants.want(runs);
    this.followActive(runs);
  }

  showRow(run, k) {
    let row = this.rows.get(run.id);
    if (!row) {
      row = new RunRow(run, {
        onCancel: (current) => cancel(current).then(() => this.refresh()),
        onRemove: (current) => removeLater(current, () => this.isGone || this.refresh()),
        onSelect: (current, isChosen) => this.select(current, isChosen),
      });
      row.check.checked = this.selected.has(run.id);
      this.rows.set(run.id, row);
    }
    row.show(run);
    row.showThrough(this.through.get(run.id));
    if (this.body.children[k] !== row.element) this.body.insertBefore(row.element, this.body.children[k] ?? null);
  }

  showEmpty(n) {
    this.state.hidden = n > 0;
    this.list.hidden = n === 0;
    if (n > 0) return;
    const isFiltered = ["status", "model", "label", "cursor"].some((name) => this.query.get(name));
    this.state.replaceChildren(...(isFiltered
      ? [h("p", {}, "No run matches."), link("#/", "Show all runs", { class: "button" })]
      : [h("p", {}, "No runs yet. Start with one of the paper’s examples."),
        link(address("new", "", { example: "example-1" }), "New run", { class: "button primary" })]));
  }

  // Between two requests of the list, updates by the events of its runs.
  followActive(runs) {
    const ids = runs.filter((run) => !isOver(run)).map((run) => run.id);
    if (ids.join() === this.followed) return;
    this.followed = ids.join();
    this.stopEvents();
    this.stopEvents = ids.length > 0 ? follow(ids, (kind, event) => this.take(kind, event)) : () => {};
  }

  take(kind, event) {
    const row = this.rows.get(event.run);
    if (!row) return;
    if (kind === "curve") this.through.take(event);
    if (kind === "snapshot" && event.n === 0) this.through.set(event.run, { start: Math.round(event.mass) });
    applyToRun(row.run, kind, event);
    row.show(row.run);
    if (kind === "end") this.refresh();
  }
}
