// The axes of all plots.

import { number } from "../base/format.js";
import { color } from "../base/theme.js";

// An axis as uPlot wants it; size: CSS pixels, or a function of the plot and its texts that gives them.
export function axisOf(label, size) {
  return {
    label, size, values: (u, ticks) => ticks.map((value) => (value === null ? null : number(value, 6))), labelSize: 18, labelGap: 0, gap: 4, stroke: color("muted"), font: "11px system-ui, sans-serif",
    labelFont: "12px system-ui, sans-serif",
    grid: { stroke: color("grid"), width: 1 }, ticks: { stroke: color("grid"), width: 1, size: 4 },
  };
}

// Letters of the longest of an axis' texts.
export function longest(texts) {
  return Math.max(0, ...(texts ?? []).map((text) => text?.length ?? 0));
}
