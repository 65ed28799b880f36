// Microscopic runs for the stories: scenarios, and what the command line and the daemon must agree on.

import assert from "node:assert/strict";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";

import { beltflow } from "./processes.mjs";
import { isSanitized, temporaryFolder } from "./setup.mjs";

const cylinder = { shape: { type: "cylinder", radius_m: 0.012, height_m: 0.008 } };

// 20 parts that reach a plate within 0.1 s: 30 samples, 4 snapshots.
export function smallJam(changes = {}) {
  return {
    name: "a small jam",
    duration_s: 0.3,
    domain: { x_m: [0.0, 1.0], y_m: [0.0, 0.6] },
    obstacles: [{ id: "plate", from_m: [0.461325, 0.0], to_m: [0.75, 0.5] }],
    cargo: structuredClone(cylinder),
    initial: { hexagonal: { rows: 4, columns: 5, first_m: [0.4, 0.15], spacing_m: 0.02448 } },
    counters: [{ id: "upstream", x_m: [0.0, 0.52] }],
    output: { curve_every_s: 0.01, snapshot_every_s: 0.1 },
    macro: { closure: "dispersive", cell_m: 0.01, step_s: 0.0025 },
    ...changes,
  };
}

// A closed gate that holds 192 parts to the end; solved in a second or a few.
export function longJam() {
  const duration = isSanitized ? 0.25 : 8;
  return smallJam({
    name: "a closed gate",
    duration_s: duration,
    obstacles: [{ id: "gate", from_m: [0.75, 0.0], to_m: [0.75, 0.6] }],
    initial: { hexagonal: { rows: 16, columns: 12, first_m: [0.45, 0.11], spacing_m: 0.02448 } },
    counters: [{ id: "upstream", x_m: [0.0, 0.75] }],
    output: { curve_every_s: duration / 200, snapshot_every_s: duration / 20 },
  });
}

// Two kinds in space, a few steps.
export function shortMix() {
  return smallJam({
    name: "boxes and cylinders",
    duration_s: 0.02,
    cargo: [
      { share: 2, shape: { type: "cylinder", radius_m: 0.012, height_m: 0.008 } },
      { shape: { type: "box", length_m: 0.03, width_m: 0.02, height_m: 0.01 } },
    ],
    initial: { positions_m: [[0.1, 0.1], [0.2, 0.2, 30], [0.3, 0.3], [0.2, 0.4], [0.1, 0.3], [0.1, 0.5]] },
    output: { curve_every_s: 0.01, snapshot_every_s: 0.01 },
  });
}

// Solve with the command line; the folder with its results.
export async function solveMicro(t, scenario, ...more) {
  const folder = temporaryFolder(t);
  const file = path.join(folder, "scenario.json");
  const out = path.join(folder, "out");
  writeFileSync(file, JSON.stringify(scenario));
  const done = await beltflow(["solve", file, "--model", "micro", "--out", out, ...more]);
  assert.equal(done.status, 0, done.stderr);
  return out;
}

function withoutTiming(summary) {
  const { wall_time_s, threads, particle_steps_per_s, ...rest } = summary;
  assert.ok(wall_time_s >= 0 && threads >= 1 && particle_steps_per_s >= 0, JSON.stringify(summary));
  return rest;
}

// Curve, snapshots and parts are the same bytes, and so is all of the summary but its timing.
export async function assertSameMicroResults(d, id, folder) {
  const read = (name) => readFileSync(path.join(folder, name));
  const curve = await d.get(`/v1/runs/${id}/curve?format=csv`);
  assert.equal(curve.text, read("curve.csv").toString());
  const list = (await d.get(`/v1/runs/${id}/snapshots`)).json;
  assert.deepEqual(list.parts, JSON.parse(read("snapshots.json")).parts);
  for (const kind of ["snapshots", "parts"]) {
    const files = readdirSync(path.join(folder, kind)).sort();
    assert.equal(files.length, list.snapshots.length, kind);
    for (const [n, file] of files.entries()) {
      const answer = await d.get(`/v1/runs/${id}/${kind}/${n}`);
      assert.ok(answer.body.equals(read(`${kind}/${file}`)), `${kind} ${n}`);
    }
  }
  const summary = await d.get(`/v1/runs/${id}/summary`);
  assert.deepEqual(withoutTiming(summary.json), withoutTiming(JSON.parse(read("summary.json"))));
}

// A NumPy file of doubles: its shape, and its rows as arrays.
export function readDoubles(body) {
  const start = 10 + body.readUInt16LE(8);
  const header = body.subarray(10, start).toString();
  const [, rows, columns] = /'descr': '<f8', 'fortran_order': False, 'shape': \((\d+), (\d+)\)/.exec(header);
  const value = (row, column) => body.readDoubleLE(start + 8 * (row * columns + column));
  return Array.from({ length: rows }, (_, row) => Array.from({ length: columns }, (_, column) => value(row, column)));
}

