// One run: the animation, the outflow curve beside it, and below the results. Live while it is solved.

import { annotate } from "../actions/annotate.js";
import { shareButton } from "../actions/grants.js";
import { saveReport } from "../actions/report.js";
import { cancel, removeLater } from "../actions/run_actions.js";
import { isGuest } from "../base/access.js";
import { isOver, patch, paths } from "../base/api.js";
import { onConnection } from "../base/connection.js";
import { h, iconButton, link, setText } from "../base/dom.js";
import { follow } from "../base/events.js";
import { age, fileNameOf, modelOf, nameOf, percent, span } from "../base/format.js";
import { address, go } from "../base/router.js";
import { lineLink, statePill, suspicion } from "../base/run_words.js";
import { DASHES, prefersStillness } from "../base/theme.js";
import { tellFault } from "../base/toast.js";
import { Cinema } from "../player/cinema.js";
import { drawPicture } from "../player/picture.js";
import { keyOf } from "../player/scale_bar.js";
import { SceneControls } from "../player/scene_controls.js";
import { segments } from "../player/transport.js";
import { CurvePlot } from "../plot/curve_plot.js";
import { contentOf, fallsOf, flowOf, isFed } from "../plot/series.js";
import { KeyFiguresPanel } from "./key_figures.js";
import { KeyStrip } from "./key_strip.js";
import { RunData } from "./run_data.js";
import { DownloadsPanel, scenarioPanel, summaryPanel, verdictLines, verdictPanel } from "./run_panels.js";

const REPLAYED_BELOW_S = 15; // a run that was over sooner is shown again from its start

export class RunView {
  constructor() {
    this.title = "Run";
  }

  async mount(root, { argument: id, query }) {
    this.query = query;
    this.data = new RunData(id);
    this.cinema = new Cinema();
    root.append(h("p", { class: "loading" }, "Loading …"));
    await this.data.load();
    if (this.isGone) return;
    root.replaceChildren(...this.build());
    this.start();
  }

  unmount() {
    this.isGone = true;
    this.stopEvents?.();
    this.stopConnection?.();
    this.plot?.dispose();
    this.controls?.dispose();
    this.cinema?.dispose();
  }

  build() {
    const { cinema, data } = this;
    const name = nameOf(data.run);
    this.title = name;
    this.controls = new SceneControls(cinema, this.query, {
      headingsOf: () => [[name, `${modelOf(data.run)} model`]],
      fileWords: [name, data.run.model],
    });
    this.screen = cinema.add(data, `The belt from above, ${name}`, () => Math.max(220, innerHeight * 0.62));
    this.plot = new CurvePlot(`Outflow curve of ${name}`, () => this.plotHeight(), (t) => cinema.player.seek(t));
    this.downloads = new DownloadsPanel(data, () => this.controls.save());
    this.figures = new KeyFiguresPanel();
    this.strip = new KeyStrip();
    this.summary = h("div", {}, summaryPanel(data));
    this.overview = verdictPanel();
    return [this.head(), this.overview, this.strip.element, h("div", { class: "watch" },
      h("div", {}, this.animation(), this.figures.element, this.summary, scenarioPanel(data)),
      h("div", {}, this.curveCard = this.curve(), this.downloads.element))];
  }

  head() {
    const { run } = this.data;
    this.state = statePill(run);
    this.progress = h("span", { class: "figures" });
    this.bar = h("progress", { max: "1", "aria-label": "Progress" });
    this.cancelButton = iconButton("stop", "Cancel", () => cancel(run), { shown: true });
    const remove = iconButton("trash", "Delete", () => {
      removeLater(run, () => {});
      go("#/");
    }, { shown: true });
    [this.nameText, this.labelText, this.notesText] = [h("h1", {}), h("span", { class: "label" }), h("p", { class: "hint" })];
    this.lineText = h("span", { class: "of-line" });
    this.starButton = iconButton("star", "Star", () => this.keep({ starred: this.data.run.starred !== true }).catch(tellFault), { class: "star" });
    this.showNames();
    const report = iconButton("download", "Save report", () => this.report(), { shown: true });
    return h("div", { class: "view-head" },
      h("div", { class: "heading" }, this.nameText,
        h("p", { class: "meta" }, this.state.pill, this.bar, this.progress,
          h("span", { class: "model", data: { model: run.model } }, modelOf(run)), this.lineText, this.labelText,
          h("time", { datetime: run.created_at }, age(run.created_at))), this.notesText,
        h("p", { class: "fault", role: "status", hidden: !run.suspect }, suspicion)),
      h("div", { class: "actions" }, isGuest() ? report : [
        this.starButton, h("button", { type: "button", on: { click: () => this.rename() } }, "Rename …"), report, shareButton("runs", run.id),
        link(address("compare", "", { runs: run.id }), "Compare", { class: "button" }), this.cancelButton, remove]));
  }

  showNames() {
    const { run } = this.data;
    this.title = nameOf(run);
    setText(this.nameText, this.title);
    for (const [element, text] of [[this.labelText, run.label], [this.notesText, run.notes]]) {
      setText(element, text ?? "");
      element.hidden = !text;
    }
    this.lineText.replaceChildren(...lineLink(run));
    this.starButton.setAttribute("aria-pressed", String(run.starred === true));
  }

  // What is missing in the answer is not there any more.
  async keep(changes) {
    const { notes = "", line = "", starred = false, ...run } = await patch(paths.run(this.data.run.id), changes);
    Object.assign(this.data.run, run, { notes, line, starred });
    this.showNames();
  }

  rename() {
    const { name, label, line = "", notes = "" } = this.data.run;
    annotate({ name, label, line, notes }, (changes) => this.keep(changes));
  }

