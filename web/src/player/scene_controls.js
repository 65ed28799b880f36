// How belts are drawn, for all stages under a clock: layers, colours and their range, zoom; noted in the address. And what is seen,
// as a file.

import { h, iconButton } from "../base/dom.js";
import { fileNameOf } from "../base/format.js";
import { note } from "../base/router.js";
import { maps, ranges } from "./colormap.js";
import { savePicture } from "./picture.js";
import { filmEnding, Recorder } from "./recorder.js";
import { ScaleBar } from "./scale_bar.js";
import { segments } from "./transport.js";

const layers = [["both", "Parts over density"], ["parts", "Parts"], ["density", "Density"]];

export class SceneControls {
  // cinema: with its stages to come; query: of the address; headingsOf(): [name, what differs] of each stage, for pictures;
  // fileWords: what files of pictures are called by, before their time.
  constructor(cinema, query, { headingsOf, fileWords }) {
    Object.assign(this, { cinema, headingsOf, fileWords });
    cinema.map = maps[query.get("map")] ? query.get("map") : "viridis";
    cinema.layer = layers.some(([layer]) => layer === query.get("layer")) ? query.get("layer") : undefined;
    cinema.range = ranges.some(([range]) => range === query.get("range")) ? query.get("range") : cinema.range;
    this.scale = new ScaleBar({
      onMap: (map) => this.change("map", map, "viridis", () => cinema.setMap(map)),
      onRange: (range) => this.change("range", range, "1.25", () => cinema.setRange(range)),
    });
    cinema.zoom.read(query.get("zoom"));
    cinema.onZoom = () => {
      clearTimeout(this.noting);
      this.noting = setTimeout(() => note({ zoom: cinema.zoom.text() }), 400);
    };
  }

  dispose() {
    clearTimeout(this.noting);
    this.recorder?.stop();
  }

  // The row of controls; label: what the choice of layers is called, for runs with parts.
  build(label) {
    const { cinema } = this;
    const hasParts = cinema.screens.some(({ data }) => data.hasParts());
    const choice = hasParts ? segments(label, layers, cinema.layer ?? "both",
      (layer) => this.change("layer", layer, "both", () => cinema.setLayer(layer))).element : null;
    this.film = filmEnding() ? iconButton("film", "Save film", () => this.record(), { shown: true }) : null;
    this.row = h("div", { class: "scene-row" }, choice, cinema.zoom.element,
      iconButton("download", "Save picture", () => this.save(), { shown: true }), this.film);
    return [this.row, this.scale.element];
  }

  change(name, value, usual, act) {
    act();
    note({ [name]: value === usual ? "" : value });
    this.show();
  }

  show() {
    const { cinema } = this;
    const { macro } = cinema.screens[0].data.scenario;
    this.scale.set({ map: cinema.map, range: cinema.range, end: cinema.scaleEnd(), packing: macro.packing_density_per_m2,
      isExceeded: cinema.peak() > cinema.scaleEnd() });
    this.scale.element.hidden = cinema.screens.every(({ reel }) => reel.layer === "parts");
  }

  // What picture.js draws: the stages as they are seen, with their headings and times, and the scale.
  scene() {
    const { cinema } = this;
    const { macro } = cinema.screens[0].data.scenario;
    return {
      stages: cinema.screens.map(({ stage }, k) => ({ stage, headings: this.headingsOf()[k],
        time: `${cinema.transport.textOf(stage.picture?.t ?? 0)} s` })).filter(({ stage }) => stage.view),
      scale: this.scale.element.hidden ? null : { map: cinema.map, end: cinema.scaleEnd(), packing: macro.packing_density_per_m2 },
    };
  }

  fileName(ending) {
    const { screens: [{ stage }], transport } = this.cinema;
    return `${fileNameOf(...this.fileWords)}-${transport.textOf(stage.picture?.t ?? 0)}s.${ending}`;
  }

  save() {
    return savePicture(this.scene(), this.fileName("png"));
  }

  // From here to the end, or until the button is pressed again.
  record() {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    this.recorder = new Recorder(() => this.scene(), this.cinema, this.fileName(filmEnding()), () => {
      this.recorder = null;
      this.film.lastChild.textContent = "Save film";
    });
    this.film.lastChild.textContent = "Stop the film";
  }
}
