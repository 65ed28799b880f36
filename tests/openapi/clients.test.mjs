// Clients that three generators make of the document compile in TypeScript's strict mode, and one typed flow with each runs
// against a daemon: a run, its curve as JSON and CSV, a picture, a list and a refusal.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { cpSync, rmSync } from "node:fs";
import path from "node:path";
import test from "node:test";
import { promisify } from "node:util";

import { daemon } from "../e2e/daemon.mjs";
import { packages, root } from "../e2e/setup.mjs";

const folder = path.join(packages, "clients"); // beside node_modules, where generated code finds its packages
const document = path.join(root, "api/openapi.json");

async function run(program, args, env = {}) {
  const options = { cwd: folder, env: { ...process.env, ...env }, maxBuffer: 1e8 };
  return (await promisify(execFile)(process.execPath, [program, ...args], options).catch((error) => {
    assert.fail(`${program}: ${error.stdout}${error.stderr}`);
  })).stdout;
}

const tool = (name) => path.join(packages, "node_modules", name);

test("clients of openapi-typescript, @hey-api/openapi-ts and orval compile strictly and do a flow", async (t) => {
  const d = await daemon(t);
  const base = d.url.replace(/\/$/, "");
  rmSync(folder, { recursive: true, force: true });
  cpSync(path.join(root, "tests/openapi/clients"), folder, { recursive: true });
  const env = { BELTFLOW_DOCUMENT: document, BELTFLOW_BASE: base };
  await run(tool("openapi-typescript/bin/cli.js"), [document, "-o", "types.ts"]);
  await run(tool("@hey-api/openapi-ts/bin/run.js"), ["-f", "hey.config.mjs"], env);
  await run(tool("orval/dist/bin/orval.mjs"), ["--config", "orval.config.mjs"], env);
  await run(tool("typescript/bin/tsc"), ["-p", "."]);
  const results = [];
  for (const flow of ["openapi_fetch", "hey_api", "orval"]) results.push(JSON.parse(await run(`js/${flow}.js`, [base])));
  const { id } = (await d.get("/v1/runs?limit=1")).json.runs[0];
  const expected = {
    status: "succeeded",
    upstream: (await d.get(`/v1/runs/${id}/curve`)).json.columns.upstream,
    csv: (await d.get(`/v1/runs/${id}/curve.csv`)).text,
    picture: (await d.get(`/v1/runs/${id}/snapshots/0.png?width=100`)).body.length,
    listed: true,
    problem: "/problems/not-found",
  };
  results.forEach((result, k) => assert.deepEqual(result, { ...expected, has_more: k > 0 }));
});
