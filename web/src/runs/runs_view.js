// The list of runs: updated by events, filtered, paged by the API's cursor, with studies between them.

import { cancel, isGoing, removeLater } from "../actions/run_actions.js";
import { getJson, isOver, listRuns, patch, paths, states } from "../base/api.js";
import { onConnection } from "../base/connection.js";
import { h, link, setText } from "../base/dom.js";
import { applyToRun, follow } from "../base/events.js";
import { address } from "../base/router.js";
import { tellFault } from "../base/toast.js";
import { nameOfStudy } from "../study/study_words.js";
import { firstVisit } from "./first_visit.js";
import { columns } from "./runs_columns.js";
import { byVersion, grouped, MoreRow, StudyRow, VersionRow } from "./runs_groups.js";
import { parameterOf, RunsHead, sortedBy } from "./runs_head.js";
import { RunRow } from "./runs_table.js";
import { Tray } from "./runs_tray.js";
import { searchOf } from "./search_words.js";
import { selected } from "./selection.js";
import { Variants } from "./variants.js";

const PERIOD_MS = 2000;
const WHERE_PERIOD_MS = 10000; // the daemon reads the scenarios of many runs for it
const LIMIT = 50;
const FILTERS = ["study", "status", "model", "label", "line", "owner", "starred", "from", "to"]; // of the address, but for the search

// The beginning of a day, or of the one so many days later, as the API takes it; "" without a day.
function midnight(day, daysLater = 0) {
  const [, year, month, date] = /^(\d+)-(\d+)-(\d+)$/.exec(day)?.map(Number) ?? [];
  return year === undefined ? "" : new Date(year, month - 1, date + daysLater).toISOString();
}

export class RunsView {
  constructor() {
    this.title = "Runs";
    this.rows = new Map();
    this.others = new Map(); // rows of studies, and of what they do not show
    this.known = new Map();
    this.labels = [];
    this.variants = new Variants((labels, known) => this.showVariants(labels, known));
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
    const [line, owner] = [this.query.get("line"), this.query.get("owner")];
    return h("div", { class: "view-head" }, h("div", { class: "heading" }, h("h1", {}, line ? `${line} ` : "Runs ", this.total),
      line ? h("p", { class: "meta" }, `A line${owner ? ` of ${owner}` : ""} and its versions. `, link("#/lines", "All lines"), link("#/", "All runs")) : null),
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
    this.searchBox = h("input", { type: "search", placeholder: "name, label, line, or angle > 50", autocomplete: "off", spellcheck: "false", maxlength: "100",
      on: { input: () => {
        clearTimeout(timer);
        timer = setTimeout(() => this.filter({ search: this.searchBox.value.trim() }, true), 300);
      } } });
    this.searchBox.value = this.query.get("search") ?? "";
    this.searchFault = h("span", { class: "fault", role: "status" });
    this.studies = h("span", { class: "row" });
    this.offerStudies().catch(() => {}); // without them there is one choice less
    return h("form", { class: "filters", role: "search", "aria-label": "Filter runs",
      on: { submit: (event) => event.preventDefault() } },
    h("label", { class: "field inline" }, h("span", {}, "Search"), this.searchBox), this.searchFault,
    this.folded(this.choice("status", "State", plain(states)), this.choice("model", "Model", plain(["macro", "micro"])),
    this.choice("starred", "Show", [["1", "starred"]]), this.day("from", "From"), this.day("to", "to"), this.sorting(), this.studies));
  }

  // On small screens, unless one of them is set.
  folded(...filters) {
    const isSet = [...FILTERS, "sort"].some((name) => this.query.get(name));
    return h("details", { open: isSet || matchMedia("(width > 640px)").matches }, h("summary", {}, "Filters and order"),
      h("div", { class: "filters" }, filters));
  }

  // A day in the reader's own time, the first or the last one that counts.
  day(name, label) {
    const box = h("input", { type: "date", on: { change: () => this.filter({ [name]: box.value }) } });
    box.value = this.query.get(name) ?? "";
    return h("label", { class: "field inline" }, h("span", {}, label), box);
  }

  sorting() {
    const element = this.choice("sort", "Sort by", columns.filter(({ sort }) => sort)
      .map(({ name, sort, begins = "" }) => [`${begins}${sort}`, name.toLowerCase()]), "newest first");
    element.classList.add("sorting");
    element.querySelector("select").addEventListener("change", () => this.header.showSorting(this.query.get("sort")));
    return element;
  }

  // The runs of one study's trials, by themselves.
  async offerStudies() {
    const { studies } = await getJson("v1/studies?limit=50");
    const id = this.query.get("study");
    if (this.isGone || (studies.length === 0 && !id)) return;
    const known = studies.map((study) => [study.id, nameOfStudy(study)]);
    if (id && !known.some(([one]) => one === id)) known.push([id, `Study ${id.slice(-8)}`]);
    this.studies.replaceChildren(this.choice("study", "Study", known, "grouped"),
      ...(id ? [link(address("studies", id), "Show the study")] : []));
  }

  // Another filter begins at the newest run again, in the same view so that the field keeps its focus.
  filter(change, isTyped = false) {
    this.move({ cursor: "", ...change }, [], isTyped);
    if ("study" in change) this.offerStudies().catch(() => {});
  }

  sortBy(sort) {
    this.filter({ sort });
    this.header.showSorting(sort);
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
    this.header = new RunsHead((sort) => this.sortBy(sort));
    this.header.showSorting(this.query.get("sort"));
    this.list = h("table", { class: this.query.get("line") ? "runs of-one-line" : "runs", role: "table", hidden: true }, this.header.element, this.body);
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
      const { entries, cursor, total } = await this.load({ signal: abort.signal });
      if (this.isGone || abort.signal.aborted) return;
      this.next = cursor;
      setText(this.total, total === undefined ? "" : String(total.toLocaleString("en")));
      this.show(entries);
    } catch (error) {
      if (error.name === "AbortError" || this.isGone) return;
      this.explain(error);
    }
    const period = searchOf(this.query.get("search") ?? "").where ? WHERE_PERIOD_MS : PERIOD_MS;
    if (!document.hidden) this.timer = setTimeout(() => this.refresh(), period);
  }

