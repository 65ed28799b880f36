// The two programs as used in a terminal: commands, exit codes, refusals.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { existsSync, readdirSync, readFileSync, readlinkSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { beltflow, runProgram } from "./processes.mjs";
import { solve } from "./results.mjs";
import { endless, jam, tiny } from "./scenarios.mjs";
import { binaries, temporaryFolder, within } from "./setup.mjs";

test("both programs tell their version and how to use them", async () => {
  for (const program of ["beltflow", "beltflowd"]) {
    const version = await runProgram(program, ["--version"]);
    assert.deepEqual([version.status, version.stderr], [0, ""]);
    assert.match(version.stdout, new RegExp(`^${program} \\d+\\.\\d+\\.\\d+`));
    const help = await runProgram(program, ["--help"]);
    assert.equal(help.status, 0);
    assert.match(help.stdout, /[Uu]sage/);
  }
});

test("a daemon whose port is taken says so and leaves with 1", async (t) => {
  const d = await daemon(t);
  const data = temporaryFolder(t);
  const second = await runProgram("beltflowd", ["--listen", `127.0.0.1:${d.port}`, "--data", data]);
  assert.equal(second.status, 1);
  assert.match(second.stderr, new RegExp(`port ${d.port} .*taken`));
  assert.equal(second.stdout, "");
});

test("a daemon that is told nonsense says which word and leaves with 2", async (t) => {
  const data = temporaryFolder(t);
  for (const [flags, word] of [
    [["--wrkers", "2"], /wrkers/],
    [["--workers", "many"], /workers/],
    [["--workers", "65"], /workers/],
    [["--listen", "nowhere"], /nowhere/],
    [["--config", path.join(data, "missing.conf")], /missing\.conf/],
    [["surplus"], /surplus/],
  ]) {
    const done = await runProgram("beltflowd", ["--data", data, ...flags]);
    assert.equal(done.status, 2, `${flags}`);
    assert.match(done.stderr, word);
  }
});

test("a configuration file counts, the environment more, a flag most", async (t) => {
  const folder = temporaryFolder(t);
  const config = path.join(folder, "beltflowd.conf");
  writeFileSync(config, "# a comment\nqueue_limit = 1\nworkers = 1\n");
  const env = { BELTFLOW_QUEUE_LIMIT: "2" };
  for (const [settings, environment, limit] of [
    [{ config }, {}, 1],
    [{ config }, env, 2],
    [{ config, queue_limit: 3 }, env, 3],
  ]) {
    const d = await daemon(t, settings, environment);
    await d.reached((await d.submit(endless())).id, "running");
    for (let k = 0; k < limit; k++) await d.submit(tiny());
    assert.equal((await d.post("/v1/runs", { scenario: tiny() })).status, 503, `limit ${limit}`);
    await d.stop();
  }
});

test("a setting that is not known is told with its line or its variable", async (t) => {
  const folder = temporaryFolder(t);
  const file = path.join(folder, "beltflowd.conf");
  writeFileSync(file, "workers = 1\nnonsense = 3\n");
  const refused = await runProgram("beltflowd", ["--config", file, "--data", folder]);
  assert.equal(refused.status, 2);
  assert.match(refused.stderr, /:2/);
  const env = { BELTFLOW_WORKERS: "many" };
  const confused = await runProgram("beltflowd", ["--data", folder], { env });
  assert.equal(confused.status, 2);
  assert.match(confused.stderr, /BELTFLOW_WORKERS/);
});

test("a daemon without standard streams logs to nobody, not into a file or to a client", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const command = 'exec "$0" --listen 127.0.0.1:0 --data "$1" <&- 2>&-';
  const child = spawn("/bin/sh", ["-c", command, path.join(binaries, "beltflowd"), data], {
    stdio: ["ignore", "pipe", "ignore"],
  });
  const exited = once(child, "close");
  t.after(() => child.kill("SIGKILL"));
  await within(once(child.stdout, "data"), "the daemon's first line");
  for (const fd of [0, 2]) assert.equal(readlinkSync(`/proc/${child.pid}/fd/${fd}`), "/dev/null");
  child.kill("SIGTERM");
  assert.deepEqual(await within(exited, "the daemon's end"), [0, null]);
});

test("SIGINT stops a daemon as SIGTERM does", async (t) => {
  const d = await daemon(t);
  d.process.kill("SIGINT");
  assert.deepEqual(await d.exited, { code: 0, signal: null });
  d.process = null;
});

