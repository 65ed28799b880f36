// The limits of a scenario, as documents reach them: the last value is accepted, the next one is a 422 that names the
// place and the limit. The README's table of limits names the tests of the others.

import assert from "node:assert/strict";
import test from "node:test";

import { goodScenario } from "./bad_scenarios.mjs";
import { daemon } from "./daemon.mjs";
import { tiny } from "./scenarios.mjs";
import { isSanitized } from "./setup.mjs";

const list = (n, item) => Array.from({ length: n }, (_, k) => item(k));
const circle = (n, [x, y], radius) => list(n, (k) => [
  x + radius * Math.cos((2 * Math.PI * k) / n),
  y + radius * Math.sin((2 * Math.PI * k) / n),
]);
const times = (n) => list(n, (k) => k);
const zeros = (n) => list(n, () => 0);
const cylinder = goodScenario().cargo.shape;

// A feed on a side of 6.6 m.
const feed = (s, members) => Object.assign(s, {
  domain: { x_m: [0, 1], y_m: [0, 6.6] },
  feeds: [{ id: "in", edge: "west", y_m: [1, 2], ...members }],
});
const rate = { rate_per_s: 1 };
const eye = (k) => ({ id: `eye${k}`, line_m: [[0.4, 0], [0.4, 0.6]] });

// A run of n samples and so many snapshots: one each second from 0 s on, and one at the end.
const lasting = (s, n) => Object.assign(s, {
  duration_s: n - 1.5,
  output: { curve_every_s: 1, snapshot_every_s: 1 },
  macro: { closure: "dispersive", cell_m: 0.01 },
});

