// One or several runs on stages under one clock: what is shown at a time, what is fetched for it, and the
// controls.

import { isOver } from "../base/api.js";
import { onConnection } from "../base/connection.js";
import { note } from "../base/router.js";
import { prefersStillness } from "../base/theme.js";
import { scaleEnd } from "./colormap.js";
import { Frames } from "./frames.js";
import { Player } from "./player.js";
import { Reel } from "./reel.js";
import { Stage } from "./stage.js";
import { Transport } from "./transport.js";
import { Zoom } from "./zoom.js";

// The end of the axes of time while a run is young: its duration, halved as often as what there is fits.
function axisEnd(duration, newest) {
  let end = duration;
  while (end / 2 >= newest && end > duration / 1000) end /= 2;
  return end;
}

export class Cinema {
  constructor() {
    this.player = new Player();
    this.frames = new Frames();
    this.transport = new Transport(this.player);
    this.screens = []; // { data, reel, stage, wait }
    this.map = "viridis";
    this.range = "1.25"; // of the colours; "peak": as far as the densities reach
    this.onZoom = () => {};
    this.zoom = new Zoom(() => this.showZoom());
    this.transport.onOtherKey = (event) => this.zoom.take(event);
    this.onUpdate = () => {};
    this.player.canShow = (t) => this.screens.every(({ reel }) => reel.isReady(t, this.isSmooth()));
    this.player.onTime = () => this.update();
    this.frames.onArrive = () => this.player.arrive();
    this.stopConnection = onConnection((isAway) => !isAway && this.update());
  }

  dispose() {
    clearTimeout(this.noting);
    this.stopConnection();
    this.player.dispose();
    this.transport.dispose();
    this.frames.dispose();
    for (const { stage, data } of this.screens) {
      stage.dispose();
      data.dispose();
    }
  }

  // Pictures between snapshots are mixed while the clock runs, unless less motion is asked for.
  isSmooth() {
    return this.player.isPlaying && !prefersStillness();
  }

  // A stage for a run whose scenario is there.
  add(data, label, most) {
    const screen = { data, reel: new Reel(data, this.frames), stage: new Stage(label, most) };
    screen.stage.onProbe = (isProbed) => {
      if (screen.reel.isProbed === isProbed) return;
      screen.reel.isProbed = isProbed;
      this.update();
    };
    this.screens.push(screen);
    screen.stage.setZoom(this.zoom);
    this.zoom.attach(screen.stage.frame, () => screen.stage.view);
    this.setScene(screen);
    return screen;
  }

  // Again when the parts of the run become known.
  setScene({ data, stage, reel }) {
    stage.setScene(data);
    stage.knowsParts = data.parts !== null;
    reel.layer = data.hasParts() ? this.layer ?? "both" : "density";
    stage.setStyle({ layer: reel.layer, map: this.map });
  }

  setLayer(layer) {
    this.layer = layer;
    for (const screen of this.screens) this.setScene(screen);
    this.update();
  }

  setMap(map) {
    this.map = map;
    for (const { stage } of this.screens) stage.setStyle({ map });
  }

  setRange(range) {
    this.range = range;
    this.update();
  }

  showZoom() {
    for (const { stage } of this.screens) stage.setZoom(this.zoom);
    this.onZoom();
  }

  // More snapshots are there, or the runs have ended.
  refresh() {
    for (const screen of this.screens) {
      if (screen.data.parts && !screen.stage.knowsParts) this.setScene(screen);
    }
    const lists = this.screens.map(({ data }) => data.snapshots.map(({ t_s: t }) => t));
    const longest = lists.reduce((best, list) => ((list.at(-1) ?? -1) > (best.at(-1) ?? -1) ? list : best), []);
    const isLive = this.screens.some(({ data }) => !isOver(data.run));
    const last = isLive ? Math.max(...this.screens.map(({ data }) => data.scenario.duration_s)) : longest.at(-1) ?? 0;
    this.axisEnd = isLive ? axisEnd(last, longest.at(-1) ?? 0) : last;
    this.transport.setRange(this.axisEnd, last, isLive);
    this.player.setTimes(longest);
    if (!isLive && this.player.isFollowing) this.player.seek(last);
  }

  // Where a view begins: at the time of its address, live, or from the start, unless less motion is asked for.
  begin(query) {
    const t = query.has("t") ? Number(query.get("t")) : NaN;
    if (Number.isFinite(t)) this.player.seek(t);
    else if (this.screens.some(({ data }) => !isOver(data.run))) this.player.follow(true);
    else if (!prefersStillness()) this.player.play();
    this.update();
  }

  // Notes the time in the address when the clock rests.
  noteTime() {
    clearTimeout(this.noting);
    const { t, times, isPlaying, isFollowing } = this.player;
    if (isPlaying || isFollowing || times.length === 0) return;
    this.noting = setTimeout(() => note({ t: String(Number(t.toFixed(6))) }), 400);
  }

  // The largest density of all.
  peak() {
    return Math.max(0, ...this.screens.map(({ data }) => data.peak()));
  }

  // The end of the colour scale, one for all.
  scaleEnd() {
    return this.range === "peak" ? scaleEnd(this.peak()) : Number(this.range);
  }

  update() {
    const { t } = this.player;
    const end = this.scaleEnd();
    const wanted = this.screens.map(({ reel }) => reel.wantedFrom(this.player.wanted()));
    const longest = Math.max(0, ...wanted.map((urls) => urls.length));
    const turns = Array.from({ length: longest }, (_, k) => wanted.map((urls) => urls[k])).flat();
    this.frames.want(turns.filter(Boolean));
    for (const { reel, stage } of this.screens) {
      const picture = reel.pictureAt(t, this.isSmooth());
      if (stage.setEnd(end) && !picture) stage.draw();
      if (picture) this.showPicture(stage, picture);
      stage.setStamp(this.transport.textOf(stage.picture?.t ?? 0), picture === null);
    }
    this.transport.update();
    this.noteTime();
    this.onUpdate();
  }

  showPicture(stage, picture) {
    const isFirst = stage.picture === null;
    stage.show(picture);
    if (!isFirst) return;
    performance.clearMarks("first-frame"); // the browser keeps every mark
    performance.mark("first-frame");
  }
}
