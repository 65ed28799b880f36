// Access by tokens: a real daemon with tokens that `beltflowd token` made, and what it answers to whom.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { copyFileSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { endless, fed, tiny } from "./scenarios.mjs";
import { binaries, temporaryFolder, until, within } from "./setup.mjs";
import { addToken, beltflowd } from "./tokens.mjs";

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
  assert.equal((await d.get(`/v1/runs?ticket=${secret}`)).status, 401);
  for (const name of ["access_token", "token"]) {
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

test("a priority above 0 is for tokens that may, and for everybody without tokens", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const d = await daemon(t, { data });
  const ask = (who, priority, target = "/v1/runs") => d.post(target, { ...submission(), priority }, who);
  assert.equal((await ask({}, 100)).status, 201);
  const alice = addToken(data, "alice");
  const urgent = addToken(data, "urgent", "--scopes", "read,submit,priority");
  const root = addToken(data, "root", "--scopes", "admin");
  await until(async () => (await d.get("/v1/runs")).status === 401, "the daemon to see the tokens");
  for (const target of ["/v1/runs", "/v1/validate"]) {
    const refused = await ask(alice, 1, target);
    assert.equal(refused.status, 403, target);
    assert.deepEqual(refused.json.errors.map(({ pointer }) => pointer), ["/priority"]);
    assert.match(refused.headers["www-authenticate"], /error="insufficient_scope", scope="priority"$/);
  }
  const asked = [[alice, 0], [alice, -5], [urgent, 100], [root, 1]];
  assert.deepEqual(await Promise.all(asked.map(async ([who, priority]) => (await ask(who, priority)).status)),
    [201, 201, 201, 201]);
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
  const check = (...words) => beltflowd(data, "--check-config", ...words);
  const checked = check("--listen", "[::]:8080");
  assert.equal(checked.status, 2);
  assert.match(checked.stderr, /^--listen: \[::\]:8080 can be reached .* plaintext = proxy/);
  for (const words of [["--listen", "[::]:8080", "--plaintext", "proxy"], ["--listen", "[::1]:8080"], ["--listen", "127.0.0.2:8080"]]) {
    assert.deepEqual(check(...words), { status: 0, stdout: "", stderr: "" });
  }
});

test("a store that was used with tokens is not served to everybody when they are lost", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const alice = addToken(data, "alice");
  const d = await daemon(t, { data });
  const { json: run } = await d.post("/v1/runs", submission(), alice);
  const file = path.join(d.folder, "copy");
  assert.equal(beltflowd(data, "backup", file).status, 0);
  await d.stop();

  const restored = path.join(temporaryFolder(t), "data");
  mkdirSync(restored, { mode: 0o700 });
  copyFileSync(file, path.join(restored, "beltflow.db"));
  for (const folder of [restored, data]) {
    rmSync(path.join(data, "access.db"), { force: true });
    const refused = beltflowd(folder, "--listen", "127.0.0.1:0");
    assert.equal(refused.status, 2, refused.stderr);
    assert.match(refused.stderr, /was used with access tokens.* access\.db .*access = open/);
  }
  const open = await daemon(t, { data, access: "open" });
  assert.equal((await open.get(`/v1/runs/${run.id}`)).status, 200);
  assert.match(open.log, /level=warn event=open_to_everybody why=access /);

  copyFileSync(`${file}.access`, path.join(restored, "access.db"));
  assert.equal(statSync(`${file}.access`).mode & 0o777, 0o600);
  const whole = await daemon(t, { data: restored });
  assert.equal((await whole.get(`/v1/runs/${run.id}`)).status, 401);
  assert.equal((await whole.request("DELETE", `/v1/runs/${run.id}`)).status, 401);
  assert.equal((await whole.get(`/v1/runs/${run.id}`, alice)).status, 200);
});

