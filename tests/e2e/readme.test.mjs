// The README's blocks of code work as pasted, against a real daemon.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { binaries, isSanitized, patience, root, temporaryFolder, within } from "./setup.mjs";

const readme = readFileSync(path.join(root, "README.md"), "utf8");

// The blocks of a language that are to be pasted; those marked `console` only show.
function blocksToPaste(language) {
  return [...readme.matchAll(new RegExp(`^\`\`\`${language}\\n(.*?)^\`\`\`$`, "gms"))].map(([, text]) => text);
}

function run(command, args, folder) {
  const done = new Promise((resolve) => {
    const child = spawn(command, args, { cwd: folder });
    let output = "";
    child.stdout.on("data", (chunk) => (output += chunk));
    child.stderr.on("data", (chunk) => (output += chunk));
    child.on("close", (status) => resolve({ status, output }));
  });
  // Studies compute at a low priority beside other stories.
  return within(done, "the README's lines", 2 * patience);
}

test("the README's lines submit Example 1, stream it to its end and read its results", { skip: isSanitized }, async (t) => {
  const d = await daemon(t);
  const blocks = blocksToPaste("sh").filter((block) => block.includes("curl"));
  assert.ok(blocks.length >= 3);
  // Pasted one after the other into one shell, so that what one sets the next one finds.
  const script = blocks
    .join("\n")
    .replaceAll("127.0.0.1:8080", `127.0.0.1:${d.port}`)
    .replaceAll("build/release/bin/", `${binaries}/`)
    .replaceAll("api/scenario/examples/", `${root}/api/scenario/examples/`);
  const { status, output } = await run("bash", ["-euo", "pipefail", "-c", script], temporaryFolder(t));
  assert.equal(status, 0, output);
  assert.match(output, /event: end/);
  assert.match(output, /t_s,upstream,left_domain/);
  assert.match(output, /"kind":"measurement"/);
  const { runs } = (await d.get("/v1/runs")).json;
  assert.ok(runs.length >= 1);
});

test("the first steps are the README's, and do in Python and JavaScript what they say", { skip: isSanitized }, async (t) => {
  assert.ok(readme.includes(readFileSync(path.join(root, "api/openapi/first_steps.md"), "utf8")));
  const d = await daemon(t);
  const folder = temporaryFolder(t);
  // Debian's Python has Debian's NumPy.
  for (const [language, program, file] of [["python", "/usr/bin/python3", "steps.py"], ["js", process.execPath, "steps.mjs"]]) {
    const [block] = blocksToPaste(language);
    writeFileSync(path.join(folder, file), block.replaceAll("127.0.0.1:8080", `127.0.0.1:${d.port}`));
    const { status, output } = await run(program, [file], folder);
    assert.equal(status, 0, output);
    assert.match(output, /^at 6 s [\d.e-]+ parts are left$/m);
    assert.match(output, /24000 cells, largest 1\.\d+|\(120, 200\) largest 1\.\d+/);
    assert.match(output, /^\d+\.\d+$/m);
  }
  const { runs } = (await d.get("/v1/runs")).json;
  assert.deepEqual(runs.map(({ status }) => status), Array(4).fill("succeeded"));
});

test("the first steps with studies answer their three questions", { skip: isSanitized }, async (t) => {
  const d = await daemon(t);
  const folder = temporaryFolder(t);
  const [, block] = blocksToPaste("python");
  writeFileSync(path.join(folder, "studies.py"), block.replaceAll("127.0.0.1:8080", `127.0.0.1:${d.port}`));
  const { status, output } = await run("/usr/bin/python3", ["studies.py"], folder);
  assert.equal(status, 0, output);
  assert.match(output, /^the best angle is (60|70|80|90)$/m);
  const [, low, high] = /^95 % interval of the throughput: \[([\d.]+), ([\d.]+)\]$/m.exec(output);
  assert.ok(Number(low) < Number(high), output);
  const [, friction] = /^the friction is ([\d.]+)$/m.exec(output);
  assert.ok(Math.abs(Number(friction) - 0.25) < 0.05, output);
});
