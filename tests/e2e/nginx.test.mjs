// The proxy that deploy/nginx has, a real nginx, before a daemon with the settings that lie beside it.

import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import { readFileSync, writeFileSync } from "node:fs";
import http from "node:http";
import http2 from "node:http2";
import https from "node:https";
import net from "node:net";
import os from "node:os";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { endless, tiny } from "./scenarios.mjs";
import { addToken, beltflowd } from "./tokens.mjs";
import { root, temporaryFolder, until, within } from "./setup.mjs";

const host = "beltflow.example.org";
const settings = path.join(root, "deploy/nginx/beltflowd.conf");
const searched = `${process.env.PATH}:/usr/sbin`;
// An address of this machine by which a client is none of its own.
const outside = Object.values(os.networkInterfaces())
  .flat()
  .find((one) => one.family === "IPv4" && !one.internal)?.address;

async function freePort() {
  const server = net.createServer().listen(0, "0.0.0.0");
  await once(server, "listening");
  const { port } = server.address();
  server.close();
  return port;
}

// The sample as it is shipped, but for ports, the certificate and IPv6, which this machine may lack; `more` stands before it.
function configure(folder, ports, d, more) {
  const sample = readFileSync(path.join(root, "deploy/nginx/beltflow.conf"), "utf8");
  const site = sample
    .replace(/^ *listen \[::\].*\n/gm, "")
    .replaceAll("listen 80;", `listen ${ports.http};`)
    .replaceAll("listen 443 ", `listen ${ports.https} `)
    .replaceAll("127.0.0.1:8080", `127.0.0.1:${d.port}`)
    .replaceAll("/etc/ssl/beltflow", folder);
  const temporary = ["client_body", "proxy", "fastcgi", "uwsgi", "scgi"].map(
    (name) => `${name}_temp_path ${folder}/${name};`,
  );
  return `daemon off; master_process off; pid ${folder}/pid; error_log stderr;
    events {} http { access_log off; ${temporary.join(" ")} ${more} ${site} }`;
}

// nginx before a daemon.
async function proxy(t, d, more = "") {
  const folder = temporaryFolder(t);
  const ports = { http: await freePort(), https: await freePort() };
  const certificate = ["req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", `/CN=${host}`, "-addext",
    `subjectAltName=DNS:${host}`, "-keyout", `${folder}/privkey.pem`, "-out", `${folder}/fullchain.pem`];
  const made = spawnSync("openssl", certificate, { encoding: "utf8" });
  assert.equal(made.status, 0, made.stderr);
  writeFileSync(`${folder}/nginx.conf`, configure(folder, ports, d, more));
  const child = spawn("nginx", ["-p", folder, "-e", "stderr", "-c", `${folder}/nginx.conf`], {
    env: { ...process.env, PATH: searched },
    stdio: ["ignore", "ignore", "pipe"],
  });
  let log = "";
  child.stderr.on("data", (chunk) => (log += chunk));
  child.on("error", (error) => (log += `${error}: deploy/install-deps --test installs nginx`));
  t.after(() => child.kill("SIGKILL"));
  const ca = readFileSync(`${folder}/fullchain.pem`);
  const p = { ports, ca };
  await until(async () => {
    assert.ok(child.exitCode === null && !log.includes("install-deps"), log);
    return ask(p, "/livez").catch(() => null);
  }, "nginx to answer");
  return p;
}

// One request through the proxy by HTTPS, to an address of this machine: the answer with its text.
async function ask(p, target, { address = "127.0.0.1", method = "GET", headers = {}, body } = {}) {
  const request = https.request({
    host: address, port: p.ports.https, servername: host, ca: p.ca, agent: false, path: target, method,
    headers: { host, ...headers },
  });
  request.end(body);
  const [answer] = await within(once(request, "response"), target);
  answer.setEncoding("utf8");
  let text = "";
  for await (const chunk of answer) text += chunk;
  return { status: answer.statusCode, headers: answer.headers, text };
}

