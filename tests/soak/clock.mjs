// A thread that times health and a run's document, one after the other, until it is told to stop; then it posts the
// milliseconds of each, { livez, run }. Exchanges that fail are not counted: the daemon may be killed.

import http from "node:http";
import { setTimeout as sleep } from "node:timers/promises";
import { parentPort, workerData } from "node:worker_threads";

const PAUSE_MS = 20;

const times = { livez: [], run: [] };
const agent = new http.Agent({ keepAlive: true });

function ask(path) {
  return new Promise((resolve, reject) => {
    const request = http.get({ host: "127.0.0.1", port: workerData.port, path, agent }, (response) => {
      response.resume();
      response.on("end", () => (response.statusCode === 200 ? resolve() : reject(new Error(path))));
    });
    request.on("error", reject);
  });
}

async function time(kind, path) {
  const begin = performance.now();
  try {
    await ask(path);
    times[kind].push(performance.now() - begin);
  } catch {
    // not counted
  }
  await sleep(PAUSE_MS);
}

let isOver = false;
parentPort.once("message", () => (isOver = true));
while (!isOver) {
  await time("livez", "/livez");
  await time("run", `/v1/runs/${workerData.id}`);
}
agent.destroy();
parentPort.postMessage(times);
