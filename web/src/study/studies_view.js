// The list of studies.

import { listStudies } from "../base/api.js";
import { h, link } from "../base/dom.js";
import { age, moment } from "../base/format.js";
import { address } from "../base/router.js";
import { statePill } from "../base/run_words.js";
import { methodWords, nameOfStudy, trialsWords } from "./study_words.js";

const PERIOD_MS = 2000;
const columns = ["Study", "Method", "State", "Trials", "Age"];

export class StudiesView {
  constructor() {
    this.title = "Studies";
  }

  async mount(root, { query }) {
    this.cursor = query.get("cursor") ?? "";
    this.body = h("tbody");
    this.table = h("table", { class: "studies" },
      h("thead", {}, h("tr", {}, columns.map((name) => h("th", { scope: "col" }, name)))), this.body);
    this.foot = h("nav", { class: "pager", "aria-label": "Pages" });
    this.state = h("div", { class: "empty" }, h("p", {}, "Loading …"));
    root.append(h("div", { class: "view-head" }, h("h1", {}, "Studies"),
      link(address("studies", "new"), "New study", { class: "button primary" })),
    h("section", { class: "card list", "aria-label": "Studies" }, this.table, this.state), this.foot);
    this.table.hidden = true;
    await this.refresh();
  }

  unmount() {
    this.isGone = true;
    clearTimeout(this.timer);
  }

  async refresh() {
    try {
      const { studies, cursor } = await listStudies({ limit: 50, cursor: this.cursor });
      if (this.isGone) return;
      this.show(studies, cursor);
    } catch (error) {
      if (this.isGone) return;
      if (error.status !== 0 || this.key === undefined) throw error;
    }
    this.timer = setTimeout(() => this.refresh().catch(() => {}), PERIOD_MS);
  }

  // Rows are made again only when something has changed, so that the focus stays.
  show(studies, next) {
    const key = JSON.stringify([studies, next]);
    if (key === this.key) return;
    this.key = key;
    const focused = document.activeElement?.getAttribute("href");
    this.body.replaceChildren(...studies.map((study) => this.row(study)));
    this.foot.replaceChildren(...(next ? [link(address("studies", "", { cursor: next }), "Older →", { class: "button" })] : []));
    this.table.hidden = studies.length === 0;
    this.state.hidden = studies.length > 0;
    this.state.replaceChildren(h("p", {}, "No studies yet. A study tries a parameter, an angle perhaps, and says which value is best."),
      link(address("studies", "new"), "New study", { class: "button primary" }));
    if (focused) this.body.querySelector(`a[href="${CSS.escape(focused)}"]`)?.focus();
  }

  row(study) {
    const { pill, show } = statePill(study);
    show(study);
    return h("tr", {}, h("th", { scope: "row", class: "name" }, link(address("studies", study.id), nameOfStudy(study))),
      h("td", {}, methodWords(study)), h("td", {}, pill), h("td", { class: "figures" }, trialsWords(study)),
      h("td", {}, h("time", { datetime: study.created_at, title: moment(study.created_at) }, age(study.created_at))));
  }
}
