// Links to one run or study for who has no access token: made with a time for which they count, listed, and revoked.

import { currentToken } from "../base/access.js";
import { ask, getJson, post } from "../base/api.js";
import { h } from "../base/dom.js";
import { moment } from "../base/format.js";
import { address } from "../base/router.js";
import { copy } from "./run_actions.js";

const DAY_S = 86400;
const times = [["1", "a day"], ["7", "7 days"], ["30", "30 days"], ["366", "a year"]];

function linkTo(view, id, query = {}) {
  return `${location.origin}${location.pathname}${location.search}${address(view, id, query)}`;
}

// An address to be copied.
function addressRow(text) {
  const shown = h("code", { class: "address" }, text);
  return h("div", { class: "row" }, shown, h("button", { type: "button", on: { click: () => copy(text, shown) } }, "Copy"));
}

class GrantsDialog {
  // view: "runs" or "studies", as the API calls them, too.
  constructor(view, id) {
    Object.assign(this, { view, id });
    this.resource = `/v1/${view}/${id}`;
    this.fault = h("p", { class: "fault", role: "alert" });
    this.made = h("div", { role: "status" });
    this.list = h("ul", { class: "grants", "aria-label": "Links that count" });
  }

  open() {
    const what = this.view === "runs" ? "run" : "study";
    const close = h("button", { type: "button", on: { click: () => dialog.close() } }, "Close");
    const content = currentToken() === null
      ? [h("p", { class: "hint" }, `Whoever reaches this service can see the ${what} at its address:`), addressRow(linkTo(this.view, this.id))]
      : [h("p", { class: "hint" }, `Who has the link sees this ${what}, and nothing else, until its time is over or it is revoked.`), this.form(), this.made, this.list];
    const dialog = h("dialog", { class: "card dialog", "aria-labelledby": "grants-title", on: { close: () => dialog.remove() } },
      h("h2", { id: "grants-title" }, `Share this ${what}`), content, this.fault, h("div", { class: "row" }, close));
    document.body.append(dialog);
    dialog.showModal();
    if (currentToken() !== null) this.attempt(() => this.refresh());
  }

  form() {
    const box = h("select", { name: "expires" }, times.map(([days, text]) => h("option", { value: days }, text)));
    box.value = "30";
    return h("form", { on: { submit: (event) => {
      event.preventDefault();
      this.attempt(() => this.make(Number(box.value) * DAY_S));
    } } }, h("label", { class: "field" }, h("span", {}, "Counts for"), box), h("button", { class: "primary" }, "Make a link"));
  }

  async attempt(action) {
    this.fault.textContent = "";
    try {
      await action();
    } catch (error) {
      this.fault.textContent = error.message;
    }
  }

  async make(seconds) {
    const { token } = await post(`${this.resource.slice(1)}/grants`, { expires_in_s: seconds });
    this.made.replaceChildren(h("p", { class: "hint" }, "The link, which is shown only now:"), addressRow(linkTo(this.view, this.id, { grant: token })));
    await this.refresh();
  }

  async refresh() {
    const { grants } = await getJson("v1/grants");
    this.list.replaceChildren(...grants.filter(({ resource }) => resource === this.resource).map((grant) =>
      h("li", { class: "row" }, h("span", {}, `Link ${grant.id}, counts until ${moment(grant.expires_at)}`),
        h("button", { type: "button", "aria-label": `Revoke link ${grant.id}`, on: { click: () => this.attempt(() => this.revoke(grant.id)) } }, "Revoke"))));
  }

  async revoke(id) {
    await ask(`v1/grants/${id}`, { method: "DELETE" });
    this.made.replaceChildren();
    await this.refresh();
  }
}

export function shareButton(view, id) {
  return h("button", { type: "button", on: { click: () => new GrantsDialog(view, id).open() } }, "Share …");
}
