// Modules of the page that compute, against the daemon and against values that are derived.

import assert from "node:assert/strict";
import test from "node:test";

import { dealKinds } from "../../web/src/cargo.js";
import { areaOf, convexHull, hullCentre } from "../../web/src/geometry.js";
import { formatJson, locate } from "../../web/src/json_text.js";
import { readNpy } from "../../web/src/npy.js";
import { measureGap, readMeasured, valueAt } from "../../web/src/series.js";
import { daemon } from "./daemon.mjs";

const near = (a, b, tolerance = 1e-9) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
const bytesOf = ({ body }) => body.buffer.slice(body.byteOffset, body.byteOffset + body.length);

test("parts of a mix are of the kinds that the solver dealt, told by the heights of their centres", async (t) => {
  const d = await daemon(t);
  const example = (await d.get("/v1/examples/mixed-cargo")).json;
  const run = await d.submit({ ...example, duration_s: 0.001, output: { curve_every_s: 0.001 } }, { model: "micro" });
  await d.reached(run.id, "succeeded");
  const { shape: [n, columns], data } = readNpy(bytesOf(await d.get(`/v1/runs/${run.id}/parts/0`)));
  const kinds = dealKinds(example.cargo, 1, n);
  for (let k = 0; k < n; k++) near(data[k * columns + 2], example.cargo[kinds[k]].shape.height_m / 2, 1e-6);
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

test("gaps of curves are those of the daemon's comparison", async (t) => {
  const d = await daemon(t);
  const example = (await d.get("/v1/examples/example-1")).json;
  const ids = [];
  for (const speed of [0.395, 0.5]) {
    const belts = [{ id: "main", velocity_m_s: [speed, 0] }];
    const run = await d.submit({ ...example, belts, duration_s: 3, macro: { cell_m: 0.02, step_s: "auto" } });
    await d.reached(run.id, "succeeded");
    ids.push(run.id);
  }
  const [a, b] = await Promise.all(ids.map(async (id) => {
    const { t_s: times, upstream } = (await d.get(`/v1/runs/${id}/curve`)).json;
    return { t: times, v: upstream };
  }));
  const { curve } = (await d.get(`/v1/compare?a=${ids[0]}&b=${ids[1]}`)).json;
  const gap = measureGap(a, b);
  for (const name of ["l1", "l2", "largest", "largest_at_s"]) near(gap[name], curve[name]);
  near(gap.rate_per_s, curve.rate_b_per_s);
});

test("the gap of two lines that cross is exact", () => {
  // From 1 above to 1 below over 2 s: mean 1/2, square mean 1/3.
  const gap = measureGap({ t: [0, 2], v: [2, 0] }, { t: [0, 2], v: [1, 1] });
  near(gap.l1, 0.5);
  near(gap.l2, Math.sqrt(1 / 3));
  near(gap.largest, 1);
  assert.equal(measureGap({ t: [0, 1], v: [1, 1] }, { t: [2, 3], v: [1, 1] }), null);
  near(valueAt([0, 2], [0, 10], 0.5), 2.5);
});

test("measured counts are read, and what is wrong is named by its line", () => {
  assert.deepEqual(readMeasured("t_s,count\r\n0,192\r\n0.5,190\r\n"), { name: "count", t: [0, 0.5], v: [192, 190] });
  assert.throws(() => readMeasured("time;n\n0;1"), /Line 1/);
  assert.throws(() => readMeasured("t_s,count\n0,1\n0,2"), /Line 3: times must rise/);
  assert.throws(() => readMeasured("t_s,count\n0,"), /Line 2/);
  assert.throws(() => readMeasured("t_s,count\n"), /no sample/);
});

test("a pointer leads to its place in the text, or to the nearest one around it", () => {
  const text = '{\n "a": [1, {"b/c": "x"}],\n "d": {} }';
  const at = (pointer) => {
    const { start, end, isExact } = locate(text, pointer);
    return [text.slice(start, end), isExact];
  };
  assert.deepEqual(at("/a/1/b~1c"), ['"b/c": "x"', true]);
  assert.deepEqual(at("/a/0"), ["1", true]);
  assert.deepEqual(at("/d"), ['"d": {}', true]);
  assert.deepEqual(at("/d/e"), ['"d": {}', false]);
  assert.deepEqual(JSON.parse(formatJson(JSON.parse(text))), JSON.parse(text));
});

test("hulls and their centres are those of plain bodies", () => {
  assert.equal(convexHull([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]]).length, 4);
  near(areaOf([[0, 0], [2, 0], [2, 1], [0, 1]]).area, 2);
  // A tetrahedron: the mean of its corners.
  const centre = hullCentre([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]);
  for (const value of centre) near(value, 0.25, 1e-4);
});
