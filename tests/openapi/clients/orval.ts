// The flow with the client of orval, whose answers are told apart by their status.

import { getCurve, getCurveCsv, getExample, getRun, getSnapshotPng, getSummary, listRuns, submitRun } from "./orval_client.js";
import { told } from "./told.js";

const example = await getExample("example-1");
if (example.status !== 200) throw new Error("there is no example");
const accepted = await submitRun({ model: "macro", scenario: { ...example.data, duration_s: 1 } });
if (accepted.status !== 201 || !("progress" in accepted.data)) throw new Error("it is no run");
const id = accepted.data.id;
const run = await getRun(id, { wait: 60 });
const curve = await getCurve(id);
const csv = await getCurveCsv(id);
const picture = await getSnapshotPng(id, 0, { width: 100 });
const page = await listRuns({ status: "succeeded", limit: 1 });
const refused = await getSummary(told.nobody);

told.result({
  status: run.status === 200 ? run.data.status : undefined,
  upstream: curve.status === 200 ? curve.data.columns["upstream"] : undefined,
  csv: csv.status === 200 ? csv.data : undefined,
  picture: picture.status === 200 ? picture.data.size : undefined,
  listed: page.status === 200 && page.data.runs[0]?.id === id,
  has_more: page.status === 200 && page.data.has_more,
  problem: refused.status === 404 ? refused.data.type : undefined,
});
