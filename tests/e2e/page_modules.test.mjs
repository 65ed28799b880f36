// Modules of the page that compute, against the daemon and against values that are derived.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import test from "node:test";

import { fileNameOf, fixed, number, parts, quantity, readable } from "../../web/src/base/format.js";
import { formatJson } from "../../web/src/base/json_text.js";
import { readNpy } from "../../web/src/base/npy.js";
import { marksOf, readNumber, writeNumber } from "../../web/src/base/numbers.js";
import { lineOf } from "../../web/src/board/lines.js";
import { nameOfThing, rename } from "../../web/src/board/things.js";
import { PartsLayer } from "../../web/src/player/parts_layer.js";
import { writeTwice } from "../../web/src/player/scenery.js";
import { columnsOf, contentOf, differenceOf, distanceOf, fallsOf, fittedShift, flowOf, rateOf, shifted, valueAt } from "../../web/src/plot/series.js";
import { residenceOf } from "../../web/src/run/key_figures.js";
import { searchOf } from "../../web/src/runs/search_words.js";
import { cargoOf } from "../../web/src/scenario/cargo.js";
import { chipsOf, differences, nameOfVariant } from "../../web/src/scenario/differences.js";
import { Equipment, isPresentAt, placeAt } from "../../web/src/scenario/equipment.js";
import { areaOf, beltOutline, beltVelocity, convexHull, hullCentre } from "../../web/src/scenario/geometry.js";
import { parameterAt } from "../../web/src/scenario/parameters.js";
import { bodyOf } from "../../web/src/scenario/plate.js";
import { baseFor, studyParameters } from "../../web/src/study/study_parameters.js";
import { intervalOf, pointsOf } from "../../web/src/study/study_points.js";
import { daemon } from "./daemon.mjs";

const near = (a, b, tolerance = 1e-9) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
const bytesOf = ({ body }) => body.buffer.slice(body.byteOffset, body.byteOffset + body.length);

test("parts of a mix are of the kinds that the server names, told by the heights of their centres", async (t) => {
  const d = await daemon(t);
  const example = (await d.get("/v1/examples/mixed-cargo")).json;
  const run = await d.submit({ ...example, duration_s: 0.001, output: { curve_every_s: 0.001 } }, { model: "micro" });
  await d.reached(run.id, "succeeded");
  const { shape: [n, columns], data } = readNpy(bytesOf(await d.get(`/v1/runs/${run.id}/parts/0`)));
  const { kindOfPart } = cargoOf(example, (await d.get(`/v1/runs/${run.id}/snapshots`)).json.kinds);
  for (let k = 0; k < n; k++) near(data[k * columns + 2], example.cargo[kindOfPart(k)].shape.height_m / 2, 1e-6);
});

test("a rule says which kind its photo eye sees, and follows another id of it, as a counter does", () => {
  const when = { photo_eye: "camera", state: "blocked", kind: "jar" };
  const scenario = { actions: [{ when, delay_s: 1.5, do: { obstacle: "arm", turn_deg: 28 } }, { when: { ...when, state: "clear" }, do: { feed: "in", hold: true } }],
    counters: [{ kind: "jar" }, { kind: "can" }, {}] };
  assert.equal(nameOfThing(scenario, null, "actions", 0), "When camera sees jar, 1.5 s later: turn arm to 28°");
  assert.equal(nameOfThing(scenario, null, "actions", 1), "When camera has seen jar: hold in");
  rename(scenario, "kinds", "jar", "glass");
  assert.deepEqual(scenario.actions.map((action) => action.when.kind), ["glass", "glass"]);
  assert.deepEqual(scenario.counters, [{ kind: "glass" }, { kind: "can" }, {}]);
});

test("a merge is called by its lanes and its limits, also while it is written", () => {
  const lanes = [{ belt: "a", photo_eye: "e" }, { belt: "b", photo_eye: "f" }];
  const called = (merge) => nameOfThing({ merges: [{ id: "m", ...merge }] }, null, "merges", 0);
  assert.equal(called({ lanes }), "m: a, b in turn, 1 part each");
  assert.equal(called({ lanes, order: "priority", parts: 5 }), "m: a, b by priority, 5 parts each");
  assert.equal(called({ lanes, time_s: 8 }), "m: a, b in turn, 8 s each");
  assert.equal(called({ lanes, parts: 5, time_s: 8 }), "m: a, b in turn, 5 parts or 8 s each");
  for (const unfinished of [undefined, null, [null, { belt: "b" }], 5]) assert.match(called({ lanes: unfinished }), /in turn/);
  const scenario = { merges: [{ lanes: [null, ...lanes.map((lane) => ({ ...lane }))] }, {}] };
  rename(scenario, "photo_eyes", "f", "g");
  assert.deepEqual(scenario.merges[0].lanes.map((lane) => lane?.photo_eye), [undefined, "e", "g"]);
});

