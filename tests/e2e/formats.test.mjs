// Every format of the results, read back by readers that are not ours (read_back.py: NumPy, an XML
// parser, zipfile), and the same whichever way they are fetched.

import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { shortMix, smallJam, solveMicro } from "./micro.mjs";
import { runTool } from "./processes.mjs";
import { solve } from "./results.mjs";
import { endless, jam, tiny } from "./scenarios.mjs";
import { root, temporaryFolder } from "./setup.mjs";

const planar = ["x_m", "y_m", "heading_rad", "vx_m_s", "vy_m_s", "spin_rad_s"];
const spatial = ["x_m", "y_m", "z_m", "q_w", "q_x", "q_y", "q_z", "vx_m_s", "vy_m_s", "vz_m_s",
  "wx_rad_s", "wy_rad_s", "wz_rad_s"];

// NumPy is Debian's, so the interpreter is, too.
async function readBack(folder) {
  const done = await runTool("/usr/bin/python3", ["-B", path.join(root, "tests/e2e/read_back.py"), folder]);
  assert.equal(done.status, 0, done.stderr);
  return JSON.parse(done.stdout);
}

// Fetch snapshot n of a run that has ended in all its formats, its parts, and the archive; what
// read_back.py makes of them, and the folder.
async function fetchAll(t, d, id, n, hasParts) {
  const folder = temporaryFolder(t);
  const save = async (file, target) => {
    const answer = await d.get(target);
    assert.equal(answer.status, 200, `${target}: ${answer.text}`);
    writeFileSync(path.join(folder, file), answer.body);
    return answer;
  };
  for (const format of ["npy", "csv", "json", "vti"])
    await save(`snapshot.${format}`, `/v1/runs/${id}/snapshots/${n}?format=${format}`);
  for (const format of hasParts ? ["npy", "csv", "json", "vtp"] : [])
    await save(`parts.${format}`, `/v1/runs/${id}/parts/${n}?format=${format}`);
  const { headers } = await save("results.zip", `/v1/runs/${id}/results.zip?vtk=1`);
  assert.equal(headers["content-type"], "application/zip");
  return { folder, found: await readBack(folder) };
}

// Every file of the command line's folder is in the archive with the same bytes; the summary differs
// in its timing.
function assertSameFolder(ours, theirs) {
  for (const name of listFiles(theirs)) {
    const file = path.join(theirs, name);
    assert.ok(existsSync(path.join(ours, name)), name);
    if (name !== "summary.json")
      assert.ok(readFileSync(path.join(ours, name)).equals(readFileSync(file)), name);
  }
}

function listFiles(folder, below = "") {
  return readdirSync(path.join(folder, below), { withFileTypes: true }).flatMap((entry) => {
    const name = path.join(below, entry.name);
    return entry.isDirectory() ? listFiles(folder, name) : [name];
  });
}

test("a snapshot holds the same numbers in every format, where its grid lies", async (t) => {
  const d = await daemon(t);
  const scenario = tiny({
    domain: { x_m: [-0.12, 0.13], y_m: [0.5, 0.62] },
    initial: { positions_m: [[-0.06, 0.56]] },
  });
  const run = await d.submit(scenario);
  await d.reached(run.id, "succeeded");
  const { folder, found } = await fetchAll(t, d, run.id, 1, false);
  assert.deepEqual(found.snapshot.shape, [12, 25]);
  assert.deepEqual(found.snapshot.origin_m, [-0.12, 0.5]);
  assert.ok(Math.abs(found.snapshot.t_s - 0.05) < 1e-9);
  assert.ok(found.snapshot.mean > 0);
  assert.deepEqual(found.archive.series, { "snapshots.pvd": 3 });
  assertSameFolder(path.join(folder, "unpacked"), await solve(t, scenario));
});

test("parts hold the same numbers in every format, and those that left are no points", async (t) => {
  const d = await daemon(t);
  // One part leaves before the end: 0.395 m/s, 2 cm from the edge.
  const scenario = smallJam({
    obstacles: [],
    counters: undefined,
    initial: { positions_m: [[0.98, 0.1], [0.5, 0.2], [0.6, 0.3]] },
  });
  const run = await d.submit(scenario, { model: "micro" });
  await d.reached(run.id, "succeeded");
  const { folder, found } = await fetchAll(t, d, run.id, 3, true);
  assert.deepEqual(found.parts, { n: 2, columns: planar });
  assert.deepEqual(found.archive.series, { "parts.pvd": 4, "snapshots.pvd": 4 });
  assertSameFolder(path.join(folder, "unpacked"), await solveMicro(t, scenario));
});

test("parts in space have their quaternions in every format", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(shortMix(), { model: "micro" });
  await d.reached(run.id, "succeeded");
  const { found } = await fetchAll(t, d, run.id, 2, true);
  assert.deepEqual(found.parts, { n: 6, columns: spatial });
});