test("an operator's bad day: a copy each day, the machine is lost, and the copy serves the same people", async (t) => {
  const folder = temporaryFolder(t);
  const [data, copies, settings] = ["data", "copies", "beltflow.conf"].map((name) => path.join(folder, name));
  const withSettings = (file, ...words) =>
    spawnSync(path.join(binaries, "beltflowd"), words, {
      encoding: "utf8", cwd: folder, env: { PATH: process.env.PATH, ...(file && { BELTFLOW_CONFIG: file }) },
    });
  mkdirSync(copies);
  writeFileSync(settings, `data = ${data}\nqueue_limit = 77\n`);
  // Without settings that name a store a token would be one of nobody's.
  assert.match(withSettings(path.join(folder, "none"), "token", "add", "x").stderr, /none/);
  const stray = withSettings(undefined, "token", "add", "x", "--data", "beltflow-data");
  assert.equal(stray.status, 0); // named, so meant
  rmSync(path.join(folder, "beltflow-data"), { recursive: true });

  const alice = { authorization: `Bearer ${withSettings(settings, "token", "add", "alice").stdout.trim()}` };
  const d = await daemon(t, { data });
  const { json: run } = await d.post("/v1/runs", submission(), alice);
  for (const day of ["01", "02", "03"]) writeFileSync(path.join(copies, `beltflow-202001${day}T000000Z.db`), "");
  const made = withSettings(settings, "backup", copies, "--copies", "2");
  assert.equal(made.status, 0, made.stderr);
  const [file] = /^\S+\.db(?=: \d+ bytes$)/m.exec(made.stdout);
  const names = ["", ".access", ".conf"].map((ending) => path.basename(file) + ending);
  assert.deepEqual(readdirSync(copies).sort(), ["beltflow-20200103T000000Z.db", ...names]);
  assert.equal(withSettings(settings, "restore", file).status, 1); // it is being served
  assert.match(withSettings(settings, "restore", file).stderr, /a daemon is using/);
  await d.stop();

  rmSync(data, { recursive: true });
  rmSync(settings);
  const done = withSettings(settings, "restore", file);
  assert.equal(done.status, 0, done.stderr);
  assert.match(done.stdout, /with its tokens/);
  assert.match(readFileSync(settings, "utf8"), /queue_limit = 77/);
  const again = await daemon(t, { data });
  assert.equal((await again.get(`/v1/runs/${run.id}`)).status, 401);
  assert.equal((await again.get(`/v1/runs/${run.id}`, alice)).status, 200);

  const rotated = beltflowd(data, "token", "rotate", "1", "--overlap", "12h");
  assert.equal(rotated.status, 0, rotated.stderr);
  const next = { authorization: `Bearer ${rotated.stdout.trim()}` };
  await until(async () => (await again.get(`/v1/runs/${run.id}`, next)).status === 200, "the new token to count");
  assert.equal((await again.get(`/v1/runs/${run.id}`, alice)).status, 200); // until the overlap is over
  const [, old, young] = beltflowd(data, "token", "list").stdout.trimEnd().split("\n");
  assert.match(old, /^1 .* alice +read,submit +\S+ +20\S+Z /);
  assert.match(young, /^2 .* alice +read,submit +\S+ +never /);
  assert.equal(beltflowd(data, "token", "rotate", "9").status, 1);
});

test("a token that was made beside a running daemon is remembered, too", async (t) => {
  const d = await daemon(t);
  addToken(d.data, "alice");
  await until(async () => (await d.get("/v1/runs")).status === 401, "the daemon to see the token");
  await d.stop();
  rmSync(path.join(d.data, "access.db"));
  assert.match(beltflowd(d.data, "--listen", "127.0.0.1:0").stderr, /was used with access tokens/);
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
    ["token", "add", "x", "--expires", "0d"], ["token", "rotate"], ["token", "list", "--overlap", "1d"], ["restore"],
    ["backup", "--copies", "3"], ["backup", "x", "--copies", "3"], ["token", "revoke", "one"], ["token", "list", "--owner", "x"],
    ["token", "list"]]) {
    const { status, stderr } = beltflowd(data, ...words);
    assert.equal(status, 2, `${words.join(" ")}: ${stderr}`);
  }
  addToken(data, "x", "--scopes", "read,admin", "--expires", "90d");
  assert.equal(beltflowd(data, "token", "revoke", "2").status, 1);
});

