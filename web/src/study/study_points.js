// The trials of a study as points: the mean of each one's replications, with its 95 % interval.

// Student's t of 95 % for 1, 2, ... degrees of freedom.
const T95 = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.16, 2.145, 2.131, 2.12, 2.11,
  2.101, 2.093, 2.086, 2.08, 2.074, 2.069, 2.064, 2.06, 2.056, 2.052, 2.048, 2.045, 2.042];

// Beyond the table 1.96 + 2.4 / n is exact to three digits.
function student(n) {
  return T95[n - 1] ?? 1.96 + 2.4 / n;
}

// { n, mean, low, high } of numbers; low and high are null where there is only one.
export function intervalOf(values) {
  const n = values.length;
  const mean = values.reduce((sum, value) => sum + value, 0) / n;
  if (n < 2) return { n, mean, low: null, high: null };
  const deviation = Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / (n - 1));
  const half = (student(n - 1) * deviation) / Math.sqrt(n);
  return { n, mean, low: mean - half, high: mean + half };
}

// [{ point, model, parameters, trials, n, mean, low, high }] of the trials that have this value, by point and model.
export function pointsOf(trials, name) {
  const points = new Map();
  for (const trial of trials) {
    if (trial.values[name] === undefined) continue;
    const key = `${trial.point} ${trial.model}`;
    if (!points.has(key)) points.set(key, { point: trial.point, model: trial.model, parameters: trial.parameters, trials: [] });
    points.get(key).trials.push(trial);
  }
  return [...points.values()].map((point) => ({ ...point, ...intervalOf(point.trials.map(({ values }) => values[name])) }));
}