test("one request gets several snapshots, as files one after the other", async (t) => {
  const d = await daemon(t);
  const { id } = await d.submit(shortMix(), { model: "micro" });
  await d.reached(id, "succeeded");
  const { snapshots } = (await d.get(`/v1/runs/${id}/snapshots`)).json;
  assert.ok(snapshots.length >= 3);
  for (const what of ["snapshots", "parts"]) {
    const each = await Promise.all(snapshots.map(({ n }) => d.get(`/v1/runs/${id}/${what}/${n}`)));
    const joined = (from, count) => Buffer.concat(each.slice(from, from + count).map(({ body }) => body));
    const two = await d.get(`/v1/runs/${id}/${what}/0?count=2`);
    assert.ok(two.body.equals(joined(0, 2)));
    assert.match(two.headers["cache-control"], /immutable/);
    // As many as there are; more may come to a run that goes on, so that who keeps them asks again.
    const rest = await d.get(`/v1/runs/${id}/${what}/1?count=64`);
    assert.ok(rest.body.equals(joined(1, snapshots.length)));
    assert.doesNotMatch(rest.headers["cache-control"], /immutable/);
    assert.notEqual(rest.headers.etag, two.headers.etag);
    assert.equal((await d.get(`/v1/runs/${id}/${what}/1?count=64`, { "if-none-match": rest.headers.etag })).status, 304);
    assert.ok((await d.get(`/v1/runs/${id}/${what}/0?count=1`)).body.equals(each[0].body));
    for (const wrong of ["count=65", "count=0", "count=2&format=json"]) {
      assert.equal((await d.get(`/v1/runs/${id}/${what}/0?${wrong}`)).status, 400, wrong);
    }
    assert.equal((await d.get(`/v1/runs/${id}/${what}/${snapshots.length}?count=2`)).status, 404);
  }
});

test("a picture is in proportion and as wide as asked, and what it cannot be is said", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  await d.reached(run.id, "succeeded");
  const target = `/v1/runs/${run.id}/snapshots/2`;
  for (const [query, width, height] of [["", 984, 492], ["&width=480", 480, 240], ["&width=10", 10, 5]]) {
    const answer = await d.get(`${target}?format=png${query}`);
    assert.deepEqual([answer.status, answer.headers["content-type"]], [200, "image/png"]);
    assert.equal(answer.body.subarray(1, 4).toString(), "PNG");
    assert.deepEqual([answer.body.readUInt32BE(16), answer.body.readUInt32BE(20)], [width, height]);
    const again = await d.get(`${target}?format=png${query}`, { "if-none-match": answer.headers.etag });
    assert.equal(again.status, 304);
  }
  const pictures = await Promise.all(
    ["", "&colormap=grey", "&colormap=cividis", "&max=0.5"].map((query) => d.get(`${target}?format=png${query}`)),
  );
  assert.equal(new Set(pictures.map(({ body }) => body.toString("base64"))).size, 4);
  for (const query of ["format=png&width=9000", "format=png&colormap=jet", "format=png&max=-1", "width=10"])
    assert.equal((await d.get(`${target}?${query}`)).status, 400, query);
  assert.equal((await d.get(target, { accept: "image/png;q=0.5, image/*;q=0.1" })).headers["content-type"], "image/png");
  assert.equal((await d.get(target, { accept: "image/webp" })).status, 406);
});

test("the archive of a run is the same bytes each time, and comes at its end", async (t) => {
  const d = await daemon(t, {}, { TZ: "America/New_York" });
  const run = await d.submit(jam(1, { curve_every_s: 0.01, snapshot_every_s: 0.1 }));
  await d.reached(run.id, "succeeded");
  const { links, finished_at } = await d.run(run.id);
  const first = await d.get(links.results);
  const second = await d.get(links.results);
  assert.equal(first.headers["content-disposition"], `attachment; filename="${run.id}.zip"`);
  assert.ok(first.body.equals(second.body));
  assert.equal(first.headers.etag, second.headers.etag);
  assert.equal((await d.get(links.results, { "if-none-match": first.headers.etag })).status, 304);
  assert.equal((await d.request("HEAD", links.results)).status, 200);
  assert.notEqual((await d.get(`${links.results}?vtk=1`)).headers.etag, first.headers.etag);
  // The time of day of the first file, as DOS has it, to two seconds; in UTC wherever the daemon is.
  const [, hours, minutes] = /T(\d+):(\d+):/.exec(finished_at).map(Number);
  assert.deepEqual([first.body.readUInt16LE(10) >> 11, (first.body.readUInt16LE(10) >> 5) & 63], [hours, minutes]);

  const going = await d.submit(endless());
  await d.reached(going.id, "running");
  const early = await d.get(`/v1/runs/${going.id}/results.zip`);
  assert.deepEqual([early.status, early.json.status], [409, 409]);
  assert.equal((await d.get(`/v1/runs/${going.id}/snapshots.pvd`)).status, 200);
  assert.equal((await d.post(`/v1/runs/${going.id}/cancel`, "")).status, 202);
  await d.reached(going.id, "cancelled");
  assert.equal((await d.get(`/v1/runs/${going.id}/results.zip`)).status, 200);
});

test("the curve and the events have their formats", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  await d.reached(run.id, "succeeded");
  const { links } = await d.run(run.id);
  const curve = (await d.get(links.curve)).json;
  const lines = (await d.get(links.curve, { accept: "text/csv" })).text.trimEnd().split("\n");
  assert.equal(lines[0], ["t_s", ...Object.keys(curve.columns)].join(","));
  assert.deepEqual(
    lines.slice(1).map((line) => line.split(",").map(Number)),
    curve.t_s.map((t_s, k) => [t_s, curve.columns.upstream[k], curve.columns.left_domain[k]]),
  );
  const answer = await d.get(links.events, { accept: "application/x-ndjson" });
  assert.equal(answer.headers["content-type"], "application/x-ndjson");
  const events = answer.text.trimEnd().split("\n").map((line) => JSON.parse(line));
  assert.equal(events.at(-1).event, "end");
  for (const event of events) assert.deepEqual(Object.keys(event), ["id", "run", "event", "data"]);
});