// Alice, bob and root with a daemon; alice has a run that has succeeded, and a measurement.
async function neighbours(t) {
  const data = path.join(temporaryFolder(t), "data");
  const [alice, bob] = ["alice", "bob"].map((name) => addToken(data, name));
  const root = addToken(data, "root", "--scopes", "admin");
  const d = await daemon(t, { data });
  const submit = async (who, more = {}) => {
    const answer = await d.post("/v1/runs", { scenario: tiny() }, { ...who, ...more });
    assert.equal(answer.status, 201, answer.text);
    await until(async () => (await d.get(`/v1/runs/${answer.json.id}`, root)).json.status === "succeeded", "its end");
    return answer.json;
  };
  const run = await submit(alice, { "idempotency-key": '"same"' });
  const csv = (await d.get(`/v1/runs/${run.id}/curve?format=csv`, alice)).text;
  const added = await d.request("POST", "/v1/measurements.csv?counter=upstream", {
    headers: { ...alice, "content-type": "text/csv", "content-length": Buffer.byteLength(csv) },
    body: csv,
  });
  assert.equal(added.status, 201, added.text);
  return { d, data, alice, bob, root, submit, run, measurement: added.json };
}

test("what is somebody else's looks as if it were not there", async (t) => {
  const { d, alice, bob, root, submit, run, measurement } = await neighbours(t);
  const own = await submit(bob);
  const nothing = "01234567-89ab-7cde-8f01-23456789abcd";
  const resources = ["", "/scenario", "/summary", "/curve", "/photo_eyes", "/key_figures", "/snapshots", "/snapshots/0",
    "/snapshots.pvd", "/results.zip", "/events"];
  const targets = [
    ...resources.map((end) => ["GET", `/v1/runs/ID${end}`]),
    ["POST", "/v1/runs/ID/cancel"], ["DELETE", "/v1/runs/ID"], ["GET", "/v1/events?runs=ID"],
    ["GET", `/v1/events?runs=${own.id},ID`], ["GET", `/v1/compare?a=${own.id}&b=ID`], ["GET", `/v1/compare?runs=ID,${own.id}`],
  ];
  const withoutId = (text, id) => text.replaceAll(id, "ID").replace(/"request_id": *"[^"]*"/, "");
  for (const [method, target] of targets) {
    const [others, absent] = await Promise.all([run.id, nothing].map(async (id) => {
      const { status, text } = await d.request(method, target.replace("ID", id), { headers: bob });
      return { status, text: withoutId(text, id) };
    }));
    assert.equal(others.status, 404, `${method} ${target}: ${others.text}`);
    assert.deepEqual(others, absent, `${method} ${target}`);
  }
  for (const method of ["GET", "DELETE"]) {
    const target = `/v1/measurements/${measurement.id}`;
    assert.equal((await d.request(method, target, { headers: bob })).status, 404);
  }
  assert.equal((await d.get(`/v1/compare?a=${own.id}&b=${measurement.id}`, bob)).status, 404);
  assert.equal((await d.get(`/v1/compare?a=${run.id}&b=${measurement.id}`, alice)).status, 200);
  assert.equal((await d.get(`/v1/compare?a=${run.id}&b=${own.id}`, root)).status, 200);
});

const studyOf = (changes) => ({
  base: { scenario: tiny() },
  parameters: [{ pointer: "/duration_s", values: [tiny().duration_s] }],
  objectives: [{ figure: "peak_density" }],
  method: { type: "list" },
  ...changes,
});