test("check says yes, or names the places and leaves with 2", async () => {
  const good = await beltflow(["check", "-"], { input: JSON.stringify(tiny()) });
  assert.deepEqual([good.status, good.stderr], [0, ""]);
  const bad = await beltflow(["check", "-"], { input: JSON.stringify(tiny({ duration_s: "1", a: 1 })) });
  assert.equal(bad.status, 2);
  assert.match(bad.stderr, /^\/duration_s: .+$/m);
  assert.match(bad.stderr, /^\/a: .+$/m);
  const text = await beltflow(["check", "-"], { input: "{" });
  assert.equal(text.status, 2);
  assert.match(text.stderr, /^beltflow check: line 1, column 1: not JSON: /);
});

test("check warns of results that are to be doubted, and says yes", async () => {
  const input = JSON.stringify(jam(1, {}));
  const macro = await beltflow(["check", "-"], { input });
  assert.equal(macro.status, 0);
  assert.match(macro.stderr, /^warning: \/obstacles\/0: The narrowest opening is 0 part diameters wide\. The deflectors close the belt: .+$/m);
  const micro = await beltflow(["check", "-", "--model", "micro"], { input });
  assert.equal(micro.status, 0);
  assert.match(micro.stderr, /^warning: \/obstacles\/0: The narrowest opening is 0 part diameters wide\. The deflectors close the belt: .+$/m);
});

test("solve writes every result, the list of them, and a summary", async (t) => {
  const out = await solve(t, tiny());
  assert.deepEqual(readdirSync(out).sort(), ["curve.csv", "scenario.json", "snapshots", "snapshots.json", "summary.json"]);
  const lines = readFileSync(path.join(out, "curve.csv"), "utf8").trimEnd().split("\n");
  assert.equal(lines[0], "t_s,upstream,left_domain");
  assert.equal(lines.length, 1 + 11);
  const list = JSON.parse(readFileSync(path.join(out, "snapshots.json")));
  assert.deepEqual(list.snapshots.map(({ file }) => file), [0, 1, 2].map((n) => `snapshots/00000${n}.npy`));
  for (const { file } of list.snapshots) assert.ok(existsSync(path.join(out, file)));
  const summary = JSON.parse(readFileSync(path.join(out, "summary.json")));
  assert.equal(summary.model, "macro");
  assert.equal(summary.scenario.duration_s, 0.1);
});

test("solve leaves with 2 for input at fault and 1 for what it cannot write", async (t) => {
  const folder = temporaryFolder(t);
  const out = path.join(folder, "out");
  const solveWith = (args, input = JSON.stringify(tiny())) => beltflow(["solve", ...args], { input });
  const bad = await solveWith(["-", "--model", "macro", "--out", out], '{"duration_s": 1}');
  assert.equal(bad.status, 2);
  assert.match(bad.stderr, /^\/domain: /m);
  assert.ok(!existsSync(path.join(out, "curve.csv")));
  const missing = await solveWith([path.join(folder, "none.json"), "--model", "macro", "--out", out]);
  assert.equal(missing.status, 2);
  assert.match(missing.stderr, /none\.json/);
  const nowhere = await solveWith(["-", "--model", "macro", "--out", "/proc/nowhere/out"]);
  assert.equal(nowhere.status, 1);
});

test("compare reads folders and files, and leaves with 2 for what is no curve", async (t) => {
  const folder = temporaryFolder(t);
  const out = await solve(t, tiny());
  const same = await beltflow(["compare", out, path.join(out, "curve.csv")]);
  assert.equal(same.status, 0, same.stderr);
  const measured = path.join(folder, "measured.csv");
  writeFileSync(measured, "t_s,count\n0,1\n0.05,1\n0.1,0\n");
  assert.equal((await beltflow(["compare", out, measured])).status, 0);
  writeFileSync(measured, "t_s,count\n0,1\nx,1\n");
  const bad = await beltflow(["compare", out, measured]);
  assert.equal(bad.status, 2);
  assert.match(bad.stderr, /line 3|:3/);
  assert.equal((await beltflow(["compare", out, path.join(folder, "none.csv")])).status, 2);
});

test("words that the program does not know are told, with status 2", async () => {
  for (const args of [[], ["solved"], ["solve"], ["check", "a", "b"], ["check", "-", "--colour"]]) {
    const done = await beltflow(args);
    assert.equal(done.status, 2, `${args}: ${done.stderr}`);
    assert.notEqual(done.stderr, "");
  }
});

test("the curve can be drawn in the terminal", async (t) => {
  const out = await solve(t, tiny());
  const drawn = await beltflow(["draw", path.join(out, "curve.csv")]);
  assert.equal(drawn.status, 0, drawn.stderr);
  assert.ok(drawn.stdout.split("\n").length > 5);
});