// [what, last value, next value, change of the good scenario to a value, pointer within the scenario, limit as it is
// told; model]
const limits = [
  ["bytes of a name", 200, 201, (s, n) => (s.name = "x".repeat(n)), "/name", "200"],
  ["letters of an id", 64, 65, (s, n) => (s.counters[0].id = "x".repeat(n)), "/counters/0/id", "64"],
  ["belts", 256, 257,
    (s, n) => (s.belts = list(n, (k) => ({ id: `b${k}`, velocity_m_s: [0.1, 0] }))),
    "/belts", "256"],
  ["points of a belt", 1024, 1025, (s, n) => (s.belts[0].polygon_m = circle(n, [0.5, 0.3], 0.29)),
    "/belts/0/polygon_m", "1024"],
  ["times of a speed schedule", 10_000, 10_001,
    (s, n) => (s.belts[0].speed_schedule = { t_s: times(n), factor: zeros(n) }),
    "/belts/0/speed_schedule/t_s", "10000"],
  ["m/s of a belt", 1000, 1000.001,
    (s, speed) => {
      s.belts[0].velocity_m_s = [speed, 0];
      s.macro.step_s = "auto";
    },
    "/belts/0/velocity_m_s", "1000"],
  ["obstacles", 256, 257,
    (s, n) => (s.obstacles = list(n, (k) => ({ from_m: [0.5, 0.1 + k / 1000], to_m: [0.6, 0.1 + k / 1000] }))),
    "/obstacles", "256"],
  ["points of an obstacle", 1024, 1025,
    (s, n) => (s.obstacles = [{ path_m: list(n, (k) => [0.5 + k / 4000, k % 2 ? 0.3 : 0.301]) }]),
    "/obstacles/0/path_m", "1024"],
  ["times of a turn", 100_000, 100_001,
    (s, n) => (s.obstacles[0].motion = { t_s: times(n), turn_deg: zeros(n) }), "/obstacles/0/motion/t_s", "100000"],
  ["times at which an obstacle comes and goes", 100_000, 100_001,
    (s, n) => (s.obstacles[0].present = { t_s: times(n), value: list(n, () => true) }),
    "/obstacles/0/present/t_s", "100000"],
  ["counters", 32, 33, (s, n) => (s.counters = list(n, (k) => ({ id: `c${k}`, x_m: [0, 0.1] }))), "/counters", "32"],
  ["output windows", 256, 257,
    (s, n) => (s.output.windows = list(n, (k) => ({ t_s: [k / 1000, (k + 1) / 1000] }))), "/output/windows", "256"],

  ["kinds of cargo", 32, 33,
    (s, n) => (s.cargo = list(n, (k) => ({ id: `kind${k}`, shape: cylinder }))), "/cargo", "32"],
  ["points of an outline", 64, 65,
    (s, n) => (s.cargo.shape = { type: "prism", outline_m: circle(n, [0, 0], 0.012), height_m: 0.008 }),
    "/cargo/shape/outline_m", "64"],
  ["points of a hull", 64, 65,
    (s, n) => (s.cargo.shape = {
      type: "hull",
      vertices_m: [[32, 0], [n - 32, 0.01]].flatMap(([m, z]) => circle(m, [0, 0], 0.012).map((p) => [...p, z])),
    }),
    "/cargo/shape/vertices_m", "64"],
  ["parts", 1_000_000, 1_000_001,
    (s, count) => Object.assign(s, {
      domain: { x_m: [0, 100], y_m: [0, 100] },
      obstacles: [],
      initial: { random: { count, region: { x_m: [1, 99], y_m: [1, 99] } } },
      macro: { closure: "dispersive", cell_m: 0.1 },
    }),
    "/initial/random/count", "1000000"],

  ["feeds", 64, 65,
    (s, n) => feed(s).feeds = list(n, (k) => ({ edge: "west", y_m: [k / 10 + 0.05, k / 10 + 0.1], ...rate })),
    "/feeds", "64"],
  ["times of a profile", 100_000, 100_001,
    (s, n) => feed(s, { profile: { t_s: times(n), rate_per_s: zeros(n) } }), "/feeds/0/profile/t_s", "100000"],
  ["lines of a profile", 100_000, 100_001,
    (s, n) => feed(s, { profile: { csv: `t_s,rate_per_s\n${list(n, (k) => `${k},1`).join("\n")}` } }),
    "/feeds/0/profile/csv", "100000"],
  ["arrivals", 100_000, 100_001, (s, n) => feed(s, { schedule: { t_s: times(n) } }), "/feeds/0/schedule/t_s", "100000"],
  ["stages of Erlang's gaps", 1000, 1001,
    (s, n) => feed(s, { ...rate, arrivals: "erlang", shape: n }), "/feeds/0/shape", "1000"],
  ["photo eyes", 64, 65, (s, n) => (s.photo_eyes = list(n, eye)), "/photo_eyes", "64"],
  ["sinks", 64, 65, (s, n) => (s.sinks = list(n, () => ({ polygon_m: [[0.8, 0], [0.9, 0], [0.9, 0.6]] }))), "/sinks", "64"],
  ["actions", 256, 257,
    (s, n) => {
      s.photo_eyes = [eye(0)];
      s.actions = list(n, () => ({ when: { photo_eye: "eye0", state: "blocked" }, do: { belt: "main", factor: 0 } }));
    },
    "/actions", "256"],

  ["m of a side of the domain", 100_000, 100_010,
    (s, x) => Object.assign(s, { domain: { x_m: [0, x], y_m: [0, 600] }, macro: { closure: "dispersive", cell_m: 10 } }),
    "/domain/x_m", "100000"],
  ["cells", 10_000 * 10_000, 10_001 * 10_000,
    (s, n) => Object.assign(s, {
      domain: { x_m: [0, n / 10_000 / 1000], y_m: [0, 10] },
      macro: { closure: "dispersive", cell_m: 0.001, step_s: "auto", mollifier_per_m2: 1e6 },
    }),
    "/macro/cell_m", "100000000"],
  ["cells with the congested closure", 6_000 * 5_000, 6_001 * 5_000,
    (s, n) => Object.assign(s, {
      domain: { x_m: [0, n / 5_000 / 1000], y_m: [0, 5] },
      macro: { cell_m: 0.001, closure: "congested" },
    }),
    "/macro/cell_m", "30000000"],
  ["cells of a row", 2 ** 24, 2 ** 24 + 1,
    (s, n) => Object.assign(s, {
      domain: { x_m: [0, n * 0.005], y_m: [0, 0.025] },
      obstacles: [],
      initial: { positions_m: [[0.1, 0.0125]] },
      macro: { closure: "dispersive", cell_m: 0.005 },
    }),
    "/macro/cell_m", "16777216"],
  ["per m2 of a mollifier, which reaches over 64 cells", 39.0625, 39, // 4/(sqrt(39.0625) 0.01) = 64
    (s, mollifier) => (s.macro.mollifier_per_m2 = mollifier), "/macro/mollifier_per_m2", "64"],
  ["samples", 1_000_000, 1_000_001, (s, n) => (lasting(s, n).output.snapshot_every_s = 1000),
    "/output/curve_every_s", "1000000"],
  ["snapshots", 20_000, 20_001, lasting, "/output/snapshot_every_s", "20000"],
  ["columns of 200 cells in 20,000 snapshots", 500, 501, // 4 bytes a cell
    (s, n) => (lasting(s, 20_000).domain = { x_m: [0, n / 100], y_m: [0, 2] }),
    "/output/snapshot_every_s", "8000000000"],
  ["parts in 20,000 snapshots", 8333, 8334, // 6 numbers of 8 bytes each
    (s, count) => {
      lasting(s, 20_000).macro.cell_m = 0.05;
      s.micro = { integrator: "implicit", modulus_reduction: 1e4 };
      s.domain = { x_m: [0, 5], y_m: [0, 5] };
      s.obstacles = [];
      s.initial = { random: { count, region: { x_m: [0.1, 4.9], y_m: [0.1, 4.9] } } };
    },
    "/output/snapshot_every_s", "8000000000", "micro"],
  ["macroscopic steps", 1e9, 1e9 + 1, // powers of 2, so that their number is exact
    (s, n) => Object.assign(s, {
      duration_s: n / 2 ** 7,
      output: { curve_every_s: 1000, snapshot_every_s: 1000 },
      macro: { closure: "dispersive", cell_m: 0.01, step_s: 1 / 2 ** 7 },
    }),
    "/macro/step_s", "1000000000"],
  ["microscopic steps", 1e9, 1e9 + 1,
    (s, n) => Object.assign(s, {
      duration_s: n / 2 ** 17,
      output: { curve_every_s: 1, snapshot_every_s: 1 },
      micro: { step_s: 1 / 2 ** 17, modulus_reduction: 1e6 },
    }),
    "/micro/step_s", "1000000000", "micro"],
];

