// Malformed and malicious requests: each is answered or disconnected, and the daemon goes on.

import assert from "node:assert/strict";
import { once } from "node:events";
import net from "node:net";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { residentBytes } from "./processes.mjs";
import { tiny } from "./scenarios.mjs";
import { isSanitized, until, within } from "./setup.mjs";

const GiB = 1024 ** 3;

// Send bytes as they are; resolves with all that came back when the daemon closed the connection
// (or, with stopAt, when that was seen).
function exchange(d, text, { stopAt } = {}) {
  const answer = new Promise((resolve) => {
    const socket = net.connect(d.port, "127.0.0.1");
    let received = "";
    socket.setEncoding("latin1");
    socket.on("data", (chunk) => {
      received += chunk;
      if (stopAt?.test(received)) socket.destroy();
    });
    socket.on("error", () => {});
    socket.on("close", () => resolve(received));
    socket.write(text, "latin1");
  });
  return within(answer, `an answer to ${JSON.stringify(text.slice(0, 80))}`);
}

const statusOf = (text) => Number(/^HTTP\/1\.1 (\d{3}) /.exec(text)?.[1] ?? 0);
const close = "Host: localhost\r\nConnection: close\r\n";

async function assertUnharmed(d) {
  assert.equal((await d.get("/livez")).status, 200);
  const { runs } = (await d.get("/v1/runs")).json;
  assert.deepEqual(runs, []);
}

test("requests that could be smuggled are refused and the connection is closed", async (t) => {
  const d = await daemon(t);
  const post = "POST /v1/runs HTTP/1.1\r\n";
  const cases = [
    ["length and coding", `${post}${close}Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n`],
    ["two lengths", `${post}${close}Content-Length: 2\r\nContent-Length: 3\r\n\r\n{}`],
    ["two equal lengths", `${post}${close}Content-Length: 2\r\nContent-Length: 2\r\n\r\n{}`],
    ["two hosts", "GET /livez HTTP/1.1\r\nHost: localhost\r\nHost: b\r\n\r\n"],
    ["no host", "GET /livez HTTP/1.1\r\n\r\n"],
    ["a blank before the colon", "GET /livez HTTP/1.1\r\nHost : a\r\n\r\n"],
    ["a control byte in a value", "GET /livez HTTP/1.1\r\nHost: localhost\r\nX-A: b\x01c\r\n\r\n"],
    ["a NUL in a path", "GET /v1/runs/%00 HTTP/1.1\r\nHost: localhost\r\n\r\n"],
    ["a negative length", `${post}${close}Content-Length: -1\r\n\r\n`],
    ["a length that is no number", `${post}${close}Content-Length: 0x10\r\n\r\n`],
    ["a length beyond all", `${post}${close}Content-Length: 99999999999999999999\r\n\r\n`],
    ["coding in 1.0", "POST /v1/runs HTTP/1.0\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"],
    ["a coding of no kind", `${post}${close}Transfer-Encoding: gzip\r\n\r\n`],
    ["a coding with more behind", `${post}${close}Transfer-Encoding: chunked, identity\r\n\r\n0\r\n\r\n`],
    ["a chunk of no size", `${post}${close}Transfer-Encoding: chunked\r\n\r\nxyz\r\n\r\n`],
  ];
  for (const [what, text] of cases) {
    await t.test(what, async () => {
      const status = statusOf(await exchange(d, text));
      assert.ok([0, 400, 413, 501].includes(status), `status ${status}`);
    });
  }
  await assertUnharmed(d);
});

test("what follows a refused request on its connection is not answered", async (t) => {
  const d = await daemon(t);
  const smuggled = "GET /version HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const text = await exchange(
    d,
    "POST /v1/runs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n" +
      `0\r\n\r\n${smuggled}`,
  );
  assert.ok((text.match(/HTTP\/1\.1 /g) ?? []).length <= 1, text);
});

