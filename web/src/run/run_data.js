// Everything about one run that views show: its document, scenario, snapshots and curve; filled from the
// results of a run that has ended, or by the events of one that has not.

import { getJson, isBusy, isOver, LATER_MS, paths } from "../base/api.js";
import { applyToRun } from "../base/events.js";
import { cargoOf } from "../scenario/cargo.js";

// Values from an index on; what stood there is gone.
function replaceFrom(list, first, values) {
  list.length = Math.min(first, list.length);
  for (const value of values) list.push(value);
}

export class RunData {
  constructor(id) {
    this.id = id;
    this.run = null;
    this.scenario = null;
    this.summary = null;
    this.figures = null; // the key figures so far
    this.grid = null; // { origin_m, cell_m, shape }; not known before there is a snapshot
    this.parts = null; // { rows, columns, cargo }
    this.snapshots = [];
    this.columns = null; // what loads the columns of parts, while it does
    this.curve = { t: [], columns: new Map() };
    this.actions = []; // that photo eyes commanded, { t_s, action }
    this.drives = []; // of obstacles that cargo holds back, { t_s, obstacle, state, turn_deg, shift_m }
    this.onChange = () => {}; // (what) => ..., what is "run", "curve", "snapshots", "figures" or "summary"
  }

  async load() {
    const [run, scenario] = await Promise.all([
      getJson(paths.run(this.id)),
      getJson(paths.of(this.id, "scenario")),
    ]);
    Object.assign(this, { run, scenario });
    if (isOver(run)) await this.loadResults();
  }

  // The cells of a snapshot: they are fitted to the domain.
  gridOfShape(shape) {
    const { x_m: [x0, x1], y_m: [y0, y1] } = this.scenario.domain;
    this.grid = { origin_m: [x0, y0], cell_m: [(x1 - x0) / shape[1], (y1 - y0) / shape[0]], shape };
  }

  async loadResults() {
    const { obstacles, actions: told } = this.scenario;
    const moves = told || obstacles.some(({ motion, present }) => motion || present);
    const [list, curve, { actions, drives }] = await Promise.all([
      getJson(paths.of(this.id, "snapshots")),
      getJson(paths.of(this.id, "curve")),
      moves ? getJson(paths.of(this.id, "photo_eyes")) : { actions: [], drives: [] },
    ]);
    replaceFrom(this.actions, 0, actions);
    replaceFrom(this.drives, 0, drives);
    this.takeList(list);
    this.takeCurve({ first: 0, ...curve });
    this.onChange("snapshots");
    this.onChange("curve");
    await this.loadSummary();
  }

  // A run that failed or never began has none; when no answer comes, refresh() asks again. A busy server is asked again later.
  async loadSummary() {
    try {
      this.summary = await getJson(paths.of(this.id, "summary"));
      this.figures = this.summary.key_figures ?? this.figures;
    } catch (error) {
      if (isBusy(error)) setTimeout(() => this.loadSummary(), LATER_MS);
      else if (![0, 404, 409].includes(error.status)) throw error;
    }
    this.onChange("summary");
  }

  takeList({ grid, parts, kinds, snapshots }) {
    if (grid) this.grid = grid;
    if (parts) this.takeParts(parts, kinds);
    this.snapshots = snapshots;
  }

  takeParts(parts, kinds) {
    this.parts = { ...parts, cargo: cargoOf(this.scenario, kinds) };
  }

  takeCurve({ first, t_s: times, columns }) {
    replaceFrom(this.curve.t, first, times);
    for (const [name, values] of Object.entries(columns)) {
      if (!this.curve.columns.has(name)) this.curve.columns.set(name, []);
      replaceFrom(this.curve.columns.get(name), first, values);
    }
  }

  // An event of this run.
  async take(kind, event) {
    applyToRun(this.run, kind, event);
    if (kind === "curve") this.takeCurve(event);
    if (kind === "action") this.actions.push(event);
    if (kind === "drive") this.drives.push(event);
    if (kind === "snapshot") await this.takeSnapshot(event);
    if (kind === "figures") this.figures = event.key_figures;
    if (kind === "gap") await this.refresh({ isGap: true });
    this.onChange({ curve: "curve", snapshot: "snapshots", figures: "figures" }[kind] ?? "run");
    if (kind === "end") await this.loadSummary();
  }

  // After a lost connection: the run may have ended, or be waiting again. Events bring the rest, but for those that a gap has lost.
  async refresh({ isGap = false } = {}) {
    try {
      Object.assign(this.run, await getJson(paths.run(this.id)));
      this.onChange("run");
      if (isGap || isOver(this.run)) await this.loadResults();
    } catch (error) {
      if (isBusy(error)) setTimeout(() => this.refresh({ isGap }), LATER_MS);
      else if (error.status !== 0) throw error; // away again
    }
  }

  async takeSnapshot(event) {
    if (this.snapshots.length > event.n) return;
    this.snapshots.push(event);
    if (!this.grid) this.gridOfShape(event.shape);
    if (!event.parts_url || this.parts) return;
    this.columns ??= this.loadColumns();
    await this.columns;
  }

  // The columns of parts come with the list, which is asked for until it has come; not again while an answer is on its way.
  async loadColumns() {
    try {
      const { parts, kinds } = await getJson(paths.of(this.id, "snapshots"));
      if (parts) this.takeParts(parts, kinds);
    } catch (error) {
      if (error.status === undefined) throw error; // an answer that did not come, or was refused: the next snapshot asks again
    } finally {
      this.columns = null;
    }
  }

  // When a part entered, as exactly as the curve has samples: ids are in the order of entering, from those of the start on.
  enteredAt(id) {
    const admitted = [...this.curve.columns].filter(([name]) => name.endsWith(".admitted")).map(([, values]) => values);
    const start = Math.round(this.snapshots[0]?.mass ?? 0);
    if (admitted.length === 0 || id < start) return 0;
    const k = this.curve.t.findIndex((t, at) => admitted.reduce((sum, values) => sum + values[at], start) > id);
    return this.curve.t[k] ?? this.curve.t.at(-1) ?? 0;
  }

  peak() {
    return this.snapshots.reduce((most, { peak }) => Math.max(most, peak), 0);
  }

  // About how many bytes a picture has; without feeds each snapshot has a row for each part of the start.
  frameBytes(layer) {
    const [rows, columns] = this.grid?.shape ?? [0, 0];
    const density = layer === "parts" ? 0 : 4 * rows * columns;
    const inside = this.snapshots.at(-1)?.mass ?? 0;
    const parts = layer === "density" || !this.parts ? 0 : 8 * (this.parts.rows ?? inside) * this.parts.columns.length;
    return density + parts;
  }

  hasParts() {
    return this.run.model === "micro";
  }

  dispose() {
    this.onChange = () => {};
  }
}