test("a scenario may go as far as each limit and no further", async (t) => {
  const d = await daemon(t, { body_bytes: 2 ** 21 }); // a long list of true and false is beyond the usual limit
  for (const [what, last, next, change, pointer, limit, model = "macro"] of limits) {
    await t.test(`${last} ${what}`, async () => {
      const validate = (value) => {
        const scenario = goodScenario();
        change(scenario, value);
        return d.post("/v1/validate", { scenario, model });
      };
      const accepted = await validate(last);
      assert.equal(accepted.status, 200, accepted.text.slice(0, 2000));
      const refused = await validate(next);
      assert.equal(refused.status, 422);
      const fault = refused.json.errors.find((error) => error.pointer === `/scenario${pointer}`);
      assert.match(fault?.detail ?? "", new RegExp(`\\b${limit}\\b`), refused.text.slice(0, 2000));
    });
  }
});

test("what stands beside a scenario has limits, too", async (t) => {
  const d = await daemon(t);
  for (const [member, last, next] of [
    ["label", "x".repeat(100), "x".repeat(101)],
    ["line", "x".repeat(100), "x".repeat(101)],
    ["priority", 100, 101],
    ["priority", -100, -101],
  ]) {
    const validate = (value) => d.post("/v1/validate", { scenario: goodScenario(), [member]: value });
    const accepted = await validate(last);
    assert.equal(accepted.status, 200, accepted.text);
    const refused = await validate(next);
    assert.equal(refused.status, 422);
    assert.deepEqual(refused.json.errors.map((error) => error.pointer), [`/${member}`]);
  }
});

// A profile of so many bytes: lines of 17.
function profileOf(bytes) {
  const header = "t_s,rate_per_s\n";
  const line = (k, width) => `${k},1.`.padEnd(width - 1, "0") + "\n";
  const n = Math.floor((bytes - header.length) / 17);
  const rest = bytes - header.length - n * 17;
  return header + list(n, (k) => line(k, k === 0 ? 17 + rest : 17)).join("");
}

test("the texts that a scenario names may have 2 MiB together", async (t) => {
  const d = await daemon(t);
  const headers = { "content-type": "text/csv" };
  const store = async (bytes) => {
    const answer = await d.post("/v1/measurements.csv?kind=profile", profileOf(bytes), headers);
    assert.equal(answer.status, 201, answer.text);
    return answer.json.id;
  };
  const long = await store(2 ** 20);
  const validate = (...measurements) => {
    const feeds = measurements.map((measurement, k) => ({ edge: "west", y_m: [k, k + 1], profile: { measurement } }));
    return d.post("/v1/validate", { scenario: Object.assign(feed(goodScenario()), { feeds }) });
  };
  const accepted = await validate(long, long);
  assert.equal(accepted.status, 200, accepted.text.slice(0, 2000));
  const refused = await validate(long, long, await store(100));
  assert.equal(refused.status, 422);
  assert.deepEqual(refused.json.errors.map((error) => error.pointer), ["/scenario/feeds/2/profile/measurement"]);
});

test("beyond 20 million cells every second snapshot is compared", { skip: isSanitized }, async (t) => {
  const d = await daemon(t);
  const every = 1 / 2048;
  const { id } = await d.submit(tiny({ // 11 snapshots of 2 million cells
    duration_s: 10 * every,
    domain: { x_m: [0, 2], y_m: [0, 1] },
    output: { curve_every_s: every, snapshot_every_s: every },
    macro: { closure: "dispersive", cell_m: 0.001, step_s: every, mollifier_per_m2: 1e6 },
  }));
  await d.reached(id, "succeeded");
  const { density } = (await d.get(`/v1/compare?a=${id}&b=${id}`)).json;
  assert.equal(density.n_common, 11);
  assert.deepEqual(density.snapshots.map((pair) => pair.a), [0, 2, 4, 6, 8, 10]);
});