test("a body that says it has 1 GiB is refused before it is sent", async (t) => {
  const d = await daemon(t);
  const text = await exchange(
    d,
    `POST /v1/runs HTTP/1.1\r\n${close}Content-Type: application/json\r\nContent-Length: ${GiB}\r\n\r\n`,
  );
  assert.equal(statusOf(text), 413);
  await assertUnharmed(d);
});

test("a body of 1 GiB in chunks is cut off early with 413", async (t) => {
  const d = await daemon(t);
  const chunk = Buffer.alloc(65536, " ");
  const sent = await within(
    new Promise((resolve) => {
      const socket = net.connect(d.port, "127.0.0.1");
      let received = "";
      let bytes = 0;
      let isOver = false;
      const finish = () => {
        isOver = true;
        resolve({ bytes, status: statusOf(received) });
        socket.destroy();
      };
      socket.on("data", (data) => {
        received += data;
        if (statusOf(received)) finish();
      });
      socket.on("error", () => {});
      socket.on("close", () => isOver || finish());
      socket.write(
        "POST /v1/runs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n" +
          "Transfer-Encoding: chunked\r\n\r\n",
      );
      const pump = () => {
        while (!isOver && bytes < GiB) {
          bytes += chunk.length;
          if (!socket.write(Buffer.concat([Buffer.from("10000\r\n"), chunk, Buffer.from("\r\n")]))) {
            socket.once("drain", pump);
            return;
          }
        }
      };
      pump();
    }),
    "the refusal of a long body",
  );
  assert.equal(sent.status, 413);
  assert.ok(sent.bytes < 64 * 1024 * 1024, `${sent.bytes} bytes were taken`);
  if (!isSanitized) assert.ok(residentBytes(d.pid) < 128 * 1024 * 1024);
  await assertUnharmed(d);
});

test("a body within the limit but of the wrong kind is told so", async (t) => {
  const d = await daemon(t);
  const body = JSON.stringify({ scenario: tiny() });
  for (const type of ["text/plain", "application/xml", "application/x-www-form-urlencoded"]) {
    const answer = await d.request("POST", "/v1/runs", { headers: { "content-type": type }, body });
    assert.equal(answer.status, 415, type);
  }
  await assertUnharmed(d);
});

test("paths and ids that are not there are 404, of any form", async (t) => {
  const d = await daemon(t);
  const nobody = "01890a5d-ac96-774b-bcce-b302099a8057";
  for (const target of [
    "/v1", "/v2/runs", "/v1/runs/", "/v1/runs/x", `/v1/runs/${nobody}`, `/v1/runs/${nobody}/curve`,
    `/v1/runs/${nobody.toUpperCase()}`, `/v1/runs/${nobody}/snapshots/0`, `/v1/runs/${"a".repeat(900)}`,
    "/v1/examples/example-99", "/v1/runs/..%2f..%2fetc%2fpasswd", "/../../etc/passwd",
    "/%2e%2e/%2e%2e/etc/passwd", "/style.css/../../README.md", "/..%5c..%5cetc",
  ]) {
    const answer = await d.get(target);
    assert.ok([400, 404].includes(answer.status), `${target}: ${answer.status}`);
  }
  await assertUnharmed(d);
});

test("methods that a path does not know are 405 and say which it knows", async (t) => {
  const d = await daemon(t);
  for (const [method, target, allow] of [
    ["PUT", "/v1/runs", /GET.*POST|POST.*GET/],
    ["DELETE", "/v1/runs", /GET/],
    ["POST", "/livez", /GET/],
    ["PATCH", "/v1/examples", /GET/],
    ["POST", "/v1/runs/01890a5d-ac96-774b-bcce-b302099a8057/curve", /GET/],
    ["GET", "/v1/validate", /POST/],
  ]) {
    const answer = await d.request(method, target);
    assert.equal(answer.status, 405, `${method} ${target}`);
    assert.match(answer.headers.allow, allow);
    assert.equal(answer.headers["content-type"], "application/problem+json");
  }
  const options = await d.request("OPTIONS", "/v1/runs");
  assert.equal(options.status, 204);
  assert.match(options.headers.allow, /POST/);
  const head = await d.request("HEAD", "/v1/examples");
  assert.deepEqual([head.status, head.body.length], [200, 0]);
  await assertUnharmed(d);
});

