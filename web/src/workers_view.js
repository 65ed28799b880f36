// The workers that solve runs for this server, for its operator: who there is, what each has, and how long none was heard of.

import { getJson } from "./base/api.js";
import { h } from "./base/dom.js";
import { bytes, span } from "./base/format.js";

const EVERY_MS = 2000;

const columns = ["Worker", "Cores", "Memory", "Last heard of", "Leases", "Runs and trials done"];

function sum(leases, member) {
  return leases.reduce((total, lease) => total + lease[member], 0);
}

function rowOf({ worker, cores, memory_bytes, seen_s, leases }) {
  const done = leases.length === 0 ? "–" : `${sum(leases, "done")} of ${sum(leases, "jobs")}`;
  const cells = [String(cores), bytes(memory_bytes), seen_s < 2 ? "just now" : `${span(seen_s)} ago`, String(leases.length), done];
  return h("tr", {}, h("th", { scope: "row" }, worker), cells.map((text) => h("td", {}, text)));
}

function tableOf(workers) {
  return h("table", { class: "runs" },
    h("thead", {}, h("tr", {}, columns.map((name) => h("th", { scope: "col" }, name)))),
    h("tbody", {}, workers.map(rowOf)));
}

function wordsOf(workers) {
  if (workers.length === 0) return "No worker was heard of in the last minute. Runs wait until one asks for them.";
  const cores = sum(workers, "cores");
  return `${workers.length} ${workers.length === 1 ? "worker" : "workers"} with ${cores} ${cores === 1 ? "core" : "cores"}.`;
}

export class WorkersView {
  title = "Workers";

  async mount(root) {
    this.words = h("p", { class: "hint" });
    this.table = h("div", { class: "list" });
    root.append(h("div", { class: "view-head" }, h("h1", {}, "Workers")), h("section", { class: "card" }, this.words, this.table));
    await this.refresh();
  }

  unmount() {
    clearTimeout(this.timer);
    this.isGone = true;
  }

  // Until the view is left; a server that solves runs itself has no workers, and never will.
  async refresh() {
    try {
      const { workers } = await getJson("v1/leases");
      this.words.textContent = wordsOf(workers);
      this.table.replaceChildren(...(workers.length === 0 ? [] : [tableOf(workers)]));
    } catch (error) {
      if (error.status === 409) {
        this.words.textContent = "This server solves runs itself: it has no workers on other machines.";
        return;
      }
      if (error.status !== 0) throw error;
    }
    if (!this.isGone) this.timer = setTimeout(() => this.refresh().catch(() => {}), EVERY_MS);
  }
}