test("a line that is called by the name of its scenario has whole characters and 100 bytes at most", () => {
  assert.equal(lineOf(" hall 2 "), "hall 2");
  // 1 and 25 times 4 bytes.
  assert.equal(lineOf(`a${"\u{1f4e6}".repeat(25)}`), `a${"\u{1f4e6}".repeat(24)}`);
});

test("a variant's name has 200 bytes at most, of whole parameters", async (t) => {
  const d = await daemon(t);
  // The speeds of 27 belts take some 29 bytes each. Behind the 37 of the stem there is room for five and the mark.
  const origin = (await d.get("/v1/examples/cell-singulator")).json;
  const slower = structuredClone(origin);
  for (const belt of slower.belts) belt.velocity_m_s = belt.velocity_m_s.map((value) => value / 2);
  slower.name = nameOfVariant(origin, slower);
  assert.match(slower.name, /^Singulator of five by five belt cells(, [^,]+ m\/s){5}, …$/);
  assert.ok(Buffer.byteLength(slower.name) <= 200, slower.name);
  assert.equal((await d.post("/v1/validate", { scenario: slower })).status, 200);
  // The mark of what is left out belongs to no stem.
  const longer = { ...structuredClone(origin), name: slower.name, duration_s: 9 };
  assert.equal(nameOfVariant({ ...longer, duration_s: 8 }, longer).split(", ")[0], "Singulator of five by five belt cells");
  // A name without room for a parameter stays.
  const named = { ...origin, name: "x".repeat(197) };
  assert.equal(nameOfVariant(named, { ...named, duration_s: 9 }), named.name);
});

test("counts are shifted to where they are nearest to a curve", () => {
  // Parts leave from 2 s on, ten a second, until 6 s; the clock of the counts began 3.3 s later.
  const t = Array.from({ length: 101 }, (_, k) => k / 10);
  const leftAt = (time) => Math.min(Math.max(10 * (time - 2), 0), 40);
  const curve = { t, v: t.map(leftAt) };
  const counts = { t: [0, 1, 2, 3, 4], v: [0, 1, 2, 3, 4].map((time) => leftAt(time + 3.3)) };
  // Half a step of the search is (10 + 4)/400/20 s.
  near(fittedShift(counts, curve), 3.3, 14 / 8000 + 1e-9);
  near(distanceOf(shifted(counts, 3.3), curve), 0, 1e-9);
  // One second later the curve, ten a second, has ten more.
  near(distanceOf(shifted({ t: [3, 4], v: [10, 20] }, 1), curve), 10, 1e-9);
  assert.equal(distanceOf(shifted(counts, 100), curve), null);
  assert.equal(fittedShift({ t: [1], v: [1] }, curve), null);
});

test("a snapshot's NPY is its JSON", async (t) => {
  const d = await daemon(t);
  const example = (await d.get("/v1/examples/example-1")).json;
  const run = await d.submit({ ...example, duration_s: 0.1 });
  await d.reached(run.id, "succeeded");
  const { shape, data } = readNpy(bytesOf(await d.get(`/v1/runs/${run.id}/snapshots/1`)));
  assert.deepEqual(shape, [120, 200]);
  const json = (await d.get(`/v1/runs/${run.id}/snapshots/1?format=json`)).json;
  const rows = json.density;
  rows.flat().forEach((value, k) => assert.equal(Math.fround(value), data[k]));
  assert.throws(() => readNpy(new ArrayBuffer(4)), /no NPY/);
  assert.throws(() => readNpy(bytesOf({ body: Buffer.from("\x93NUMPY\x01\x00\x02\x00{}", "latin1") })), /another kind/);
});

test("differences and rates of curves are those of lines", () => {
  const [a, b] = [{ t: [0, 1, 2, 3], v: [8, 6, 4, 2] }, { t: [0, 2], v: [8, 0] }];
  assert.deepEqual(differenceOf(a, b), { t: [0, 1, 2], v: [0, 2, 4] });
  // Two parts a second, whether they leave or come; what stands still has no rate.
  const rates = ({ v }) => rateOf({ t: [0, 1, 2, 3], v }).v.map((rate) => Math.round(rate * 1e9) / 1e9);
  assert.deepEqual([rates(a), rates({ v: [2, 4, 6, 8] }), rates({ v: [5, 5, 5, 5] })], [[2, 2], [2, 2], [0, 0]]);
  near(valueAt([0, 2], [0, 10], 0.5), 2.5);
});

