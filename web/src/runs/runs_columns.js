// The columns of the list of runs: what they are called, by what the server sorts them, and what they say of a run. They
// stand in one table, from which headers and cells follow.

import { fixed, modelOf, modelWords, number, percent, quantity, span } from "../base/format.js";
import { residenceOf } from "../run/key_figures.js";

function count(parts) {
  const isCounted = Math.abs(parts - Math.round(parts)) < 0.05 || parts >= 1000;
  return isCounted ? number(Math.round(parts), 6) : fixed(parts, 1);
}

// Of a density some billionths of a part may seem to leave, or to come.
function whole(value) {
  return value === undefined ? undefined : Math.round(value) + 0;
}

function progressText(run) {
  const share = () => percent(Math.floor(run.progress * 100) / 100);
  if (run.status === "queued") return "waiting";
  if (run.status === "running") return `${share()}${run.eta_s > 0 ? `, ${span(run.eta_s)} left` : ""}`;
  if (run.status === "succeeded") {
    return run.started_at ? `done in ${span((Date.parse(run.finished_at) - Date.parse(run.started_at)) / 1000)}` : "done";
  }
  return `${run.status === "failed" ? "failed" : "stopped"} at ${share()}`;
}

// "belt speed" is headed "Belt speed".
export const titleOfLabel = (label) => label[0].toUpperCase() + label.slice(1);

const figure = (name, sort, title, text) => ({ name, sort, title, kind: "right", text: ({ key_figures: figures }) => (figures ? text(figures) : "–") });

// sort: the server's word for it, or none; begins: whether a press on the header shows the largest first; kind: classes of its
// cells, minor ones being left out where there is no room.
export const columns = [
  { name: "Run", sort: "name" },
  { name: "Model", sort: "model", text: (run) => modelOf(run, modelWords) },
  { name: "State", sort: "status" },
  { name: "Progress", kind: "progress", text: progressText },
  figure("Parts through", null, "Parts that left the belt, of those at the start and those that entered",
    ({ parts }) => (parts ? `${count(parts.left)} of ${count(parts.entered)}` : "–")),
  { ...figure("Sustained throughput", "sustained_throughput_per_h", "Parts per hour while parts came through",
    (figures) => quantity(whole(figures.sustained_throughput_per_h), "/h", 4)), begins: "-" },
  figure("Drained at", "drained_at_s", "Since when the belt has been empty", (figures) => quantity(figures.drained_at_s, "s")),
  { ...figure("Residence", "residence_s.p95", "95 % of the parts stayed no longer on the belt", (figures) => quantity(residenceOf(figures), "s")),
    kind: "right minor" },
  { ...figure("Peak", "peak_density", "Largest density, 100 % being close packing",
    (figures) => (figures.peak_density === undefined ? "–" : percent(figures.peak_density))), begins: "-", kind: "right minor" },
  { name: "Age", sort: "created", begins: "-" },
];