// Wait until an event stream through the proxy has said this, while it goes on.
async function hear(t, p, target, wanted) {
  const request = https.get({
    host: "127.0.0.1", port: p.ports.https, servername: host, ca: p.ca, agent: false, path: target, headers: { host },
  });
  t.after(() => request.destroy());
  const [events] = await within(once(request, "response"), target);
  assert.equal(events.statusCode, 200);
  let text = "";
  events.on("data", (chunk) => (text += chunk));
  events.on("end", () => (text += "(the end)"));
  await until(() => text.includes(wanted), `${wanted} of ${target}`);
  assert.doesNotMatch(text, /\(the end\)/);
  request.destroy();
}

const statuses = async (p, n, more) => {
  const all = [];
  for (let k = 0; k < n; k++) all.push((await ask(p, "/version", more)).status);
  return all;
};

test("the pair as it is shipped does not let everybody in: it wants a token, or to be told", async (t) => {
  const data = path.join(temporaryFolder(t), "data");
  const refused = beltflowd(data, "--config", settings, "--listen", "127.0.0.1:0");
  assert.equal(refused.status, 2, refused.stderr);
  assert.match(refused.stderr, /trusted_proxies says .* token add NAME.* plaintext = open/);
  const open = await daemon(t, { config: settings, plaintext: "open" });
  assert.match(open.log, /level=warn event=open_to_everybody why=plaintext /);
  addToken(data, "alice");
  const closed = await daemon(t, { config: settings, data });
  assert.equal((await closed.get("/v1/runs", { host })).status, 401);
});

test("the pair answers by HTTPS, HTTP/2 and under its name only", async (t) => {
  const p = await proxy(t, await daemon(t, { config: settings, plaintext: "open" }));
  assert.equal((await ask(p, "/version")).status, 200);
  assert.equal((await ask(p, "/version", { headers: { host: "evil.example" } })).status, 421);
  const plain = http.get({ host: "127.0.0.1", port: p.ports.http, path: "/version", headers: { host } });
  const [redirect] = await within(once(plain, "response"), "a redirect");
  assert.deepEqual([redirect.statusCode, redirect.headers.location], [301, `https://${host}/version`]);
  redirect.resume();
  const session = http2.connect(`https://127.0.0.1:${p.ports.https}`, { ca: p.ca, servername: host });
  const stream = session.request({ ":path": "/v1/examples", ":authority": host });
  const [headers] = await within(once(stream, "response"), "an answer by HTTP/2");
  assert.equal(headers[":status"], 200);
  session.destroy();
});