test("an arc moves along its circle, at its speed in the middle, and nowhere else", () => {
  const arc = { centre_m: [1, 2], inner_radius_m: 0.4, outer_radius_m: 0.6, from_deg: 90, to_deg: 0 };
  const scenario = { belts: [{ velocity_m_s: [0.3, 0.4], arc }] };
  const [vx, vy] = beltVelocity(scenario, [1.3, 2.4]);
  near(vx, 0.4);
  near(vy, -0.3);
  near(Math.hypot(...beltVelocity(scenario, [1.33, 2.44])), 0.55);
  for (const place of [[1.3, 1.9], [1, 2.7], [1.2, 2.2]]) assert.deepEqual(beltVelocity(scenario, place), [0, 0]);
  // Its area is that of the sector but for the chords, 1 - sin(2 deg)/(2 deg) of it.
  near(areaOf(beltOutline(scenario.belts[0])).area / (0.25 * Math.PI * (0.36 - 0.16)), -Math.sin(Math.PI / 90) / (Math.PI / 90));
});

test("a path has its speed along its centre line, and the outline of its sections", () => {
  const path = { points_m: [[0, 0.5], [1.5, 0.5], [1.5, 2.5], [3, 2.5]], radius_m: [0.6, 0.6], width_m: 0.5 };
  const scenario = { belts: [{ velocity_m_s: [0.4, 0], path }] };
  // To the right, up, and to the right again; in the middle of the first arc aslant, and faster outside.
  const diagonal = Math.SQRT1_2, outside = [0.9 + 0.8 * diagonal, 1.1 - 0.8 * diagonal];
  for (const [place, [vx, vy]] of [[[0.3, 0.3], [0.4, 0]], [[1.6, 1.5], [0, 0.4]], [[2.9, 2.6], [0.4, 0]], [outside, [0.4 * diagonal * 0.8 / 0.6, 0.4 * diagonal * 0.8 / 0.6]]]) {
    const found = beltVelocity(scenario, place);
    near(found[0], vx);
    near(found[1], vy);
  }
  assert.deepEqual(beltVelocity(scenario, [1.5, 0.3]), [0, 0]);
  // 0.9 m, a quarter of a circle, 0.8 m, a quarter, 0.9 m, but for the chords.
  near(areaOf(beltOutline(scenario.belts[0])).area / (0.5 * (2.6 + 0.6 * Math.PI)), 1, 2e-4);
});

test("numbers and places of messages are written for people", () => {
  // Of axes, too, which have six digits.
  assert.deepEqual([0, 1000, 1000000, 2.5].map((value) => number(value, 6)), ["0", "1,000", "1,000,000", "2.5"]);
  assert.deepEqual([parts(-1e-12), parts(1.686e-12), parts(173.25), fixed(-0.001, 1), quantity(-3e-13, "parts").replace(/\s/, " ")],
    ["0", "0", "173.3", "0.0", "0 parts"]);
  assert.equal(readable("-9.2 % (-3 to 5) on 2026-11-26"), "−9.2 % (−3 to 5) on 2026-11-26");
  assert.equal(readable("/obstacles/0/from_m is 0.12000000000000001, of 1.5e-3 at /v1/runs"),
    "obstacles 1 from is 0.12, of 0.0015 at /v1/runs");
});

test("the residence of a thousandth of a part is not told", () => {
  const residence_s = { mean: 600, p95: 638 };
  assert.equal(residenceOf({ parts: { left: 0.001 }, residence_s }), undefined);
  assert.equal(residenceOf({ parts: { left: 0.5 }, residence_s }), 638);
  assert.equal(residenceOf({ residence_s }), 638); // of an earlier version
  assert.equal(residenceOf({ parts: { left: 3 } }), undefined);
});

test("a label that would stick out at the right or the top of a picture is moved into it", () => {
  const placeOf = (at) => {
    let place;
    const context = { canvas: { width: 600, height: 200 }, measureText: () => ({ width: 40 }), strokeText: () => {}, fillText: (_, ...to) => (place = to) };
    writeTwice(context, "out", at, "white", "black", 2);
    return place;
  };
  assert.deepEqual(placeOf([100, 50]), [100, 50]);
  assert.deepEqual(placeOf([590, 50]), [556, 50]); // 40 of text and 4 of its halo before the right side
  assert.deepEqual(placeOf([100, -12]), [100, 2]);
  assert.deepEqual(placeOf([610, -30]), [610, -30]); // of what cannot be seen
});

