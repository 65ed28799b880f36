// Access by tokens: a real daemon with tokens that `beltflowd token` made, and what it answers to whom.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { tiny } from "./scenarios.mjs";
import { binaries, temporaryFolder, until } from "./setup.mjs";

// Run beltflowd for a data directory; { status, stdout, stderr }.
function beltflowd(data, ...words) {
  const { status, stdout, stderr, error } = spawnSync(path.join(binaries, "beltflowd"), ["--data", data, ...words], {
    encoding: "utf8",
  });
  assert.equal(error, undefined);
  return { status, stdout, stderr };
}

// Make a token beside the daemon; the header that presents it.
function addToken(data, ...words) {
  const { status, stdout, stderr } = beltflowd(data, "token", "add", ...words);
  assert.equal(status, 0, stderr);
  const token = stdout.trim();
  assert.match(token, /^bft_[\w-]{43}$/);
  return { authorization: `Bearer ${token}` };
}

const submission = () => ({ scenario: tiny(), fresh: true });

test("without tokens nobody needs one; with the first one everybody does", async (t) => {
  const d = await daemon(t);
  assert.equal((await d.get("/v1/runs")).status, 200);
  const alice = addToken(d.data, "alice");
  await until(async () => (await d.get("/v1/runs")).status === 401, "the daemon to see the token");
  const refused = await d.post("/v1/runs", submission());
  assert.equal(refused.status, 401);
  assert.equal(refused.headers["www-authenticate"], 'Bearer realm="beltflow"');
  assert.equal((await d.get("/v1/runs", alice)).status, 200);
  for (const open of ["/livez", "/readyz", "/version", "/openapi.json", "/problems/unauthorized"]) {
    assert.equal((await d.get(open)).status, 200, open);
  }
  assert.equal((await d.get("/metrics")).status, 401);
});

test("a token that is wrong, expired, revoked or in the URL opens nothing", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const alice = addToken(data, "alice");
  const bob = addToken(data, "bob", "--expires", "1h");
  const d = await daemon(t, { data });
  const secret = alice.authorization.slice("Bearer ".length);
  assert.equal((await d.get("/v1/runs", alice)).status, 200);
  assert.equal((await d.get("/v1/runs", bob)).status, 200);
  for (const name of ["access_token", "token", "ticket"]) {
    assert.equal((await d.get(`/v1/runs?${name}=${secret}`)).status, 401, name);
    assert.equal((await d.get(`/v1/runs?${name}=${secret}`, alice)).status, 400, name);
  }
  const wrong = { authorization: `Bearer ${secret.slice(0, -1)}${secret.endsWith("A") ? "B" : "A"}` };
  const answer = await d.get("/v1/runs", wrong);
  assert.equal(answer.status, 401);
  assert.match(answer.headers["www-authenticate"], /error="invalid_token"/);
  assert.equal(beltflowd(data, "token", "revoke", "1").status, 0);
  await until(async () => (await d.get("/v1/runs", alice)).status === 401, "the revocation to count");
  assert.match((await d.get("/v1/runs", alice)).json.detail, /revoked/);
  assert.equal((await d.get("/v1/runs", bob)).status, 200);
  assert.match(d.log, /event=token_revoked token=1 name=alice owner=alice scopes=read,submit/);
});

test("a scope is needed for what a request does", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const reader = addToken(data, "reader", "--scopes", "read");
  const writer = addToken(data, "writer", "--scopes", "submit");
  const admin = addToken(data, "root", "--scopes", "admin");
  const d = await daemon(t, { data });
  const refused = await d.post("/v1/runs", submission(), reader);
  assert.equal(refused.status, 403);
  assert.match(refused.headers["www-authenticate"], /error="insufficient_scope", scope="submit"$/);
  const { status, json: run } = await d.post("/v1/runs", submission(), writer);
  assert.equal(status, 201);
  assert.equal((await d.get(`/v1/runs/${run.id}`, writer)).status, 403);
  assert.equal((await d.get(`/v1/runs/${run.id}`, admin)).status, 200);
  assert.equal((await d.request("DELETE", `/v1/runs/${run.id}`, { headers: reader })).status, 403);
  assert.equal((await d.request("DELETE", `/v1/runs/${run.id}`, { headers: admin })).status, 204);
});

test("a change is logged with who made it, and no token ever is", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const alice = addToken(data, "laptop", "--owner", "alice");
  const d = await daemon(t, { data, log_level: "debug" });
  const headers = { ...alice, "x-request-id": "change-1" };
  const { json: run } = await d.post("/v1/runs", submission(), headers);
  const line = new RegExp(`event=request method="POST" .*run=${run.id} request_id=change-1 .*token=1 owner=alice`);
  await until(() => line.test(d.log), "the line of the log");
  await d.get(`/v1/runs?access_token=${alice.authorization.slice(7)}`);
  await d.stop();
  assert.ok(!d.log.includes(alice.authorization.slice(11, 30)), d.log);
  assert.match(beltflowd(data, "token", "list").stdout, /^1 +valid +laptop +alice +read,submit +\S+ +never +\d{4}-/m);
});

test("beyond this machine a daemon wants a word of its operator, and a token", (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const start = (...words) => beltflowd(data, "--listen", "0.0.0.0:0", ...words);
  const plain = start();
  assert.equal(plain.status, 2);
  assert.match(plain.stderr, /plaintext = proxy .* plaintext = open/);
  const lonely = start("--plaintext", "proxy");
  assert.equal(lonely.status, 2);
  assert.match(lonely.stderr, /no access token/);
  assert.equal(start("--plaintext", "closed").status, 2);
});

test("with both it listens, and without a warning that everybody may come", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const alice = addToken(data, "alice");
  const d = await daemon(t, { data, listen: "0.0.0.0:0", plaintext: "proxy" });
  assert.equal((await d.get("/v1/runs")).status, 401);
  assert.equal((await d.get("/v1/runs", alice)).status, 200);
  assert.doesNotMatch(d.log, /listens_to_the_network/);
});

test("the words of the command are checked", (t) => {
  const data = path.join(temporaryFolder(t), "data");
  for (const words of [["token"], ["token", "add"], ["token", "list", "all"], ["token", "make", "x"],
    ["token", "add", "a b"], ["token", "add", "x", "--scopes", "everything"], ["token", "add", "x", "--expires", "soon"],
    ["token", "add", "x", "--expires", "0d"], ["token", "revoke", "one"], ["token", "list", "--owner", "x"],
    ["token", "list"]]) {
    const { status, stderr } = beltflowd(data, ...words);
    assert.equal(status, 2, `${words.join(" ")}: ${stderr}`);
  }
  addToken(data, "x", "--scopes", "read,admin", "--expires", "90d");
  assert.equal(beltflowd(data, "token", "revoke", "2").status, 1);
});
