// Belts whose speed changes, through all layers: the document and both models.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { assertSameMicroResults, smallJam, solveMicro } from "./micro.mjs";
import { assertSameResults, solve } from "./results.mjs";
import { tiny } from "./scenarios.mjs";

const pause = { t_s: [0.0625, 0.09375], factor: [0, 1] };

// A part in steps of 1/512 s, so that the times of steps and of the schedule are exact.
const paused = (belt) => tiny({ belts: [{ velocity_m_s: [0.4, 0], ...belt }], duration_s: 0.1875,
  counters: [{ id: "left", x_m: [0, 0.08] }], output: { curve_every_s: 0.03125, snapshot_every_s: 0.09375 },
  macro: { closure: "dispersive", cell_m: 0.01, step_s: 1 / 512 } });

test("a resolved document tells how a speed changes as it was given, and nothing where nothing was", async (t) => {
  const d = await daemon(t);
  const belt = { acceleration_m_s2: 2, deceleration_m_s2: 0.5, speed_schedule: pause };
  const run = await d.submit(paused(belt));
  const { belts } = (await d.get(`/v1/runs/${run.id}/scenario`)).json;
  assert.deepEqual(belts, [{ id: "main", velocity_m_s: [0.4, 0], ...belt }]);
  const plain = await d.submit(tiny());
  assert.deepEqual((await d.get(`/v1/runs/${plain.id}/scenario`)).json.belts, [{ id: "main", velocity_m_s: [0.395, 0] }]);
});

test("the density of a belt that pauses is that of one that does not, later", async (t) => {
  const curveOf = async (scenario) => {
    const lines = readFileSync(path.join(await solve(t, scenario), "curve.csv"), "utf8").trimEnd().split("\n").slice(1);
    return lines.map((line) => Number(line.split(",")[1]));
  };
  const with_ = await curveOf(paused({ speed_schedule: pause }));
  const without = await curveOf(paused({}));
  // Samples every 1/32 s: the pause lasts from the second to the third.
  assert.equal(with_.length, 7);
  assert.deepEqual(with_, [...without.slice(0, 3), ...without.slice(2, 6)]);
  assert.ok(with_[6] < with_[0]);
});

test("both models give the bytes of the command line where a belt stops and goes", async (t) => {
  const d = await daemon(t);
  const belts = [{ velocity_m_s: [0.395, 0], acceleration_m_s2: 4, deceleration_m_s2: 8,
    speed_schedule: { t_s: [0.05, 0.15], factor: [0, 1.25] } }];
  const macro = await d.submit(smallJam({ belts }));
  const micro = await d.submit(smallJam({ belts }), { model: "micro" });
  await d.reached(macro.id, "succeeded");
  await d.reached(micro.id, "succeeded");
  await assertSameResults(d, macro.id, await solve(t, smallJam({ belts })));
  await assertSameMicroResults(d, micro.id, await solveMicro(t, smallJam({ belts })));
});

// The parts come to the beam, at 0.148 m, after 0.22 s and 0.3 s, and to the western side 0.37 s and more later; the eastern one is
// closed. Of the density, which is smoothed, 5.55 parts are within the domain.
test("a photo eye lets a belt run backwards in both models, and the cargo leaves over the side that it came from", async (t) => {
  const places = [0.03, 0.06].flatMap((x) => [0.03, 0.06, 0.09].map((y) => [x, y]));
  const scenario = tiny({ belts: [{ velocity_m_s: [0.4, 0] }], edges: { west: "outflow", east: "wall" }, duration_s: 1.2,
    initial: { positions_m: places }, output: { curve_every_s: 0.02 }, photo_eyes: [{ id: "far", line_m: [[0.16, 0], [0.16, 0.12]] }],
    actions: [{ when: { photo_eye: "far", state: "blocked" }, do: { belt: "main", factor: -1 } }] });
  for (const run of [solve, solveMicro]) {
    const lines = readFileSync(path.join(await run(t, scenario), "curve.csv"), "utf8").trimEnd().split("\n");
    const [names, ...rows] = lines.map((line) => line.split(","));
    const column = (name) => rows.map((row) => Number(row[names.indexOf(name)]));
    assert.deepEqual([...new Set(column("main.speed_m_s"))], [0.4, -0.4]);
    assert.ok(column("left_domain").at(-1) > 5.5);
  }
});
