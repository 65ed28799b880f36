// Readers of large snapshots that do not read: they cost the daemon next to nothing, and do not hold it up.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import net from "node:net";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { residentBytes } from "./processes.mjs";
import { tiny } from "./scenarios.mjs";
import { isSanitized, until, within } from "./setup.mjs";

// 4 million cells: a snapshot of 16 MB, more than sockets buffer.
const columns = 2000;
const rows = 2000;
const bytes = columns * rows * 4;

async function solveLarge(d) {
  const large = tiny({
    duration_s: 0.002,
    domain: { x_m: [0, columns * 0.002], y_m: [0, rows * 0.002] },
    output: { curve_every_s: 0.001, snapshot_every_s: 0.002 },
    macro: { closure: "dispersive", cell_m: 0.002, step_s: "auto" },
  });
  return d.reached((await d.submit(large)).id, "succeeded");
}

// A request on a socket that is not read further than to the first bytes of the answer.
function begin(d, target) {
  const socket = net.connect(d.port, "127.0.0.1");
  socket.on("error", () => {});
  socket.write(`GET ${target} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n`);
  return within(
    new Promise((resolve) => {
      socket.once("data", (first) => {
        socket.pause();
        resolve({ socket, first });
      });
    }),
    "the start of an answer",
  );
}

// What comes until the other side closes, or until as many bytes as announced are there.
function finish({ socket, first }) {
  const chunks = [first];
  const length = Number(/\r\nContent-Length: (\d+)\r\n/.exec(first.toString("latin1"))[1]);
  const head = first.indexOf("\r\n\r\n") + 4;
  return within(
    new Promise((resolve) => {
      let n = first.length - head;
      const end = () => resolve({ length, body: Buffer.concat(chunks).subarray(head) });
      socket.on("data", (chunk) => {
        chunks.push(chunk);
        n += chunk.length;
        if (n >= length) end();
      });
      socket.on("close", end);
      socket.resume();
    }),
    "the rest of an answer",
  );
}

const digest = (body) => createHash("sha256").update(body).digest("hex");

test("twenty readers that do not read cost a few hundred kilobytes each", async (t) => {
  const d = await daemon(t);
  const run = await solveLarge(d);
  const target = `/v1/runs/${run.id}/snapshots/1`;
  const whole = await d.send({ method: "GET", target, headers: {} });
  assert.equal(whole.body.length, bytes + 128);
  const before = residentBytes(d.pid);
  const readers = [];
  for (let k = 0; k < 20; k++) readers.push(await begin(d, target));
  for (const { first } of readers) assert.match(first.toString("latin1"), /^HTTP\/1\.1 200 /);
  // A whole snapshot in memory for each would be 320 MB; a sanitizer keeps what was freed.
  const grown = residentBytes(d.pid) - before;
  if (!isSanitized) assert.ok(grown < 20 * 2 ** 20, `${grown} bytes`);
  assert.equal((await d.get(`/v1/runs/${run.id}`)).status, 200);
  const { body } = await finish(readers[0]);
  assert.equal(digest(body), digest(whole.body));
  for (const { socket } of readers) socket.destroy();
});

test("a run that is removed while its snapshot is sent ends the connection, not the daemon", async (t) => {
  const d = await daemon(t);
  const run = await solveLarge(d);
  const reader = await begin(d, `/v1/runs/${run.id}/snapshots/1`);
  assert.equal((await d.request("DELETE", `/v1/runs/${run.id}`)).status, 204);
  const { length, body } = await finish(reader);
  assert.equal(length, bytes + 128);
  assert.ok(body.length < length, `${body.length} bytes`);
  await until(() => d.log.includes("download_failed"), "the log to say so");
  assert.equal((await d.get("/readyz")).status, 200);
});