test("files are called by what they show", () => {
  assert.equal(fileNameOf("Example 1, angle 75.5°", "micro"), "example-1-angle-75.5-micro");
  assert.equal(fileNameOf("Förderband/../Süd: 30 Teile/s"), "forderband-sud-30-teile-s");
  assert.equal(fileNameOf("線 2", "macro"), "線-2-macro");
  assert.equal(fileNameOf("a".repeat(300), "micro").length, 100);
});

test("JSON that is written for people is the same JSON", () => {
  const value = { a: [1, { "b/c": "x" }], d: {}, long: Array.from({ length: 50 }, (_, k) => [k, "text"]), none: null };
  assert.deepEqual(JSON.parse(formatJson(value)), value);
});

test("hulls and their centres are those of plain bodies", () => {
  assert.equal(convexHull([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]]).length, 4);
  near(areaOf([[0, 0], [2, 0], [2, 1], [0, 1]]).area, 2);
  // A tetrahedron: the mean of its corners.
  const centre = hullCentre([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]);
  for (const value of centre) near(value, 0.25, 1e-4);
});

test("a plate turns linearly between its times, and in rounds from the last one to the first of the next", () => {
  const swing = { t_s: [0, 2, 2.5], turn_deg: [0, 0, 35] };
  for (const [t, angle] of [[0, 0], [1, 0], [2.25, 17.5], [2.5, 35], [90, 35]]) near(placeAt(swing, t).turn, angle);
  // From 35 degrees at 2.5 s back to 0 at 4 s.
  for (const [t, angle] of [[3.25, 17.5], [4, 0], [6.25, 17.5]]) near(placeAt({ ...swing, repeat_s: 4 }, t).turn, angle);
  // Before its first time a plate has the first angle; in later rounds it comes from the last one.
  const late = { t_s: [1, 2], turn_deg: [10, 20], repeat_s: 4 };
  for (const [t, angle] of [[0.5, 10], [4.5, 20 - (10 * 2.5) / 3]]) near(placeAt(late, t).turn, angle);
  assert.equal(placeAt({ pivot_m: [0, 0] }, 1).turn, 0);
});

test("a plate is shifted linearly between its times, and by a command from where it is", () => {
  const stroke = { t_s: [0, 1, 2], shift_m: [[0, 0], [0.2, 0.4], [0.2, 0]], repeat_s: 4 };
  const shifts = [[0.5, [0.1, 0.2]], [1.5, [0.2, 0.2]], [3, [0.1, 0]], [4.5, [0.1, 0.2]]];
  for (const [t, [x, y]] of shifts) {
    const { turn, shift } = placeAt(stroke, t);
    assert.equal(turn, 0);
    near(shift[0], x);
    near(shift[1], y);
  }
  const scenario = { obstacles: [{ id: "pusher", motion: stroke }], actions: [{ do: { obstacle: "pusher", shift_m: [0, 0.5], over_s: 0.5 } }] };
  const drives = [];
  const equipment = new Equipment(scenario, { t: [], columns: new Map() }, [{ t_s: 1.5, action: 0 }], drives);
  const at = (t) => equipment.at(t).plates[0].shift.map((value) => Number(value.toFixed(9)));
  assert.deepEqual([1, 1.75, 2, 9].map(at), [[0.2, 0.4], [0.1, 0.35], [0, 0.5], [0, 0.5]]);
  drives.push({ t_s: 1.75, obstacle: "pusher", state: "stalled", turn_deg: 0, shift_m: [0.1, 0.35] });
  assert.deepEqual([1.75, 9].map(at), [[0.1, 0.35], [0.1, 0.35]]);
});

test("a plate's body lies downstream, a guide's on both sides of its path or on that of the plate that it goes on from", () => {
  const scenario = { belts: [{ velocity_m_s: [0.4, 0] }] };
  const heights = (path, k) => {
    const ys = bodyOf(scenario, path, k, 0.02).map(([, y]) => y);
    return [Math.min(...ys), Math.max(...ys)];
  };
  const funnel = [[0.2, 0.4], [0.4, 0.3], [0.6, 0.3], [0.8, 0.3]];
  for (const path of [[[0.2, 0.3], [0.8, 0.3]], [[0.8, 0.3], [0.2, 0.3 + 1e-9]]]) {
    heights(path, 0).forEach((y, end) => near(y, [0.29, 0.31][end], 1e-8));
  }
  for (const k of [1, 2]) heights(funnel, k).forEach((y, end) => near(y, [0.3, 0.32][end]));
  for (const k of [0, 1]) heights([...funnel].reverse(), k).forEach((y, end) => near(y, [0.3, 0.32][end]));
  // What opens again has its body above, too, whichever way it was drawn.
  const lane = [...funnel, [0.9, 0.4]];
  for (const [path, k] of [[lane, 3], [[...lane].reverse(), 0]]) {
    heights(path, k).forEach((y, end) => near(y, [0.3, 0.4 + 0.02 * Math.SQRT1_2][end]));
  }
  // Across the belt, 20 mm downstream.
  const xs = bodyOf(scenario, [[0.5, 0], [0.5, 0.3]], 0, 0.02).map(([x]) => x);
  near(Math.min(...xs), 0.5);
  near(Math.max(...xs), 0.52);
});

