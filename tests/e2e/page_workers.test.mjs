// What the page shows an operator of the workers on other machines.

import assert from "node:assert/strict";
import test, { after } from "node:test";

import { assertAccessible, closeBrowser, openPage, takePicture, visit } from "./browser.mjs";
import { daemon } from "./daemon.mjs";
import { PullWorker } from "./pull_worker.mjs";
import { tiny } from "./scenarios.mjs";

after(closeBrowser);

test("workers appear with their cores and leases, and what they have done counts", async (t) => {
  const d = await daemon(t, { executor: "pull" });
  const page = await openPage(t, d);
  await visit(page, "#/");
  await page.getByRole("link", { name: "Workers" }).click();
  await page.getByText("No worker was heard of in the last minute.").waitFor();

  const run = await d.submit(tiny());
  const worker = new PullWorker(d, "hall-3", 4);
  const lease = await worker.lease();
  const row = page.locator("tbody tr", { hasText: "hall-3" });
  await row.getByText("0 of 1").waitFor();
  const cells = await row.locator("th, td").allInnerTexts();
  assert.deepEqual([cells[0], cells[1], cells[4]], ["hall-3", "4", "1"]);
  await page.getByText("1 worker with 4 cores.").waitFor();
  await takePicture(page, "workers-wide-light", "wide");
  await assertAccessible(page, "workers");

  const frames = await worker.solve(lease.inputs[0]);
  await worker.deliverAll(lease, 0, frames);
  await worker.renew(lease, [], [{ job: 0, bytes: frames.length }]);
  await d.reached(run.id, "succeeded");
  await row.getByText("–").waitFor();
});

test("a daemon that solves runs itself says that it has no workers", async (t) => {
  const page = await openPage(t, await daemon(t));
  await visit(page, "#/workers");
  await page.getByText("This server solves runs itself").waitFor();
});