test("somebody else's study and its trials look as if they were not there", async (t) => {
  const { d, alice, bob, root, measurement } = await neighbours(t);
  const made = await d.post("/v1/studies", studyOf({}), alice);
  assert.equal(made.status, 201, made.text);
  const { id } = made.json;
  await until(async () => (await d.get(`/v1/studies/${id}`, alice)).json.status === "succeeded", "its end");
  const nothing = "01234567-89ab-7cde-8f01-23456789abcd";
  const targets = [
    ...["", "/document", "/trials", "/trials?format=csv", "/best", "/events"].map((end) => ["GET", `/v1/studies/ID${end}`]),
    ...["/pause", "/resume", "/cancel", "/trials/0/run"].map((end) => ["POST", `/v1/studies/ID${end}`]),
    ["DELETE", "/v1/studies/ID"],
  ];
  const withoutId = (text, of) => text.replaceAll(of, "ID").replace(/"request_id": *"[^"]*"/, "");
  for (const [method, target] of targets) {
    const [others, absent] = await Promise.all([id, nothing].map(async (of) => {
      const { status, text } = await d.request(method, target.replace("ID", of), { headers: bob });
      return { status, text: withoutId(text, of) };
    }));
    assert.equal(others.status, 404, `${method} ${target}: ${others.text}`);
    assert.deepEqual(others, absent, `${method} ${target}`);
  }
  const listed = async (target, who) => Object.values((await d.get(target, who)).json)[0].length;
  for (const target of ["/v1/studies", `/v1/runs?study=${id}`])
    assert.deepEqual([await listed(target, alice), await listed(target, bob), await listed(target, root)], [1, 0, 1], target);
  const [{ run }] = (await d.get(`/v1/studies/${id}/trials`, alice)).json.trials;
  assert.deepEqual([(await d.get(`/v1/runs/${run}`, bob)).status, (await d.get(`/v1/runs/${run}`, alice)).status], [404, 200]);
  const curves = [{ counter: "upstream", measurement: measurement.id }];
  const calibration = studyOf({ objectives: [], curves, method: { type: "calibrate", points: 1 }, limits: { trials: 1 } });
  calibration.parameters[0] = { pointer: "/duration_s", range: [1, 2] };
  const stolen = await d.post("/v1/studies", calibration, bob);
  assert.deepEqual([stolen.status, stolen.json.errors[0].pointer], [422, "/curves/0/measurement"]);
});

test("lists show what is one's own, and an administrator everything", async (t) => {
  const { d, alice, bob, root, submit, run, measurement } = await neighbours(t);
  const own = await submit(bob);
  const listed = async (who, query = "") => (await d.get(`/v1/runs${query}`, who)).json.runs.map(({ id }) => id);
  assert.deepEqual(await listed(alice), [run.id]);
  assert.deepEqual(await listed(bob), [own.id]);
  assert.deepEqual(await listed(bob, "?status=succeeded&limit=1"), [own.id]);
  assert.deepEqual(await listed(bob, "?status=failed"), []);
  assert.deepEqual(await listed(bob, `?label=${encodeURIComponent("nobody's")}`), []);
  assert.deepEqual(await listed(root), [own.id, run.id]);
  const measured = async (who) => (await d.get("/v1/measurements", who)).json.measurements.map(({ id }) => id);
  assert.deepEqual([await measured(alice), await measured(bob), await measured(root)],
    [[measurement.id], [], [measurement.id]]);
  assert.deepEqual([run.owner, own.owner, measurement.owner], ["alice", "bob", "alice"]);
});

test("lines of one name of several owners are several lines", async (t) => {
  const { d, alice, bob, root } = await neighbours(t);
  const runs = await Promise.all([alice, bob].map((who) => d.post("/v1/runs", { scenario: tiny(), line: "hall" }, who)));
  const lines = async (who, query = "") => (await d.get(`/v1/lines${query}`, who)).json.lines.map(({ owner, newest_run: run }) => [owner, run]);
  const [ofAlice, ofBob] = runs.map(({ json }) => [json.owner, json.id]);
  assert.deepEqual([await lines(alice), await lines(bob)], [[ofAlice], [ofBob]]);
  assert.deepEqual((await lines(root)).sort(), [ofAlice, ofBob]);
  assert.deepEqual([await lines(root, "?owner=bob"), await lines(bob, "?owner=bob")], [[ofBob], [ofBob]]);
  const listed = async (target) => (await d.get(`${target}?line=hall&owner=alice`, root)).json;
  assert.deepEqual((await listed("/v1/runs")).runs.map(({ id }) => id), [ofAlice[1]]);
  assert.deepEqual((await listed("/v1/studies")).studies, []);
  for (const target of ["/v1/lines", "/v1/runs", "/v1/studies"]) {
    const refused = await d.get(`${target}?owner=alice`, bob);
    assert.deepEqual([refused.status, refused.json.detail], [403, "query parameter 'owner': this token lists only what is bob's"]);
  }
});

