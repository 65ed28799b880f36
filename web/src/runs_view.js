// The list of runs: updated by events, filtered, paged by the API's cursor.

import { getJson, isOver, listRuns } from "./api.js";
import { onConnection } from "./connection.js";
import { h, link, setText } from "./dom.js";
import { applyToRun, follow } from "./events.js";
import { firstVisit } from "./first_visit.js";
import { address } from "./router.js";
import { cancel, isGoing, removeLater } from "./run_actions.js";
import { columns } from "./runs_columns.js";
import { RunRow, states } from "./runs_table.js";
import { Tray } from "./runs_tray.js";
import { selected } from "./selection.js";
import { nameOfStudy } from "./study_words.js";
import { Variants } from "./variants.js";

const PERIOD_MS = 2000;
const LIMIT = 50;

export class RunsView {
  constructor() {
    this.title = "Runs";
    this.rows = new Map();
    this.variants = new Variants((id, chips) => this.rows.get(id)?.showChips(chips));
    this.stopEvents = () => {};
    this.followed = "";
  }

  mount(root, { query }) {
    this.query = query;
    this.trail = history.state?.trail ?? [];
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
    this.total = h("span", { class: "total", role: "status" });
    return h("div", { class: "view-head" }, h("h1", {}, "Runs ", this.total),
      link(address("new"), "New run", { class: "button primary" }));
  }

  choice(name, label, values, all = "all") {
    const box = h("select", { on: { change: () => this.filter({ [name]: box.value }) } },
      h("option", { value: "" }, all), values.map(([value, text]) => h("option", { value }, text)));
    box.value = this.query.get(name) ?? "";
    return h("label", { class: "field inline" }, h("span", {}, label), box);
  }

  filters() {
    const plain = (values) => values.map((value) => [value, value]);
    let timer = 0;
    this.searchBox = h("input", { type: "search", placeholder: "name or label", autocomplete: "off", spellcheck: "false", maxlength: "100",
      on: { input: () => {
        clearTimeout(timer);
        timer = setTimeout(() => this.filter({ search: this.searchBox.value.trim() }, true), 300);
      } } });
    this.searchBox.value = this.query.get("search") ?? "";
    this.studies = h("span", { class: "row" });
    this.offerStudies().catch(() => {}); // without them there is one choice less
    return h("form", { class: "filters", role: "search", "aria-label": "Filter runs",
      on: { submit: (event) => event.preventDefault() } },
    h("label", { class: "field inline" }, h("span", {}, "Search"), this.searchBox),
    this.choice("status", "State", plain(states)), this.choice("model", "Model", plain(["macro", "micro"])), this.sorting(), this.studies);
  }

  sorting() {
    const element = this.choice("sort", "Sort by", columns.filter(({ sort }) => sort)
      .map(({ name, sort, begins = "" }) => [`${begins}${sort}`, name.toLowerCase()]), "newest first");
    element.classList.add("sorting");
    this.sortBox = element.querySelector("select");
    this.sortBox.addEventListener("change", () => this.showSorting());
    return element;
  }

  // The runs of a study's trials are listed by themselves.
  async offerStudies() {
    const { studies } = await getJson("v1/studies?limit=50");
    const id = this.query.get("study");
    if (this.isGone || (studies.length === 0 && !id)) return;
    const known = studies.map((study) => [study.id, nameOfStudy(study)]);
    if (id && !known.some(([one]) => one === id)) known.push([id, `Study ${id.slice(-8)}`]);
    this.studies.replaceChildren(this.choice("study", "Study", known, "none: single runs"),
      ...(id ? [link(address("studies", id), "Show the study")] : []));
  }

  // Another filter begins at the newest run again, in the same view so that the field keeps its focus.
  filter(change, isTyped = false) {
    this.move({ cursor: "", ...change }, [], isTyped);
    if ("study" in change) this.offerStudies().catch(() => {});
  }

  // The same column again: the other way round.
  sortBy({ sort, begins = "" }) {
    const now = this.query.get("sort") ?? "-created";
    const first = `${begins}${sort}`;
    this.filter({ sort: now === first ? (begins ? sort : `-${sort}`) : first });
    this.showSorting();
  }

  showSorting() {
    const now = this.query.get("sort") ?? "-created";
    for (const [sort, header] of this.headers) {
      const isHere = now === sort || now === `-${sort}`;
      if (isHere) header.setAttribute("aria-sort", now === sort ? "ascending" : "descending");
      else header.removeAttribute("aria-sort");
    }
  }

  // Another page, to which the browser's way back leads, too. trail: the cursors of the pages before it, kept with its entry
  // in the history.
  move(change, trail, isReplaced = false) {
    const query = { ...Object.fromEntries(this.query), ...change };
    const target = address("runs", "", query);
    this.query = new URLSearchParams(Object.entries(query).filter(([, value]) => value));
    this.trail = trail;
    history[isReplaced ? "replaceState" : "pushState"]({ trail }, "", target === "#/runs" ? "#/" : target);
    this.refresh();
  }