test("a plate is there before its first time, and then as from time to time", () => {
  const present = { t_s: [1, 2], value: [false, true] };
  assert.deepEqual([0.5, 1, 1.9, 2, 9].map((t) => isPresentAt(present, t)), [true, false, false, true, true]);
  const rounds = { t_s: [1, 2], value: [true, false], repeat_s: 3 };
  assert.deepEqual([0.5, 1.5, 2.5, 3.5, 4.5].map((t) => isPresentAt(rounds, t)), [true, true, false, false, true]);
  assert.equal(isPresentAt(undefined, 1), true);
});

test("actions move plates from the time on at which they were carried out", () => {
  const scenario = {
    obstacles: [{ id: "flap", motion: { t_s: [0, 10], turn_deg: [0, 10] } }, { id: "stop", present: { t_s: [0], value: [false] } }],
    photo_eyes: [{ id: "pe" }],
    actions: [
      { when: { photo_eye: "pe", state: "blocked" }, delay_s: 1, do: { obstacle: "flap", turn_deg: 33, over_s: 2 } },
      { when: { photo_eye: "pe", state: "blocked" }, do: { obstacle: "stop", present: true } },
      { when: { photo_eye: "pe", state: "clear" }, do: { obstacle: "stop", present: false } },
    ],
  };
  const curve = { t: [0, 1, 2, 3, 4, 5], columns: new Map([["pe.blocked", [0, 0, 1, 1, 0, 0]]]) };
  const done = [{ t_s: 1.75, action: 1 }];
  const equipment = new Equipment(scenario, curve, done, []);
  const at = (t) => {
    const { plates: [flap, stop], eyes: [eye] } = equipment.at(t);
    return [flap.turn, stop.isPresent, eye];
  };
  assert.deepEqual(at(1), [1, false, false]);
  assert.deepEqual(at(1.75), [1.75, true, false]); // between two samples
  assert.deepEqual(at(4), [4, true, false]);
  done.push({ t_s: 3, action: 0 }, { t_s: 3.75, action: 2 });
  // The flap begins at 3 degrees at 3 s and is at 33 from 5 s on.
  assert.deepEqual(at(2), [2, true, true]);
  assert.deepEqual(at(4), [18, false, false]);
  assert.deepEqual(at(5), [33, false, false]);
  assert.deepEqual(at(6), [33, false, null]); // the curve does not know yet
});

test("a belt is down by its failures as the curve tells", () => {
  const scenario = { obstacles: [], belts: [{ id: "a" }, { id: "b", failures: [{ id: "rare" }, { id: "often" }] }] };
  const curve = { t: [0, 1, 2], columns: new Map([["rare.failed", [0, 1, 0]], ["often.failed", [0, 0, 1]]]) };
  const equipment = new Equipment(scenario, curve, [], []);
  assert.deepEqual([0.5, 1, 1.5, 2].map((t) => equipment.at(t).failures), [[[], []], [[], ["rare"]], [[], ["rare"]], [[], ["often"]]]);
  assert.deepEqual(equipment.at(9).failures, [[], []]); // not known yet
});

test("a plate that cargo holds back is where its drive was", () => {
  const scenario = { obstacles: [{ id: "gate" }, { id: "flap", motion: { t_s: [0, 10], turn_deg: [0, 100] } }] };
  const drives = [];
  const equipment = new Equipment(scenario, { t: [], columns: new Map() }, [], drives);
  const turns = (...times) => times.map((t) => equipment.at(t).plates[1].turn);
  assert.deepEqual(turns(2, 4), [20, 40]);
  drives.push({ t_s: 3, obstacle: "flap", state: "behind", turn_deg: 30 }, { t_s: 4, obstacle: "flap", state: "stalled", turn_deg: 34 });
  assert.deepEqual(turns(2, 3.5, 4, 9), [20, 32, 34, 34]);
  drives.push({ t_s: 5, obstacle: "flap", state: "behind", turn_deg: 34 }, { t_s: 6, obstacle: "flap", state: "as_told", turn_deg: 60 });
  assert.deepEqual(turns(4.5, 5.5, 6, 7), [34, 47, 60, 70]);
});