test("a key is its owner's, and results that were known do not tell whose they are", async (t) => {
  const { d, bob, submit, run, alice } = await neighbours(t);
  const own = await submit(bob, { "idempotency-key": '"same"' });
  assert.notEqual(own.id, run.id);
  assert.equal(own.cached, true);
  assert.equal((await submit(alice, { "idempotency-key": '"same"' })).id, run.id);
  const texts = await Promise.all(["", "/scenario", "/summary", "/curve", "/key_figures", "/snapshots", "/events"]
    .map(async (end) => (await d.get(`/v1/runs/${own.id}${end}`, bob)).text));
  for (const text of texts) {
    assert.ok(!text.includes(run.id) && !text.includes("alice"), text);
  }
});

test("a scenario cannot name somebody else's measurement", async (t) => {
  const { d, alice, bob } = await neighbours(t);
  const csv = "t_s,count\n0,4\n1,8\n2,0\n";
  const added = await d.request("POST", "/v1/measurements.csv?kind=profile", {
    headers: { ...alice, "content-type": "text/csv", "content-length": Buffer.byteLength(csv) },
    body: csv,
  });
  assert.equal(added.status, 201, added.text);
  const scenario = fed({ feeds: [{ edge: "west", y_m: [0.05, 0.25], profile: { measurement: added.json.id } }],
    photo_eyes: [], actions: [] });
  const [mine, others] = await Promise.all([alice, bob].map((who) => d.post("/v1/validate", { scenario }, who)));
  const said = (answer) => answer.json.errors?.map(({ detail }) => detail).join() ?? "";
  assert.equal(mine.status, 200, mine.text);
  assert.equal(others.status, 422);
  assert.match(said(others), new RegExp(`there is no measurement '${added.json.id}'`));
});

test("what was there before the first token is the administrator's", async (t) => {
  const d = await daemon(t);
  const before = await d.submit(tiny());
  const [alice, root] = [addToken(d.data, "alice"), addToken(d.data, "root", "--scopes", "admin")];
  await until(async () => (await d.get("/v1/runs")).status === 401, "the daemon to see the tokens");
  assert.deepEqual((await d.get("/v1/runs", alice)).json.runs, []);
  assert.equal((await d.get(`/v1/runs/${before.id}`, alice)).status, 404);
  const { status, json } = await d.get(`/v1/runs/${before.id}`, root);
  assert.deepEqual([status, json.owner], [200, undefined]);
});

// A ticket for the sender of headers, as part of a query.
async function ticketOf(d, headers) {
  const { status, json, text } = await d.request("POST", "/v1/tickets", { headers });
  assert.equal(status, 200, text);
  assert.match(json.ticket, /^[\w-]{64}$/);
  const left = Date.parse(json.expires_at) - Date.now();
  assert.ok(left > 0 && left <= 60_000, json.expires_at);
  return `ticket=${json.ticket}`;
}

test("a ticket stands for the token where something is read, and nowhere else", async (t) => {
  const { d, alice, bob, run } = await neighbours(t);
  const [ticket, others] = await Promise.all([ticketOf(d, alice), ticketOf(d, bob)]);
  for (const target of ["", "/snapshots/0?format=png", "/results.zip", "/events"]) {
    const query = `${target.includes("?") ? "&" : "?"}${ticket}`;
    const answer = await d.get(`/v1/runs/${run.id}${target}${query}`);
    assert.equal(answer.status, 200, `${target}: ${answer.text}`);
  }
  assert.equal((await d.request("HEAD", `/v1/runs/${run.id}?${ticket}`)).status, 200);
  assert.equal((await d.get(`/v1/runs/${run.id}?${others}`)).status, 404);
  const refused = await d.get(`/v1/runs/${run.id}?${ticket.slice(0, -1)}`);
  assert.equal(refused.status, 401);
  assert.match(refused.headers["www-authenticate"], /error="invalid_token"/);
  for (const [method, target, body] of [["POST", "/v1/runs", submission()], ["POST", "/v1/tickets"],
    ["POST", `/v1/runs/${run.id}/cancel`], ["DELETE", `/v1/runs/${run.id}`]]) {
    const answer = body ? await d.post(`${target}?${ticket}`, body) : await d.request(method, `${target}?${ticket}`);
    assert.equal(answer.status, 401, `${method} ${target}`);
  }
  assert.equal((await d.get(`/v1/runs/${run.id}`, alice)).status, 200);
});

