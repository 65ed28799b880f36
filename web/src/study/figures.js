// The figures that studies are made for: their words, what is better, and which difference hardly matters to a planner.

export const studied = [
  { figure: "sustained_throughput_per_h", goal: "maximize", indifference: 1000 },
  { figure: "drained_at_s", goal: "minimize", indifference: 0.2 },
  { figure: "residence_s.p95", goal: "minimize", indifference: 0.2 },
  { figure: "residence_s.mean", goal: "minimize", indifference: 0.1 },
  { figure: "peak_density", goal: "minimize", indifference: 0.02 },
  { figure: "jam.total_s", goal: "minimize", indifference: 0.5 },
  { figure: "content.mean", goal: "minimize", indifference: 2, of: "counters" },
  { figure: "content.max", goal: "minimize", indifference: 5, of: "counters" },
  { figure: "flow_per_h", goal: "maximize", indifference: 1000, of: "counters", isFed: true },
];

const words = {
  sustained_throughput_per_h: "Sustained throughput", throughput_per_h: "Throughput", drained_at_s: "Drained at",
  "residence_s.p95": "Residence, 95 %", "residence_s.mean": "Residence, mean",
  peak_density: "Peak density", "jam.total_s": "Time in jams", "content.mean": "Parts inside, mean", "content.max": "Parts inside, most",
  flow_per_h: "Flow",
};

// The names of what a study's document is about, ["sustained_throughput_per_h", "content.mean:upstream"].
export function figureNames({ objectives = [], curves = [] }) {
  return curves.length > 0 ? curves.map(({ counter }) => `mse:${counter}`)
    : objectives.map(({ figure, of }) => (of ? `${figure}:${of}` : figure));
}

// "Throughput", "Parts inside, mean, of upstream", "Distance from the counts, upstream".
export function figureTitle(name) {
  const [figure, of] = name.split(":");
  if (figure === "mse") return `Mean square distance from the counts, ${of === "left_domain" ? "left the belt" : of}`;
  const title = words[figure] ?? figure.replace(/_(per_h|s|m)\b/g, "").replaceAll(/[_.]/g, " ");
  return of ? `${title}, of ${of}` : title;
}

export function figureUnit(name) {
  const [figure] = name.split(/[.:]/);
  if (figure === "mse") return "parts²";
  if (figure.endsWith("_per_h")) return "parts/h";
  if (figure === "content") return "parts";
  return /_s$|^jam$/.test(figure) && !name.endsWith("count") ? "s" : /_m$/.test(figure) ? "m" : "";
}
