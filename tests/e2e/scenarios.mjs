// Scenarios of several stories, as JSON values: small ones that are solved at once, and ones
// that last as long as a story needs.

import { isSanitized } from "./setup.mjs";

const cylinder = { shape: { type: "cylinder", radius_m: 0.012, height_m: 0.008 } };

// One part on a free belt: 24 x 12 cells, 80 steps, 11 samples, 3 snapshots.
export function tiny(changes = {}) {
  return {
    name: "one part on a free belt",
    duration_s: 0.1,
    domain: { x_m: [0.0, 0.24], y_m: [0.0, 0.12] },
    cargo: structuredClone(cylinder),
    initial: { positions_m: [[0.06, 0.06]] },
    output: { curve_every_s: 0.01, snapshot_every_s: 0.05 },
    macro: { cell_m: 0.01, step_s: 0.00125 },
    ...changes,
  };
}

// A gate across the whole belt: all 192 parts stay in contact with it, so there is work to the
// end however long it lasts.
export function jam(duration_s, output) {
  return {
    name: "a closed gate",
    duration_s,
    domain: { x_m: [0.0, 1.0], y_m: [0.0, 0.6] },
    obstacles: [{ id: "gate", from_m: [0.75, 0.0], to_m: [0.75, 0.6] }],
    cargo: structuredClone(cylinder),
    initial: { hexagonal: { rows: 16, columns: 12, first_m: [0.1, 0.11], spacing_m: 0.02448 } },
    counters: [{ id: "upstream", x_m: [0.0, 0.75] }],
    output,
    macro: { cell_m: 0.01, step_s: 0.0025 },
  };
}

// Solved in a second or three: long enough to be interrupted, with 200 samples and 50 snapshots.
export function interruptible() {
  const duration = isSanitized ? 20 : 300;
  return jam(duration, { curve_every_s: duration / 200, snapshot_every_s: duration / 50 });
}

// Not over before its story is.
export function endless() {
  return jam(200_000, { curve_every_s: 1, snapshot_every_s: 100 });
}