  table() {
    this.body = h("tbody", { role: "rowgroup" });
    this.state = h("div", { class: "empty" }, h("p", {}, "Loading …"));
    this.headers = new Map();
    const hidden = (name) => h("th", { role: "columnheader", scope: "col" }, h("span", { class: "hidden" }, name));
    const header = columns.map((column) => {
      const { name, sort, title, isRight } = column;
      const element = h("th", { role: "columnheader", scope: "col", title, class: isRight ? "right" : null },
        sort ? h("button", { type: "button", class: "sorter", on: { click: () => this.sortBy(column) } }, name) : name);
      if (sort) this.headers.set(sort, element);
      return element;
    });
    this.list = h("table", { class: "runs", role: "table", hidden: true },
      h("thead", { role: "rowgroup" }, h("tr", { role: "row" }, hidden("Select"), header, hidden("Actions"))), this.body);
    this.showSorting();
    return h("section", { class: "card list", "aria-label": "Runs" }, this.list, this.state);
  }

  foot() {
    const button = (text, onClick) => h("button", { type: "button", hidden: true, on: { click: onClick } }, text);
    this.newer = button("← Newer", () => this.move({ cursor: this.trail.at(-1) ?? "" }, this.trail.slice(0, -1)));
    this.older = button("Older →", () => {
      this.move({ cursor: this.next }, [...this.trail, this.query.get("cursor") ?? ""]);
      this.list.scrollIntoView({ block: "start" });
    });
    this.tray = new Tray((runs) => this.removeAll(runs), () => this.showSelection());
    return h("div", { class: "list-foot" }, h("nav", { class: "pager", "aria-label": "Pages" }, this.newer, this.older), this.tray.element);
  }

  select(run, isChosen) {
    if (isChosen) selected.set(run.id, run);
    else selected.delete(run.id);
    this.showSelection();
  }

  showSelection() {
    for (const row of this.rows.values()) row.check.checked = selected.has(row.id);
    this.tray.show();
  }

  async refresh() {
    clearTimeout(this.timer);
    this.abort?.abort();
    const abort = new AbortController();
    this.abort = abort;
    try {
      const query = { limit: LIMIT, count: 1, ...Object.fromEntries(this.query) };
      const { runs, cursor, total } = await listRuns(query, { signal: abort.signal });
      if (this.isGone || abort.signal.aborted) return;
      this.next = cursor;
      setText(this.total, total === undefined ? "" : String(total.toLocaleString("en")));
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
    this.emptyShown = "fault";
    this.state.replaceChildren(h("p", { class: "fault" }, error.message));
  }

  show(all) {
    const runs = all.filter((run) => !isGoing(run.id));
    const seen = new Set(runs.map((run) => run.id));
    for (const [id, row] of this.rows) {
      if (seen.has(id)) continue;
      row.element.remove();
      this.rows.delete(id);
    }
    runs.forEach((run, k) => this.showRow(run, k));
    this.newer.hidden = !this.query.get("cursor");
    setText(this.newer, this.trail.length > 0 ? "← Newer" : "← Newest");
    this.older.hidden = this.next === null;
    this.showSelection();
    this.showEmpty(runs.length);
    this.variants.want(runs);
    this.followActive(runs);
  }

  showRow(run, k) {
    let row = this.rows.get(run.id);
    if (!row) {
      row = new RunRow(run, {
        onCancel: (current) => cancel(current).then(() => this.refresh()),
        onRemove: (current) => this.remove(current),
        onSelect: (current, isChosen) => this.select(current, isChosen),
      });
      this.rows.set(run.id, row);
    }
    row.show(run);
    if (selected.has(run.id)) selected.set(run.id, run);
    if (this.body.children[k] !== row.element) this.body.insertBefore(row.element, this.body.children[k] ?? null);
  }

  // The focus goes on to the next run, and back with the run that comes back.
  remove(run) {
    const { element } = this.rows.get(run.id);
    const hadFocus = element.contains(document.activeElement);
    const next = element.nextElementSibling ?? element.previousElementSibling;
    this.removeAll([run], (isBack) => isBack && this.rows.get(run.id)?.remove.focus());
    if (hadFocus) (next?.querySelector(".actions button:last-child") ?? document.getElementById("view")).focus();
  }

  removeAll(runs, onShown = () => {}) {
    for (const { id } of runs) selected.delete(id);
    removeLater(runs, async (isBack) => {
      if (this.isGone) return;
      await this.refresh();
      onShown(isBack);
    });
  }

  showEmpty(n) {
    this.state.hidden = n > 0;
    this.list.hidden = n === 0;
    const isFiltered = ["status", "model", "label", "search", "study", "cursor"].some((name) => this.query.get(name));
    const what = n > 0 ? "" : isFiltered ? "filtered" : "first";
    if (what === this.emptyShown) return; // so that its button keeps the focus
    this.emptyShown = what;
    if (what === "first") this.state.replaceChildren(...firstVisit());
    if (what === "filtered") {
      this.state.replaceChildren(h("p", {}, "No run matches."), link("#/", "Show all runs", { class: "button" }));
    }
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
    applyToRun(row.run, kind, event);
    row.show(row.run);
    if (kind === "end") this.refresh();
  }
}
