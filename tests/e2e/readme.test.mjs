// What the README tells to paste works as pasted, against a real daemon.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { binaries, root, temporaryFolder, within } from "./setup.mjs";

const readme = readFileSync(path.join(root, "README.md"), "utf8");

// The blocks that are to be pasted; those marked `console` only show.
function blocksToPaste() {
  return [...readme.matchAll(/^```sh\n(.*?)^```$/gms)].map(([, text]) => text);
}

function paste(script, folder) {
  const done = new Promise((resolve) => {
    const shell = spawn("bash", ["-euo", "pipefail", "-c", script], { cwd: folder });
    let output = "";
    shell.stdout.on("data", (chunk) => (output += chunk));
    shell.stderr.on("data", (chunk) => (output += chunk));
    shell.on("close", (status) => resolve({ status, output }));
  });
  return within(done, "the README's lines");
}

test("the README's lines submit Example 1, stream it to its end and read its results", async (t) => {
  const d = await daemon(t);
  const blocks = blocksToPaste().filter((block) => block.includes("curl"));
  assert.ok(blocks.length >= 3);
  // Pasted one after the other into one shell, so that what one sets the next one finds.
  const script = blocks
    .join("\n")
    .replaceAll("127.0.0.1:8080", `127.0.0.1:${d.port}`)
    .replaceAll("build/release/bin/", `${binaries}/`)
    .replaceAll("api/examples/", `${root}/api/examples/`);
  const { status, output } = await paste(script, temporaryFolder(t));
  assert.equal(status, 0, output);
  assert.match(output, /event: end/);
  assert.match(output, /t_s,upstream,left_domain/);
  assert.match(output, /"kind":"measurement"/);
  const { runs } = (await d.get("/v1/runs")).json;
  assert.ok(runs.length >= 1);
});
