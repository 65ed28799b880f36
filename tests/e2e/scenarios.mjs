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
    macro: { closure: "dispersive", cell_m: 0.01, step_s: 0.00125 },
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
    macro: { closure: "dispersive", cell_m: 0.01, step_s: 0.0025 },
  };
}

// A plate before such parts that ends at (0.75, 0.5) and leaves 0.1 m free.
export function plate(duration_s) {
  const scenario = jam(duration_s, { curve_every_s: 0.05, snapshot_every_s: duration_s });
  scenario.obstacles = [{ end_m: [0.75, 0.5], angle_deg: 60.0, length_m: 0.6 }];
  return scenario;
}

// A study of n of its lengths: some milliseconds of computing for each tenth of a second.
export function lengths(n, duration_s = 0.2) {
  return {
    base: { scenario: plate(duration_s) },
    parameters: [{ pointer: "/obstacles/0/length_m", values: Array.from({ length: n }, (_, k) => 0.2 + (0.4 * k) / n) }],
    objectives: [{ figure: "content.mean" }],
    method: { type: "list" },
  };
}

// Solved in a second or two: long enough to be interrupted, with 200 samples and 50 snapshots.
export function interruptible() {
  const duration = isSanitized ? 10 : 100;
  return jam(duration, { curve_every_s: duration / 200, snapshot_every_s: duration / 50 });
}

// Not over before its story is.
export function endless() {
  return jam(200_000, { curve_every_s: 1, snapshot_every_s: 100 });
}

// A belt of 0.6 m x 0.3 m that is fed 20 parts a second for 3 s, with a flap that turns up at 1 s, and a stop that a
// photo eye at x = 0.25 m lets come.
export function fed(changes = {}) {
  return {
    name: "a belt that is fed",
    duration_s: 3,
    domain: { x_m: [0.0, 0.6], y_m: [0.0, 0.3] },
    belts: [{ id: "main", velocity_m_s: [0.3, 0.0] }],
    obstacles: [
      { id: "flap", path_m: [[0.4, 0.0], [0.55, 0.0]], motion: { t_s: [1, 1.5], turn_deg: [0, 45] } },
      { id: "stop", from_m: [0.5, 0.2], to_m: [0.5, 0.3], present: { t_s: [0], value: [false] } },
    ],
    cargo: structuredClone(cylinder),
    feeds: [{ id: "infeed", edge: "west", y_m: [0.05, 0.25], rate_per_s: 20 }],
    photo_eyes: [{ id: "eye", line_m: [[0.25, 0.0], [0.25, 0.3]], density_ratio: 0.05 }],
    actions: [{ when: { photo_eye: "eye", state: "blocked" }, do: { obstacle: "stop", present: true } }],
    counters: [{ id: "upstream", x_m: [0.0, 0.5] }],
    output: { curve_every_s: 0.1, snapshot_every_s: 0.1 },
    macro: { closure: "dispersive", cell_m: 0.01 },
    micro: { integrator: "implicit", modulus_reduction: 1e4 },
    ...changes,
  };
}