test("a ticket ends with its token, and is written nowhere", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const alice = addToken(data, "alice");
  const d = await daemon(t, { data, log_level: "debug" });
  const runs = await Promise.all([1, 2].map(() => d.post("/v1/runs", submission(), alice)));
  assert.deepEqual(runs.map(({ status }) => status), [201, 201]);
  const ticket = await ticketOf(d, alice);
  const page = await d.get(`/v1/runs?limit=1&${ticket}`);
  assert.equal(page.json.runs.length, 1);
  assert.match(page.headers.link, /rel="next"/);
  const id = page.json.runs[0].id;
  const answers = [page, await d.get(`/v1/runs/${id}?${ticket}`), await d.get(`/v1/runs/none?${ticket}`),
    await d.get(`/v1/runs?limit=0&${ticket}`), await d.get(`/v1/runs/${id}/curve?colour=red&${ticket}`)];
  assert.deepEqual(answers.map(({ status }) => status), [200, 200, 404, 400, 400]);
  for (const { headers, text } of answers) assert.ok(!(JSON.stringify(headers) + text).includes(ticket.slice(7)), text);
  assert.equal(beltflowd(data, "token", "revoke", "1").status, 0);
  await until(async () => (await d.get(`/v1/runs?${ticket}`)).status === 401, "the revocation to count");
  await d.stop();
  assert.ok(!d.log.includes(ticket.slice(7)), d.log);
});

test("without tokens a ticket is made and not asked for", async (t) => {
  const d = await daemon(t);
  const ticket = await ticketOf(d, {});
  assert.equal((await d.get(`/v1/runs?${ticket}`)).status, 200);
  assert.equal((await d.get("/v1/runs?ticket=whatever")).status, 200);
  addToken(d.data, "alice");
  await until(async () => (await d.get("/v1/runs")).status === 401, "the daemon to see the token");
  assert.equal((await d.get(`/v1/runs?${ticket}`)).status, 401);
});

test("a stream ends when its token is revoked, also one that waits, and no other", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const [alice, root] = [addToken(data, "alice"), addToken(data, "root", "--scopes", "admin")];
  const d = await daemon(t, { data });
  const submit = async () => (await d.post("/v1/runs", { scenario: endless(), fresh: true }, alice)).json.id;
  const running = await submit();
  await until(async () => (await d.get(`/v1/runs/${running}`, alice)).json.status === "running", "it to run");
  const queued = await submit();
  const ticket = await ticketOf(d, alice);
  const hers = await Promise.all([d.events(running, alice), d.events(`/v1/runs/${queued}/events?${ticket}`)]);
  const other = await d.events(queued, root);
  for (const stream of [...hers, other]) assert.equal((await stream.next()).event, "status");
  assert.equal(beltflowd(data, "token", "revoke", "1").status, 0);
  for (const stream of hers) {
    await within(stream.rest(), "the end of a stream");
    assert.ok(!stream.isTorn);
  }
  assert.equal((await d.request("POST", `/v1/runs/${queued}/cancel`, { headers: root })).status, 200);
  assert.equal((await within(other.until("end"), "the end of the run")).data.status, "cancelled");
});

// A link of alice's to what `path` names: the header that presents its token, and the answer.
async function grantOf(d, alice, path, body = {}) {
  const { status, json, text } = await d.post(`${path}/grants`, body, alice);
  assert.equal(status, 201, text);
  assert.match(json.token, /^bft_[\w-]{43}$/);
  return { grant: json, guest: { authorization: `Bearer ${json.token}` } };
}

