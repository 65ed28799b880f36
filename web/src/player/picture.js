// What is seen, as one picture for a report: each belt with its name and time, and the scale of colours.

import { h } from "../base/dom.js";
import { saveBlob } from "../base/files.js";
import { number } from "../base/format.js";
import { color } from "../base/theme.js";
import { cssColor } from "./colormap.js";
import { niceStep, ticksOf } from "./scenery.js";

const GAP = 16; // CSS pixels, as all here
const HEAD = 44; // above a belt
const SCALE = 64; // below them all
const BAND = { left: 46, most: 420, height: 12 };

const columnsOf = (n) => (n < 3 ? n : n < 5 ? 2 : 4);

// Where each stage stands, and the size of all, in device pixels.
function layOut({ stages, scale }) {
  const { ratio } = stages[0].stage.view;
  const columns = columnsOf(stages.length);
  const width = Math.max(...stages.map(({ stage }) => stage.view.width));
  const height = Math.max(...stages.map(({ stage }) => stage.view.height)) + HEAD * ratio;
  const rows = Math.ceil(stages.length / columns);
  const even = (n) => 2 * Math.ceil(n / 2); // as films ask for
  return { ratio, width: even(columns * (width + GAP * ratio) + GAP * ratio),
    height: even(rows * (height + GAP * ratio) + (GAP + (scale ? SCALE : 0)) * ratio),
    places: stages.map((stage, k) => [GAP * ratio + (k % columns) * (width + GAP * ratio),
      GAP * ratio + Math.floor(k / columns) * (height + GAP * ratio)]) };
}

// most: how wide the text may be; what is longer is cut.
function write(context, text, x, y, ratio, { size = 12, weight = 400, fill = "text", align = "left", most = Infinity } = {}) {
  context.font = `${weight} ${size * ratio}px system-ui, sans-serif`;
  context.fillStyle = color(fill);
  context.textAlign = align;
  context.textBaseline = "top";
  let shown = text;
  while (context.measureText(shown).width > most && shown.length > 1) shown = `${shown.slice(0, -2)}…`;
  context.fillText(shown, x, y);
}

function drawScale(context, { map, end, packing }, y, width, ratio) {
  const length = Math.min(BAND.most * ratio, width - 2 * BAND.left * ratio);
  const x = BAND.left * ratio;
  const band = context.createLinearGradient(x, 0, x + length, 0);
  for (let k = 0; k <= 16; k++) band.addColorStop(k / 16, cssColor(map, k / 16));
  context.fillStyle = band;
  context.fillRect(x, y + 18 * ratio, length, BAND.height * ratio);
  context.fillStyle = color("draw-over");
  context.fillRect(x + length + 2 * ratio, y + 18 * ratio, BAND.height * ratio, BAND.height * ratio);
  write(context, "above", x + length + (BAND.height + 8) * ratio, y + 17 * ratio, ratio, { fill: "muted" });
  for (const { value } of ticksOf(0, end * packing, 4)) {
    write(context, number(value, 6), x + (value / (end * packing)) * length, y, ratio, { fill: "muted", align: "center", size: 11 });
  }
  for (const { value, text } of ticksOf(0, end, Math.round(end / niceStep(end, 4)))) {
    write(context, text, x + (value / end) * length, y + 33 * ratio, ratio, { fill: "muted", align: "center", size: 11 });
  }
  write(context, "parts/m²", x + length + (BAND.height + 8) * ratio, y, ratio, { fill: "muted", size: 11 });
  write(context, "share of close packing", x + length + (BAND.height + 8) * ratio, y + 33 * ratio, ratio, { fill: "muted", size: 11 });
}

// scene: { stages: [{ stage, headings: [name, what it is], time }], scale: { map, end, packing } or null }. Returns the canvas.
export function drawPicture(scene, canvas = h("canvas")) {
  const { ratio, width, height, places } = layOut(scene);
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const context = canvas.getContext("2d");
  context.fillStyle = color("surface");
  context.fillRect(0, 0, width, height);
  scene.stages.forEach(({ stage, headings: [name, kind], time }, k) => {
    const [x, y] = places[k];
    const most = stage.view.width;
    write(context, name, x, y, ratio, { size: 15, weight: 600, most });
    write(context, `at ${time} · ${kind}`, x, y + 21 * ratio, ratio, { fill: "muted", most });
    stage.drawOn(context, x, y + HEAD * ratio);
  });
  if (scene.scale) drawScale(context, scene.scale, height - SCALE * ratio, width, ratio);
  return canvas;
}

export async function savePicture(scene, name) {
  saveBlob(await new Promise((resolve) => drawPicture(scene).toBlob(resolve, "image/png")), name);
}
