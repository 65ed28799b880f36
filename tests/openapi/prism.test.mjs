// What the stories kept of their exchanges, in the folder that BELTFLOW_EXCHANGES names, judged by Prism. Of every operation of
// the document an answer of success must be among them.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { document } from "../e2e/contract.mjs";
import { startJudge, unpackExchange } from "../e2e/prism.mjs";
import { operationsOf } from "./operations.mjs";

const folder = process.env.BELTFLOW_EXCHANGES;

test("Prism finds nothing in any kind of exchange that a story had", async (t) => {
  const { judge, close } = await startJudge();
  t.after(close);
  const files = readdirSync(folder).filter((file) => file.endsWith(".json"));
  const exchanges = files.flatMap((file) => JSON.parse(readFileSync(path.join(folder, file), "utf8")).map(unpackExchange));
  for (const { kind, exchange, answer } of exchanges)
    assert.deepEqual(await judge(exchange, answer), [], `${kind}: ${exchange.target}\n${answer.body.toString().slice(0, 1000)}`);
  const kinds = [...new Set(exchanges.map(({ kind }) => kind))];
  t.diagnostic(`${exchanges.length} exchanges of ${kinds.length} kinds`);
  const missing = operationsOf(document).filter((operation) => !kinds.some((kind) => kind.startsWith(`${operation} 2`)));
  assert.deepEqual(missing, [], "operations of whose success nothing was kept");
});
