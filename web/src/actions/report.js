// What a view says as one HTML file that needs nothing else: its sentences, pictures, curves and tables as they are seen, where it
// comes from and by which version. A browser prints it as PDF.

import { h, link } from "../base/dom.js";
import { saveBlob } from "../base/files.js";
import { moment } from "../base/format.js";

const CONTROLS = "button, select, input, label, .button, .segments, .transport, [hidden], .hidden, .scene-row, .scale, .drop, .row.hint, .of-screen, progress";

const STYLE = `body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1b2430;background:#fff}
h1{font-size:1.6rem}h2{font-size:1.15rem;margin-top:1.6rem}h3{font-size:1rem}img{max-width:100%;display:block}section{break-inside:avoid}
dl{display:grid;grid-template-columns:repeat(auto-fill,minmax(11rem,1fr));gap:.8rem}dl div{min-width:0}dt,.hint,small,figcaption,footer{color:#52606d;font-size:.85rem}
dd{margin:0}dd>span{display:block}small{margin:0 .4rem}.plot-legend{list-style:none;padding:0}.plot-legend b{margin-left:.4rem}ul{padding-left:1.2rem}table{border-collapse:collapse;width:100%}td,th{border-bottom:1px solid #d5dbe1;padding:.3rem .5rem;text-align:left;vertical-align:top}
.verdict{font-weight:600}footer{margin-top:2rem;border-top:1px solid #d5dbe1}pre{white-space:pre-wrap;font-size:.75rem}svg.icon{display:none}summary{list-style:none}summary .hint{margin-left:.5rem}svg path{stroke-width:3}`;

const place = (k) => h("span", { "data-drawing": String(k) });

// As it is seen now: addresses whole, without what can be pressed or speaks of that; drawings go to the list, and leave their places.
function stillOf(element, drawings) {
  const copy = element.cloneNode(true);
  const canvases = [...element.querySelectorAll("canvas")];
  copy.querySelectorAll("canvas").forEach((canvas, k) => canvas.replaceWith(place(drawings.push(canvases[k]) - 1)));
  const strokes = [...element.querySelectorAll("svg.stroke path")].map((path) => getComputedStyle(path).stroke);
  copy.querySelectorAll("svg.stroke path").forEach((path, k) => path.setAttribute("stroke", strokes[k]));
  for (const mark of copy.querySelectorAll("svg.stroke")) mark.setAttribute("width", "24");
  for (const part of copy.querySelectorAll("[style]")) part.removeAttribute("style");
  for (const anchor of copy.querySelectorAll("a[href]")) anchor.href = new URL(anchor.getAttribute("href"), location.href).href;
  for (const part of copy.querySelectorAll(CONTROLS)) part.remove();
  for (const fold of [copy, ...copy.querySelectorAll("details")]) if (fold.localName === "details") fold.open = true;
  return copy;
}

// title; pieces: elements of the view and canvases in their order; name: of the file.
export function saveReport({ title, pieces, name }) {
  const drawings = [];
  const isDrawing = (piece) => piece instanceof HTMLCanvasElement;
  const shown = pieces.filter((piece) => piece && !piece.hidden && (isDrawing(piece) || piece.childElementCount > 0));
  const version = document.getElementById("version").textContent;
  const body = h("body", {}, h("h1", {}, title),
    shown.map((piece) => (isDrawing(piece) ? place(drawings.push(piece) - 1) : stillOf(piece, drawings))),
    h("footer", {}, h("p", {}, `Beltflow ${version}, ${moment(new Date().toISOString())}: `, link(location.href, location.href))));
  // As text, since the page itself may load no image of this kind.
  const html = body.outerHTML.replace(/<span data-drawing="(\d+)"><\/span>/g, (_, k) =>
    (drawings[k].width > 0 ? `<img alt="" src="${drawings[k].toDataURL("image/png")}">` : ""));
  const head = `<head><meta charset="utf-8">${h("title", {}, title).outerHTML}<style>${STYLE}</style></head>`;
  saveBlob(new Blob([`<!DOCTYPE html>\n<html lang="en">${head}${html}</html>\n`], { type: "text/html" }), name);
}
