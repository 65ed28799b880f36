// The flow with openapi-fetch on the types of openapi-typescript.

import createClient from "openapi-fetch";

import { told } from "./told.js";
import type { paths } from "./types.js";

const { GET, POST } = createClient<paths>({ baseUrl: told.base });

const { data: scenario } = await GET("/v1/examples/{name}", { params: { path: { name: "example-1" } } });
if (scenario === undefined) throw new Error("there is no example");
const { data: accepted } = await POST("/v1/runs", { body: { model: "macro", scenario: { ...scenario, duration_s: 1 } } });
if (accepted === undefined || !("progress" in accepted)) throw new Error("it is no run");
const id = accepted.id;
const { data: run } = await GET("/v1/runs/{id}", { params: { path: { id }, query: { wait: 60 } } });
const { data: curve } = await GET("/v1/runs/{id}/curve", { params: { path: { id } } });
const { data: csv } = await GET("/v1/runs/{id}/curve.csv", { params: { path: { id } }, parseAs: "text" });
const { data: picture } = await GET("/v1/runs/{id}/snapshots/{n}.png", { params: { path: { id, n: 0 }, query: { width: 100 } }, parseAs: "blob" });
const { data: page } = await GET("/v1/runs", { params: { query: { status: "succeeded", limit: 1 } } });
const { error } = await GET("/v1/runs/{id}/summary", { params: { path: { id: told.nobody } } });

told.result({
  status: run?.status,
  upstream: curve?.columns["upstream"],
  csv,
  picture: picture?.size,
  listed: page?.runs[0]?.id === id,
  has_more: page?.has_more,
  problem: error?.type,
});
