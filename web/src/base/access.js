// Who uses the page: the access token, for services that want one, and the dialog that asks for it. The token is kept for
// this tab alone, and stands in no address but that of a link to one run or study, from which it is taken at once.

import { h } from "./dom.js";

const KEY = "beltflow-token";
const GUEST = "beltflow-guest";

let token = stored(KEY);
let isLink = stored(GUEST) !== null; // the token came with a link to one run or study
let asking = null; // the promise of a sign-in that is open
let listener = () => {};

// Where the browser stores nothing, a sign-in lasts until the page is loaded again.
function stored(key) {
  try {
    return sessionStorage.getItem(key);
  } catch {
    return null;
  }
}

function keep(text, isOfLink = false) {
  token = text;
  isLink = isOfLink;
  try {
    for (const [key, value] of [[KEY, text], [GUEST, isLink ? "1" : null]]) {
      if (value === null) sessionStorage.removeItem(key);
      else sessionStorage.setItem(key, value);
    }
  } catch {
    // See above.
  }
  listener(token !== null, isLink);
}

export function currentToken() {
  return token;
}

// Whether the token is that of a link: it reads one run or study and changes nothing.
export function isGuest() {
  return isLink;
}

// The token of a link that was opened.
export function enter(text) {
  keep(text, true);
}

// onChange(isSignedIn, isGuest), now and at each change.
export function onAccess(onChange) {
  listener = onChange;
  listener(token !== null, isLink);
}

// Options of a request, with the token.
export function authorized(options = {}) {
  if (token === null) return options;
  return { ...options, headers: { ...options.headers, authorization: `Bearer ${token}` } };
}

// What is wrong with a token, "" if the service takes it.
async function judge(text) {
  const headers = { authorization: `Bearer ${text}` };
  try {
    const response = await fetch("v1/runs?limit=1", { headers, cache: "no-store" });
    return response.ok ? "" : ((await response.json()).detail ?? response.statusText);
  } catch {
    return "The server does not answer.";
  }
}

function openDialog(reason) {
  return new Promise((resolve, reject) => {
    const input = h("input", { type: "password", name: "token", autocomplete: "off", spellcheck: "false", required: true,
      "aria-describedby": "sign-in-fault" });
    const fault = h("p", { id: "sign-in-fault", class: "fault", role: "alert" }, reason);
    const button = h("button", { class: "primary" }, "Sign in");
    const submit = async (event) => {
      event.preventDefault();
      button.disabled = true;
      const text = input.value.trim();
      fault.textContent = /^[\x21-\x7e]+$/.test(text) ? await judge(text) : "This is no access token.";
      button.disabled = false;
      if (fault.textContent !== "") return;
      keep(text);
      resolve();
      dialog.close();
    };
    const dialog = h("dialog", { class: "card dialog", "aria-labelledby": "sign-in-title", on: {
      cancel: (event) => event.preventDefault(), // behind it nothing can be done
      close: () => {
        dialog.remove();
        reject(new Error("Nobody is signed in."));
      } } },
    h("h2", { id: "sign-in-title" }, "Sign in"),
    h("form", { on: { submit } },
      h("p", { class: "hint" }, "This service wants an access token. Its operator makes one with ",
        h("code", {}, "beltflowd token add"), "."),
      h("label", { class: "field" }, h("span", {}, "Access token"), input), fault, button));
    document.body.append(dialog);
    dialog.showModal();
  });
}

// The service has refused a request that was sent with this token (null: none): ask for another one. Requests that are
// refused at the same time wait for the same answer; one that was sent before it need not ask.
export function signIn(refused, reason) {
  if (token !== refused) return Promise.resolve();
  if (asking === null) {
    if (token !== null) keep(null);
    asking = openDialog(refused === null ? "" : reason).finally(() => {
      asking = null;
    });
  }
  return asking;
}

// The page is loaded again, so that nothing of what was shown stays; what it still sends then is sent with the token.
export function signOut() {
  addEventListener("pagehide", () => keep(null));
  location.reload();
}