test("what cannot be given is a 406, what is not known in a query a 400", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  await d.reached(run.id, "succeeded");
  const curve = `/v1/runs/${run.id}/curve`;
  assert.equal((await d.get(curve, { accept: "image/png" })).status, 406);
  assert.equal((await d.get(`${curve}?format=xml`)).status, 400);
  assert.equal((await d.get(`${curve}?formt=csv`)).status, 400);
  assert.equal((await d.get("/v1/runs?limit=0")).status, 400);
  assert.equal((await d.get("/v1/runs?limit=x")).status, 400);
  assert.equal((await d.get("/v1/runs?status=done")).status, 400);
  assert.equal((await d.get("/v1/runs?status=%zz")).status, 400);
  const csv = await d.get(curve, { accept: "text/csv;q=1, application/json;q=0.5" });
  assert.match(csv.headers["content-type"], /^text\/csv/);
});

test("headers that never end and requests that never come are cut off", async (t) => {
  const d = await daemon(t, { header_deadline_ms: 300, body_deadline_ms: 300 });
  const slow = await exchange(d, "GET /livez HTTP/1.1\r\nHost: localhost\r\nX-A: ");
  assert.ok([0, 408].includes(statusOf(slow)), slow);
  const half = await exchange(
    d,
    "POST /v1/runs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 100\r\n\r\n{",
  );
  assert.ok([0, 408].includes(statusOf(half)), half);
  await assertUnharmed(d);
});

test("a header or an address of a megabyte is refused", async (t) => {
  const d = await daemon(t);
  const long = "a".repeat(1024 * 1024);
  const header = await exchange(d, `GET /livez HTTP/1.1\r\n${close}X-A: ${long}\r\n\r\n`);
  assert.ok([0, 400, 413, 431].includes(statusOf(header)), header.slice(0, 80));
  const address = await exchange(d, `GET /${long} HTTP/1.1\r\n${close}\r\n`);
  assert.ok([0, 400, 404, 413, 414, 431].includes(statusOf(address)), address.slice(0, 80));
  await assertUnharmed(d);
});

test("noise is no request", async (t) => {
  const d = await daemon(t);
  const noise = Array.from({ length: 4096 }, (_, k) => String.fromCharCode((k * 7919 + 13) % 256));
  for (const text of ["\r\n\r\n\r\n", "\x16\x03\x01\x02\x00\x01\x00", "GET\r\n\r\n", noise.join("")]) {
    const answer = exchange(d, `${text}\r\n\r\n`, { stopAt: /\r\n\r\n/ });
    await Promise.race([answer, new Promise((resolve) => setTimeout(resolve, 300))]);
  }
  await assertUnharmed(d);
});

test("a crowd of connections that say nothing does not shut out the question whether it lives", async (t) => {
  const d = await daemon(t, { connections: 16 });
  const crowd = Array.from({ length: 14 }, () => net.connect(d.port, "127.0.0.1"));
  await Promise.all(crowd.map((socket) => once(socket, "connect")));
  assert.equal((await d.get("/livez")).status, 200);
  for (const socket of crowd) socket.destroy();
  await until(async () => (await d.get("/readyz")).status === 200, "room for others");
  await assertUnharmed(d);
});

test("clients that leave in the middle of anything do no harm", async (t) => {
  const d = await daemon(t);
  const body = JSON.stringify({ scenario: tiny() });
  const whole =
    "POST /v1/validate HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n" +
    `Content-Length: ${body.length}\r\n\r\n${body}`;
  for (let length = 1; length < whole.length; length += 37) {
    const socket = net.connect(d.port, "127.0.0.1");
    socket.on("error", () => {});
    socket.write(whole.slice(0, length), () => socket.destroy());
  }
  await assertUnharmed(d);
});