test("parts of fed runs are told by their ids, enter over the feed and leave with their velocity", () => {
  const columns = ["id", "kind", "x_m", "y_m", "heading_rad", "vx_m_s", "vy_m_s", "spin_rad_s"];
  const frame = (...rows) => ({ shape: [rows.length, columns.length], data: Float64Array.from(rows.flat()) });
  const before = frame([3, 0, 0.9, 0.5, 0, 1, 0, 0], [5, 1, 0.4, 0.5, 0.2, 1, 0, 0]);
  const after = frame([5, 1, 0.6, 0.5, 0.4, 1, 0, 0], [6, 0, 0.15, 0.5, 0, 1, 0, 0], [7, 0, 0.05, 0.5, 0, 1, 0, 0]);
  const seen = (share) => {
    const list = [];
    new PartsLayer(columns, { kinds: [] }, [[[0, 0], [0, 1]]]).each({ frame: before, next: after, share, gap: 0.2 },
      ({ kind, x, heading }) => list.push([kind, x, heading]));
    return list;
  };
  assert.deepEqual(seen(0), [[0, 0.9, 0], [1, 0.4, 0.2]]);
  // Half way, 0.1 s: part 3 goes on to 1.0, part 5 is between its places, 6 entered at 0.05, 7 is not there yet.
  const half = seen(0.5);
  assert.deepEqual(half.map(([kind]) => kind), [0, 1, 0]);
  [[1.0, 0], [0.5, 0.3], [0.05, 0]].forEach(([x, heading], k) => {
    near(half[k][1], x);
    near(half[k][2], heading);
  });
});

test("between two pictures a part keeps its velocities, and never passes the places where it was seen", () => {
  const columns = ["x_m", "y_m", "heading_rad", "vx_m_s", "vy_m_s", "spin_rad_s"];
  const frame = (...row) => ({ shape: [1, columns.length], data: Float64Array.from(row) });
  const at = (before, after, share) => {
    let place = null;
    new PartsLayer(columns, { kinds: [], kindOfPart: () => 0 }, []).each({ frame: before, next: after, share, gap: 1 }, ({ x, y }) => (place = [x, y]));
    return place;
  };
  // Uniform acceleration: from rest to 0.2 m/s in 1 s over 0.1 m, so 0.025 m at half the time.
  const [x, y] = at(frame(0, 0.3, 0, 0, 0, 0), frame(0.1, 0.3, 0, 0.2, 0, 0), 0.5);
  near(x, 0.025);
  near(y, 0.3);
  // It ran at 0.9 m/s against something and stands 0.1 m farther on.
  for (let share = 0.05; share < 1; share += 0.05) {
    const there = at(frame(0, 0, 0, 0.9, 0, 0), frame(0.1, 0, 0, 0, 0, 0), share)[0];
    assert.ok(there >= 0 && there <= 0.1 + 1e-12, String(there));
  }
});

test("a fed run's flow is the sum of its feeds and what left, its content the counters and what waits", () => {
  const scenario = { counters: [{ id: "upstream" }], feeds: [{ id: "a" }, { id: "b" }] };
  const columns = new Map(Object.entries({ upstream: [0, 3], left_domain: [0, 1], "a.offered": [0, 4], "a.admitted": [0, 3],
    "a.waiting": [0, 1], "a.discarded": [0, 0], "b.offered": [0, 2], "b.admitted": [0, 1], "b.waiting": [0, 1], "b.discarded": [0, 0] }));
  assert.deepEqual(columnsOf(scenario).map(([name]) => name), [...columns.keys()]);
  assert.deepEqual(flowOf(scenario, { columns }),
    [["offered", [0, 6]], ["admitted", [0, 4]], ["waiting", [0, 2]], ["left the belt", [0, 1]]]);
  assert.deepEqual(fallsOf({ columns: new Map([["fallen", [0, 0.01]]]) }), []); // a density spreads without end
  columns.set("fallen", [0, 3]);
  assert.deepEqual(flowOf(scenario, { columns }).at(-1), ["fell off the belts", [0, 3]]);
  assert.deepEqual(contentOf(scenario, { columns }),
    [["parts upstream", [0, 3]], ["a: waiting", [0, 1]], ["b: waiting", [0, 1]]]);
});