  // A page of the list. Studies stand between the newest runs; other orders and filters are of single runs.
  async load(options) {
    const { open = "", search: typed = "", sort = "", cursor = "", from = "", to = "", ...rest } = Object.fromEntries(this.query);
    const { search, where, fault } = searchOf(typed);
    setText(this.searchFault, fault);
    if (fault) return { entries: [], cursor: null };
    const query = { ...rest, created_from: midnight(from), created_before: midnight(to, 1) };
    const order = parameterOf(sort) === null ? sort : "";
    const page = await listRuns({ limit: LIMIT, count: 1, ...query, search, where, sort: order, cursor }, options);
    const isGrouped = !where && ![...FILTERS, "sort"].some((name) => this.query.get(name));
    if (rest.line && !sort) return { ...page, entries: await byVersion(page.runs, { line: rest.line, owner: rest.owner ?? "", after: cursor, open: open.split(",") }, options) };
    const entries = isGrouped ? await grouped(page, { after: cursor, open: open.split(","), search }, options)
      : page.runs.map((run) => ({ run }));
    return { ...page, entries };
  }

  // An open study shows the runs of its trials; which ones are stands in the address.
  toggle({ id }) {
    const open = (this.query.get("open") ?? "").split(",").filter(Boolean);
    this.move({ open: (open.includes(id) ? open.filter((one) => one !== id) : [...open, id]).join(",") }, this.trail, true);
  }

  explain(error) {
    if (this.rows.size > 0 && error.status === 0) return; // the banner says it
    this.body.replaceChildren();
    this.rows.clear();
    this.others.clear();
    this.list.hidden = true;
    this.state.hidden = false;
    this.emptyShown = "fault";
    this.state.replaceChildren(h("p", { class: "fault" }, error.message));
  }

  show(entries) {
    this.entries = entries.filter(({ run }) => !run || !isGoing(run.id));
    const runs = this.entries.flatMap(({ run }) => run ?? []);
    this.newer.hidden = !this.query.get("cursor");
    setText(this.newer, this.trail.length > 0 ? "← Newer" : "← Newest");
    this.older.hidden = this.next === null;
    this.showRows();
    this.showSelection();
    this.showEmpty(this.entries.length);
    this.variants.want(runs);
    this.followActive(runs);
  }

  isWhole() {
    return this.next === null && !this.query.get("cursor");
  }

  showVariants(labels, known) {
    Object.assign(this, { labels, known });
    if (!this.isGone) this.showRows();
  }

  // Rows stay where they are the same, so that the focus does.
  showRows() {
    this.header.showParameters(this.labels, this.isWhole());
    const sort = this.query.get("sort");
    const k = this.labels.indexOf(parameterOf(sort));
    const entries = k < 0 || !this.isWhole() ? this.entries : sortedBy(this.entries, sort, ({ run }) => this.known.get(run.id)?.values[k]);
    const rows = entries.map((entry) => this.rowOf(entry));
    for (const map of [this.rows, this.others]) {
      for (const [id, row] of map) {
        if (rows.includes(row)) continue;
        row.element.remove();
        map.delete(id);
      }
    }
    rows.forEach(({ element }, at) => {
      if (this.body.children[at] !== element) this.body.insertBefore(element, this.body.children[at] ?? null);
    });
  }

  rowOf(entry) {
    const { run, study, version, more } = entry;
    const other = (id, make) => this.others.get(id) ?? this.others.set(id, make()).get(id);
    if (more) {
      const row = other(more.href, () => new MoreRow(more));
      row.show(this.labels.length);
      return row;
    }
    if (version) {
      const row = other(version.id, () => new VersionRow(version));
      row.show(version, this.labels.length);
      return row;
    }
    if (!run) {
      const row = other(study.id, () => new StudyRow(study, (one) => this.toggle(one)));
      row.show(entry, this.labels.length);
      return row;
    }
    return this.rowOfRun(run, study);
  }

  rowOfRun(run, study) {
    let row = this.rows.get(run.id);
    if (!row) {
      row = new RunRow(run, {
        onStar: (current) => this.star(current),
        onCancel: (current) => cancel(current).then(() => this.refresh()),
        onRemove: (current) => this.remove(current),
        onSelect: (current, isChosen) => this.select(current, isChosen),
      });
      this.rows.set(run.id, row);
    }
    row.element.classList.toggle("of-study", study !== undefined);
    row.show(run);
    row.showVariant(this.labels, this.known.get(run.id) ?? { texts: this.labels.map(() => "–"), chips: [] });
    if (selected.has(run.id)) selected.set(run.id, run);
    return row;
  }

  async star(run) {
    try {
      const { starred = false } = await patch(paths.run(run.id), { starred: run.starred !== true });
      this.rows.get(run.id)?.show({ ...run, starred });
      if (this.query.get("starred")) await this.refresh();
    } catch (error) {
      tellFault(error);
    }
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
    const isFiltered = [...FILTERS, "search", "cursor"].some((name) => this.query.get(name));
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