  // The picture is the one that is seen.
  report() {
    const scene = this.controls.scene();
    saveReport({ title: this.title, name: `${fileNameOf(this.title, this.data.run.model)}.html`,
      pieces: [this.overview, this.strip.element, scene.stages.length > 0 ? drawPicture(scene) : null, this.curveCard, this.figures.element, this.summary] });
  }

  animation() {
    const { cinema, screen, data } = this;
    const [row, scale] = this.controls.build("Shown");
    this.wait = h("p", { class: "stage-wait", role: "status" });
    return h("section", { class: "card animation", "aria-label": "Animation" },
      row, h("div", { class: "stage-box" }, screen.stage.element, this.wait),
      cinema.transport.element, scale, keyOf(data.scenario, data.hasParts()));
  }

  curve() {
    const hasFlow = isFed(this.data.scenario);
    this.shown = hasFlow ? "flow" : "content";
    const choice = segments("Curves", [["flow", "Flow"], ["content", "Content"]], this.shown, (shown) => {
      this.shown = shown;
      this.showCurve();
    });
    const title = h("h2", { id: "curve-title" }, hasFlow ? "Curves" : "Outflow");
    return h("section", { class: "card curve", "aria-labelledby": "curve-title" },
      hasFlow ? h("div", { class: "card-head" }, title, choice.element) : title,
      h("p", { class: "hint" }, hasFlow
        ? "Flow: parts that were due, that entered, that wait and that left. Content: parts in each counter. "
        : "Parts in each counter, and parts that have left the belt. ", "Press or drag to move in time."),
      this.plot.element);
  }

  plotHeight() {
    return innerWidth < 1000 ? 240 : 330;
  }

  start() {
    const { data, cinema } = this;
    cinema.onUpdate = () => this.update();
    data.onChange = (what) => this.change(what);
    const isLive = !isOver(data.run);
    cinema.refresh();
    this.showHead();
    this.showCurve();
    this.controls.show();
    this.showFigures();
    if (isLive) this.goLive();
    cinema.begin(this.query);
  }

  goLive() {
    const { data } = this;
    this.stopEvents = follow([data.id], (kind, event) => data.take(kind, event));
    this.stopConnection = onConnection((isAway) => {
      if (!isAway && !this.isGone) data.refresh();
    });
  }

  change(what) {
    const { data } = this;
    if (this.isGone) return;
    if (what === "curve") this.showCurve();
    if (what === "snapshots") this.showSnapshots();
    if (what === "run") this.showHead();
    if (what === "figures") this.showFigures();
    if (what === "snapshots" || what === "curve") this.strip.show(data);
    if (what === "summary") this.finish();
    this.controls.show();
  }

  // The axes of time grow with what there is.
  showSnapshots() {
    const before = this.cinema.axisEnd;
    this.cinema.refresh();
    if (this.cinema.axisEnd !== before) this.showCurve();
  }

  // The results are complete. A short run that was watched live is shown again.
  finish() {
    const { data, cinema } = this;
    const wasFollowing = cinema.player.isFollowing;
    const took = (Date.parse(data.run.finished_at) - Date.parse(data.run.started_at)) / 1000;
    this.showFigures();
    this.summary.replaceChildren(summaryPanel(data));
    this.showHead();
    cinema.refresh();
    this.showCurve();
    if (wasFollowing && took < REPLAYED_BELOW_S && !prefersStillness()) cinema.player.play();
  }

  showFigures() {
    this.overview.replaceChildren(...verdictLines(this.data.summary?.verdicts));
    this.overview.hidden = this.overview.childElementCount === 0;
    this.strip.show(this.data);
    this.figures.show(this.data.figures, isFed(this.data.scenario));
  }

  showHead() {
    const { run } = this.data;
    this.state.show(run);
    const isRunning = run.status === "running";
    this.bar.hidden = !isRunning;
    this.bar.value = run.progress;
    const rest = run.eta_s > 0 ? `, ${span(run.eta_s)} left` : "";
    setText(this.progress, isRunning ? `${percent(Math.floor(run.progress * 100) / 100)}${rest}` : "");
    this.cancelButton.hidden = isOver(run);
  }

  showCurve() {
    const { curve, scenario, run, snapshots } = this.data;
    const rows = this.shown === "flow" ? flowOf(scenario, curve) : [...contentOf(scenario, curve), ...(isFed(scenario) ? [] : fallsOf(curve))];
    const curves = rows.map(([name, v], k) => ({ name, color: `run-${(k % 8) + 1}`, dash: DASHES[k % 8], t: curve.t, v }));
    if (!isFed(scenario)) {
      curves.push({ name: "left the belt", color: "muted", dash: [2, 4], t: curve.t, v: curve.columns.get("left_domain") ?? [] });
    }
    const end = isOver(run) ? Math.max(curve.t.at(-1) ?? 0, snapshots.at(-1)?.t_s ?? 0) : this.cinema.axisEnd;
    this.plot.setCurves(curves.filter(({ v }) => v.length > 0), end || scenario.duration_s);
  }

  update() {
    const { player } = this.cinema;
    this.plot.showTime(player.t);
    this.downloads.show(player.indexOf(player.t));
    setText(this.wait, this.waitText(this.screen));
    this.wait.hidden = this.wait.textContent === "";
  }

  waitText({ reel, stage }) {
    const { run, snapshots } = this.data;
    const problem = reel.problemAt(this.cinema.player.t);
    if (problem) return problem.message;
    if (run.status === "queued") return "Waiting for its turn …";
    if (snapshots.length === 0) return run.study ? "Trials keep no snapshots: press its point in the study." : isOver(run) ? "There are no snapshots." : "Waiting for the first snapshot …";
    return stage.picture === null ? "Loading …" : "";
  }
}