test("scenarios differ in what a planner calls it, however they were written", async (t) => {
  const d = await daemon(t);
  const written = (await d.get("/v1/examples/example-1")).json;
  const { resolved } = (await d.post("/v1/validate", { scenario: written })).json;
  assert.deepEqual(differences([written, resolved]).filter(({ isUsual }) => isUsual), []);
  const steeper = structuredClone(resolved);
  // Half a metre across the belt at 75 degrees.
  steeper.obstacles[0].path_m[0][0] = 0.75 - 0.5 / Math.tan((75 * Math.PI) / 180);
  steeper.belts[0].velocity_m_s = [0.5, 0];
  steeper.macro.cell_m = 0.01;
  const rows = differences([resolved, steeper]);
  assert.deepEqual(rows.map(({ pointer, label }) => [pointer, label]),
    [["/obstacles/0/angle_deg", "angle"], ["/belts/0/velocity_m_s", "belt speed"], ["/macro/cell_m", "cell"]]);
  assert.deepEqual(chipsOf(rows, 1), ["angle 75°", "belt speed 0.5 m/s", "cell 0.01 m"]);

  steeper.name = nameOfVariant(resolved, steeper);
  assert.equal(steeper.name, "Example 1, angle 75°, belt speed 0.5 m/s, cell 0.01 m");
  // Of a variant's variant the name says both, with the values that hold.
  const longer = { ...structuredClone(steeper), duration_s: 9, macro: resolved.macro };
  assert.equal(nameOfVariant(steeper, longer), "Example 1, angle 75°, belt speed 0.5 m/s, duration 9 s, cell 0.005 m");
  assert.equal(nameOfVariant(resolved, structuredClone(resolved)), null);
  // What a study's pointers name.
  for (const [pointer, label, unit] of [["/obstacles/0/angle_deg", "angle", "°"], ["/obstacles/0/from_m/0", "foot x", "m"],
    ["/belts/0/velocity_m_s/0", "belt speed", "m/s"], ["/contacts/handling_cargo/friction", "friction at plates and walls", ""]]) {
    const known = parameterAt(pointer, resolved);
    assert.deepEqual([known.label, known.unit], [label, unit]);
  }
  // Of an oblique belt each component is a parameter.
  const oblique = { ...resolved, belts: [{ id: "main", velocity_m_s: [0.3, -0.4] }] };
  assert.deepEqual(studyParameters(oblique, oblique).filter(({ pointer }) => pointer.startsWith("/belts")).map(({ label, value, range }) => [label, value, range]),
    [["belt speed along x", 0.3, [0.21, 0.39]], ["belt speed along y", -0.4, [-0.52, -0.28]]]);
  assert.deepEqual(studyParameters(resolved, resolved).filter(({ pointer }) => pointer.startsWith("/belts")).map(({ label }) => label), ["belt speed"]);
  // What its name says of the velocity is not that of the trials.
  const [along] = studyParameters(oblique, oblique).filter(({ pointer }) => pointer.startsWith("/belts"));
  const named = { ...oblique, name: "side belt, belt speed 0.5 m/s, belt direction -53.13°" };
  assert.equal(baseFor(named, [{ parameter: along, values: along.range }]).name, "side belt");
  // Lists that are too long to be said are numbered.
  const [a, b] = [1, 2].map((x) => ({ ...resolved, initial: { positions_m: Array.from({ length: 5 }, (_, k) => [x, k]) } }));
  assert.deepEqual(differences([a, b, a]).map(({ label, values }) => [label, values]), [["initial positions", ["list 1", "list 2", "list 1"]]]);
});

test("the trials of a point have a mean and its 95 % interval by Student's distribution", () => {
  // Standard deviation 1 of three values; t of 2 degrees of freedom is 4.303 (a table of the distribution).
  const { mean, low, high } = intervalOf([1, 2, 3]);
  near(mean, 2);
  near(high, 2 + 4.303 / Math.sqrt(3));
  near(low, 2 - 4.303 / Math.sqrt(3));
  assert.deepEqual(intervalOf([5]), { n: 1, mean: 5, low: null, high: null });
  const trial = (point, model, values) => ({ point, model, parameters: { "/a": point }, values });
  const points = pointsOf([trial(0, "macro", { f: 1 }), trial(0, "micro", { f: 3 }), trial(0, "macro", { f: 3 }), trial(1, "macro", {})], "f");
  assert.deepEqual(points.map(({ point, model, n, mean: m }) => [point, model, n, m]), [[0, "macro", 2, 2], [0, "micro", 1, 3]]);
});