// The attributes of each element of that name in sslscan's answer, which has no nesting of them.
function elements(xml, name) {
  return [...xml.matchAll(new RegExp(`<${name} ([^>]*)>`, "g"))].map(([, attributes]) =>
    Object.fromEntries([...attributes.matchAll(/(\w+)="([^"]*)"/g)].map(([, key, value]) => [key, value])));
}

test("the pair's TLS has no weakness that sslscan knows", async (t) => {
  const p = await proxy(t, await daemon(t, { config: settings, plaintext: "open" }));
  const scan = spawn("sslscan", ["--xml=-", "--no-colour", `--sni-name=${host}`, `127.0.0.1:${p.ports.https}`],
    { stdio: ["ignore", "pipe", "inherit"] });
  scan.stdout.setEncoding("utf8");
  let xml = "";
  scan.stdout.on("data", (chunk) => (xml += chunk));
  const [status] = await within(once(scan, "close"), "sslscan, which deploy/install-deps --test installs");
  assert.equal(status, 0, xml);
  const versions = elements(xml, "protocol").map((one) => [`${one.type} ${one.version}`, one.enabled]);
  assert.deepEqual(Object.fromEntries(versions),
    { "ssl 2": "0", "ssl 3": "0", "tls 1.0": "0", "tls 1.1": "0", "tls 1.2": "1", "tls 1.3": "1" });
  // Ephemeral keys and authenticated encryption; in TLS 1.3 there are no others.
  assert.deepEqual([...new Set(elements(xml, "cipher").map((one) => `${one.sslversion} ${one.cipher}`))].sort(), [
    "TLSv1.2 ECDHE-RSA-AES128-GCM-SHA256", "TLSv1.2 ECDHE-RSA-AES256-GCM-SHA384", "TLSv1.2 ECDHE-RSA-CHACHA20-POLY1305",
    "TLSv1.3 TLS_AES_128_GCM_SHA256", "TLSv1.3 TLS_AES_256_GCM_SHA384", "TLSv1.3 TLS_CHACHA20_POLY1305_SHA256",
  ]);
  assert.ok(elements(xml, "group").every((group) => Number(group.bits) >= 112), xml);
  assert.deepEqual(elements(xml, "heartbleed").map((one) => one.vulnerable), ["0", "0"]);
  // A client may not renegotiate, and compression, where sslscan can ask for it, is off.
  assert.deepEqual(elements(xml, "renegotiation").map((one) => one.supported), ["0"]);
  assert.ok(elements(xml, "compression").every((one) => one.supported === "0"), xml);
});

test("a run is submitted and its events come while it is solved", async (t) => {
  const d = await daemon(t, { config: settings, plaintext: "open" });
  const p = await proxy(t, d);
  const submit = (scenario) =>
    ask(p, "/v1/runs", {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify({ scenario }),
    });
  const answer = await submit(endless());
  assert.equal(answer.status, 201, answer.text);
  const id = JSON.parse(answer.text).id;
  await hear(t, p, `/v1/runs/${id}/events`, "event: progress");
  const large = await submit(tiny({ name: "x".repeat(2 * 1024 * 1024) }));
  assert.equal(large.status, 413);
  assert.equal((await ask(p, `/v1/runs/${id}`, { method: "DELETE" })).status, 204);
});

test("streams of events are passed on at once by what the sample itself says", async (t) => {
  // Nobody solves what waits, so no stream ends and none has as much as a buffer holds.
  const d = await daemon(t, { config: settings, plaintext: "open", executor: "pull" });
  const p = await proxy(t, d, "proxy_ignore_headers X-Accel-Buffering;");
  const run = await d.submit(tiny());
  const { json: study } = await d.post("/v1/studies", {
    base: { scenario: tiny() },
    parameters: [{ pointer: "/duration_s", values: [0.1, 0.2] }],
    objectives: [{ figure: "content.mean" }],
    method: { type: "list" },
  });
  for (const target of [`/v1/runs/${run.id}/events`, `/v1/events?runs=${run.id}`, `/v1/studies/${study.id}/events`])
    await hear(t, p, target, "event: status");
});

test("limits hold for each client behind the proxy", { skip: outside === undefined && "no network" }, async (t) => {
  const d = await daemon(t, { config: settings, plaintext: "open", requests_per_minute: 3 });
  const p = await proxy(t, d);
  const forged = { address: outside, headers: { "x-forwarded-for": "127.0.0.1" } };
  assert.deepEqual(await statuses(p, 4, forged), [200, 200, 200, 429]);
  assert.deepEqual(await statuses(p, 5), [200, 200, 200, 200, 200]);
  assert.equal((await ask(p, "/metrics", { address: outside })).status, 403);
  assert.equal((await ask(p, "/metrics")).status, 200);
  assert.doesNotMatch(d.log, /proxy_not_trusted/);
});

test("a daemon that does not know its proxy counts all its clients as one, and warns", async (t) => {
  const d = await daemon(t, { hosts: host, plaintext: "open", requests_per_minute: 3 });
  const p = await proxy(t, d);
  const seen = await statuses(p, 4);
  assert.equal(seen.at(-1), 429, `${seen}`);
  assert.match(d.log, /level=warn event=proxy_not_trusted address=127\.0\.0\.1 /);
});
