// The flow with the client of @hey-api/openapi-ts.

import { client } from "./hey/client.gen.js";
import { getCurve, getCurveCsv, getExample, getRun, getSnapshotPng, getSummary, listRuns, submitRun } from "./hey/index.js";
import { told } from "./told.js";

client.setConfig({ baseUrl: told.base });

const { data: scenario } = await getExample({ path: { name: "example-1" } });
if (scenario === undefined) throw new Error("there is no example");
const { data: accepted } = await submitRun({ body: { model: "macro", scenario: { ...scenario, duration_s: 1 } } });
if (accepted === undefined || !("progress" in accepted)) throw new Error("it is no run");
const id = accepted.id;
const { data: run } = await getRun({ path: { id }, query: { wait: 60 } });
const { data: curve } = await getCurve({ path: { id } });
const { data: csv } = await getCurveCsv({ path: { id } });
const { data: picture } = await getSnapshotPng({ path: { id, n: 0 }, query: { width: 100 } });
const { data: page } = await listRuns({ query: { status: "succeeded", limit: 1 } });
const { error } = await getSummary({ path: { id: told.nobody } });

told.result({
  status: run?.status,
  upstream: curve?.columns["upstream"],
  csv,
  picture: picture?.size,
  listed: page?.runs[0]?.id === id,
  has_more: page?.has_more,
  problem: error?.type,
});