function goodMicroScenario() {
  return smallJam({
    initial: { positions_m: [[0.1, 0.1], [0.2, 0.1], [0.3, 0.1]] },
    micro: { integrator: "verlet", path: "auto", step_s: 1e-5, modulus_reduction: 1e6, tension: false },
    contacts: { cargo_cargo: {} },
    cargo: { ...structuredClone(cylinder), mass_kg: 0.02841, material: {} },
  });
}

const box = { type: "box", length_m: 0.03, width_m: 0.02, height_m: 0.01 };
const prism = (outline_m) => ({ type: "prism", height_m: 0.01, outline_m });

// [what is wrong, change of the good scenario, pointer within the scenario, words of the text]
export const badMicroScenarios = [
  ["a step that is unstable", (s) => (s.micro.step_s = 0.1), "/micro/step_s", /largest stable one is [\d.e-]+ s/],
  ["steps without end", (s) => (s.micro.step_s = 1e-11), "/micro/step_s", /limit/],
  ["a step longer than a second", (s) => (s.micro.step_s = 2), "/micro/step_s"],
  ["an integrator that is none", (s) => (s.micro.integrator = "euler"), "/micro/integrator", /verlet/],
  ["a path that is none", (s) => (s.micro.path = "flat"), "/micro/path", /planar/],
  ["boxes in the plane", (s) => Object.assign(s.cargo, { shape: box }) && (s.micro.path = "planar"), "/micro/path"],
  ["a mass of zero", (s) => (s.cargo.mass_kg = 0), "/cargo/mass_kg", /above 0/],
  ["a mass too light for the step", (s) => (s.cargo.mass_kg = 1e-9), "/micro/step_s", /unstable/],
  ["a modulus that is raised", (s) => (s.micro.modulus_reduction = 0.5), "/micro/modulus_reduction"],
  ["a rubber that swells", (s) => (s.cargo.material.poisson_ratio = 0.5), "/cargo/material/poisson_ratio"],
  ["a contact that speeds up", (s) => (s.contacts.cargo_cargo.damping_n_s_m = -1), "/contacts/cargo_cargo/damping_n_s_m"],
  ["an arrowhead as a prism", (s) => (s.cargo.shape = prism([[0, 0], [0.03, 0.015], [0, 0.03], [0.01, 0.015]])),
    "/cargo/shape/outline_m", /convex/],
  ["a prism the wrong way round", (s) => (s.cargo.shape = prism([[0, 0], [0, 0.03], [0.03, 0]])),
    "/cargo/shape/outline_m", /counter-clockwise/],
  ["a hull without volume",
    (s) => (s.cargo.shape = { type: "hull", vertices_m: [[0, 0, 0], [0.02, 0, 0], [0, 0.02, 0], [0.02, 0.02, 0]] }),
    "/cargo/shape/vertices_m", /degenerate/],
  ["parts in one another", (s) => (s.initial.positions_m[1] = [0.11, 0.1]), "/initial/positions_m/1", /overlaps part 0/],
  ["a part outside", (s) => (s.initial.positions_m[0] = [-0.1, 0.1]), "/initial/positions_m/0"],
  ["a part in a wall", (s) => (s.initial.positions_m[2] = [0.3, 0.01]), "/initial/positions_m/2", /wall/],
  ["a part in a plate", (s) => (s.initial.positions_m[2] = [0.52, 0.1]), "/initial/positions_m/2", /obstacle 'plate'/],
  ["no kinds", (s) => (s.cargo = []), "/cargo"],
  ["a kind without a share", (s) => (s.cargo = [s.cargo, { share: 0 }]), "/cargo/1/share"],
  ["a kind without mass", (s) => (s.cargo = [{ ...s.cargo }, { mass_kg: 0 }]), "/cargo/1/mass_kg"],
  ["a kind with a flat outline", (s) => (s.cargo = [{}, { shape: prism([[0, 0], [0.01, 0], [0.02, 0]]) }]),
    "/cargo/1/shape/outline_m"],
  ["a giant among dwarfs", (s) => (s.cargo = [{}, { shape: { radius_m: 0.5 } }]), "/cargo", /unlike/],
  ["a share of the only kind", (s) => (s.cargo.share = 1), "/cargo/share", /unknown/],
].map(([what, change, pointer, words]) => {
  const scenario = goodMicroScenario();
  change(scenario);
  return { what, scenario, pointer, words: words ?? /./ };
});