test("folders of modules do not need each other in a circle", () => {
  const root = new URL("../../web/src/", import.meta.url);
  const files = readdirSync(root, { recursive: true }).filter((name) => name.endsWith(".js") && name.includes("/"));
  const needs = new Map();
  for (const file of files) {
    const [folder] = file.split("/");
    for (const [, target] of readFileSync(new URL(file, root), "utf8").matchAll(/^(?:import|export) [^;]*from "\.\.\/(\w+)\/[^"]*";$/gm)) {
      needs.set(folder, (needs.get(folder) ?? new Set()).add(target));
    }
  }
  assert.ok(needs.get("runs").has("base"));
  const follow = (folder, way) => {
    assert.ok(!way.includes(folder), [...way, folder].join(" needs "));
    for (const next of needs.get(folder) ?? []) follow(next, [...way, folder]);
  };
  for (const folder of needs.keys()) follow(folder, []);
});

test("a search is a text, or conditions on numbers in a planner's words or the members' names", () => {
  const where = (text) => searchOf(text).where;
  assert.deepEqual(searchOf("hall 1"), { search: "hall 1", where: "", fault: "" });
  assert.deepEqual(searchOf('"mu=0.3"'), { search: "mu=0.3", where: "", fault: "" });
  assert.equal(where("angle > 50"), "angle_deg>50");
  assert.equal(where("Angle ≥ 62,5°; belt speed<0.4 m/s and throughput > 20000/h"), "angle_deg>=62.5,speed_m_s<0.4,throughput_per_h>20000");
  assert.equal(where("friction between parts = 0.15"), "/contacts/cargo_cargo/friction=0.15");
  assert.equal(where("cargo/mass_kg<=2"), "cargo/mass_kg<=2");
  assert.equal(where("wall friction=1e-3"), "wall_friction=0.001");
  assert.match(searchOf("angle > steep").fault, /What "angle" is compared with must be a number/);
  // What follows a number is its unit, or nothing that goes unread.
  assert.equal(where("mass < 2 kg; residence < 4s; feed > 2 parts/s; angle = 50 deg; throughput > 2000 per h; peak < 2 layers"),
    "mass_kg<2,residence_s/p95<4,rate_per_s>2,angle_deg=50,throughput_per_h>2000,peak_density<2");
  for (const text of ["mass < 2 kg", "residence < 4s", "feed > 2 parts/s", "angle = 50 deg", "throughput > 2000 per h", "peak < 2 layers"]) assert.equal(searchOf(text).fault, "");
  assert.equal(searchOf("mass < 500 g").fault, 'After 500 there may be kg, or ; and another condition, not "g"');
  assert.equal(searchOf("residence < 10 min").fault, 'After 10 there may be s, or ; and another condition, not "min"');
  for (const text of ["angle > 50, mass < 2", "angle > 50 or mass < 2", "angle > 50 mass < 2", "peak < 2, angle > 50", "peak < 2 or angle > 50"]) {
    assert.match(searchOf(text).fault, /another condition/, text);
  }
  assert.equal(where("constructor = 1"), "constructor=1");
  assert.deepEqual(searchOf("angle != 5"), { search: "angle != 5", where: "", fault: "" });
});

test("numbers are read by the decimal mark that they make sense with, and those of two meanings are not taken", () => {
  const read = (text, hasComma) => readNumber(text, hasComma).value;
  for (const hasComma of [true, false]) {
    for (const [text, value] of [["62,5", 62.5], ["62.5", 62.5], ["1.010,5", 1010.5], ["1,010.5", 1010.5], ["1 010", 1010], ["0,125", 0.125], ["0.125", 0.125],
      ["1.000.000", 1e6], ["\u22123", -3], ["1e-5", 1e-5], ["2,5e3", 2500]]) assert.equal(read(text, hasComma), value, text);
    for (const text of ["", "x", "1,2,3", "--1", "0x10", "1.2.3", "Infinity", "12,34.5"]) assert.equal(readNumber(text, hasComma).fault, "must be a number", text);
  }
  assert.deepEqual([read("1.010", false), read("1,010", false)], [1.01, 1010]); // as the page writes them
  assert.equal(readNumber("1.010", true).fault, "may mean 1.01 or 1010: write 1.01 or 1010");
  assert.equal(readNumber("1,125", true).fault, "may mean 1125 or 1.125: write 1125 or 1.1250");
  for (const value of [1.125, 0.125, 1125, 12.5, -3.125, 1e-7, 1234567.125]) assert.equal(read(writeNumber(value, true), true), value);
  assert.deepEqual([marksOf(["50,0", "1.010"]), marksOf(["50.0", "1,010"]), marksOf(["50", "1.010"]), marksOf(["50", ""]), marksOf(["5,5", "5.5"])],
    [[","], ["."], [".", ","], ["."], []]);
});