test("a grant reads one run, whole and live, and nothing else", async (t) => {
  const { d, alice, run } = await neighbours(t);
  const { json: other } = await d.post("/v1/runs", submission(), alice);
  const { grant, guest } = await grantOf(d, alice, `/v1/runs/${run.id}`);
  assert.equal(grant.resource, `/v1/runs/${run.id}`);
  const days = (Date.parse(grant.expires_at) - Date.parse(grant.created_at)) / 86400000;
  assert.ok(Math.abs(days - 30) < 0.01, `${days} days`);
  for (const of of ["", "/scenario", "/summary", "/curve.csv", "/key_figures", "/snapshots", "/snapshots/0.png", "/results.zip"]) {
    const { status, text } = await d.get(`/v1/runs/${run.id}${of}`, guest);
    assert.equal(status, 200, `${of}: ${text.slice(0, 200)}`);
  }
  const ticket = await ticketOf(d, guest);
  assert.match((await d.get(`/v1/events?runs=${run.id}&${ticket}`)).text, /^event: end$/m);
  const lookups = [`/v1/runs/${other.id}`, `/v1/runs/${other.id}/curve`, `/v1/events?runs=${run.id},${other.id}`];
  for (const path of lookups) assert.equal((await d.get(path, guest)).status, 404, path);
  for (const path of ["/v1/runs", "/v1/studies", "/v1/measurements", "/v1/grants", "/v1/quota", "/metrics", `/v1/compare?a=${run.id}&b=${run.id}`]) {
    assert.equal((await d.get(path, guest)).status, 403, path);
  }
  assert.equal((await d.post("/v1/runs", submission(), guest)).status, 403);
  assert.equal((await d.post(`/v1/runs/${run.id}/grants`, {}, guest)).status, 403);
  assert.equal((await d.request("DELETE", `/v1/runs/${run.id}`, { headers: guest })).status, 403);
});

test("a grant of a study reads its trials and their runs", async (t) => {
  const { d, alice, run } = await neighbours(t);
  const { status, json: study } = await d.post("/v1/runs", { scenario: fed(), replications: 2 }, alice);
  assert.equal(status, 201, JSON.stringify(study));
  await until(async () => (await d.get(`/v1/studies/${study.id}`, alice)).json.status === "succeeded", "the study to end");
  const { guest } = await grantOf(d, alice, `/v1/studies/${study.id}`);
  const { trials } = (await d.get(`/v1/studies/${study.id}/trials`, guest)).json;
  assert.equal(trials.length, 1); // a density has no chance in it
  for (const trial of trials) assert.equal((await d.get(`/v1/runs/${trial.run}/curve`, guest)).status, 200);
  assert.equal((await d.get(`/v1/runs/${run.id}`, guest)).status, 404);
});

test("a grant is its owner's, ends by itself or is revoked, and is not made where nobody needs one", async (t) => {
  const { d, data, alice, bob, run } = await neighbours(t);
  const { grant, guest } = await grantOf(d, alice, `/v1/runs/${run.id}`, { expires_in_s: 3600 });
  assert.equal((await d.post(`/v1/runs/${run.id}/grants`, {}, bob)).status, 404);
  const { status, json } = await d.post(`/v1/runs/${run.id}/grants`, { expires_in_s: 59 }, alice);
  assert.deepEqual([status, json.errors[0].pointer], [422, "/expires_in_s"]);
  const { token, ...stored } = grant;
  assert.deepEqual((await d.get("/v1/grants", alice)).json.grants, [stored]);
  assert.deepEqual((await d.get("/v1/grants", bob)).json.grants, []);
  assert.match(beltflowd(data, "token", "list").stdout, new RegExp(`granted .* /v1/runs/${run.id}$`, "m"));
  assert.equal((await d.request("DELETE", `/v1/grants/${grant.id}`, { headers: bob })).status, 404);
  assert.equal((await d.request("DELETE", "/v1/grants/1", { headers: alice })).status, 404); // a token that is no grant
  assert.equal((await d.request("DELETE", `/v1/grants/${grant.id}`, { headers: alice })).status, 204);
  assert.equal((await d.get(`/v1/runs/${run.id}`, guest)).status, 401);
  assert.deepEqual((await d.get("/v1/grants", alice)).json.grants, []);
  assert.ok(!d.log.includes(token.slice(4)), d.log);
  assert.match(beltflowd(data, "token", "add", "x", "--scopes", "granted").stderr, /--scopes wants words/);

  const open = await daemon(t);
  const { json: anybodys } = await open.post("/v1/runs", submission());
  const refused = await open.post(`/v1/runs/${anybodys.id}/grants`, {});
  assert.equal(refused.status, 409);
  assert.match(refused.json.detail, /no access tokens/);
});
