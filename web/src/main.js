// The page: which view is shown, whether the daemon is there, and what holds for all views.

// In the order of the cascade: of two rules for the same element the later one holds.
import "uplot/dist/uPlot.min.css";
import "../style/base.css";
import "../style/controls.css";
import "../style/runs.css";
import "../style/watch.css";
import "../style/curves.css";
import "../style/compare.css";
import "../style/new.css";
import "../style/board.css";
import "../style/studies.css";
import "../style/print.css";

import { enter, onAccess, signOut } from "./base/access.js";
import { getJson } from "./base/api.js";
import { onConnection } from "./base/connection.js";
import { h, link } from "./base/dom.js";
import { note, startRouter } from "./base/router.js";
import { toast, undoLast } from "./base/toast.js";
import { CompareView } from "./compare/compare_view.js";
import { NewView } from "./edit/new_view.js";
import { showHelp } from "./help.js";
import { RunView } from "./run/run_view.js";
import { LinesView } from "./runs/lines_view.js";
import { RunsView } from "./runs/runs_view.js";
import { NewStudyView } from "./study/new_study_view.js";
import { StudiesView } from "./study/studies_view.js";
import { StudyView } from "./study/study_view.js";
import { WorkersView } from "./workers_view.js";

const root = document.getElementById("view");
let view = null;

function viewOf({ name, argument }) {
  if (name === "runs") return argument ? new RunView() : new RunsView();
  if (name === "compare") return new CompareView();
  if (name === "new") return new NewView();
  if (name === "studies") return argument === "new" ? new NewStudyView() : argument ? new StudyView() : new StudiesView();
  if (name === "lines") return new LinesView();
  if (name === "workers") return new WorkersView();
  return null;
}

function explain(title, text) {
  root.replaceChildren(h("section", { class: "card empty" }, h("h1", {}, title), h("p", {}, text),
    link("#/", "All runs", { class: "button" })));
}

async function show(route) {
  if (route.query.has("grant")) {
    enter(route.query.get("grant"));
    note({ grant: "" });
  }
  view?.unmount();
  view = viewOf(route);
  root.replaceChildren();
  root.className = `view ${route.argument === "new" ? "new" : route.name}`;
  for (const item of document.querySelectorAll("nav [data-view]")) {
    const isHere = item.dataset.view === route.name;
    if (isHere) item.setAttribute("aria-current", "page");
    else item.removeAttribute("aria-current");
  }
  scrollTo(0, 0);
  const mine = view;
  if (mine === null) {
    explain("There is no such view", "The address is not one of this page’s.");
    return;
  }
  document.title = `${mine.title} · Beltflow`;
  try {
    await mine.mount(root, route);
    if (view === mine) document.title = `${mine.title} · Beltflow`;
  } catch (error) {
    if (view === mine) fail(error, route);
  }
}

function fail(error, route) {
  if (error.status === 404) explain(`There is no such ${route.name === "studies" ? "study" : "run"}`, "It was deleted, or the address is not complete.");
  else explain("This could not be shown", error.message);
  if (error.status !== 0) return;
  const stop = onConnection((isAway) => {
    if (isAway) return;
    stop();
    show(route);
  });
}

function showConnection(isAway) {
  const word = document.getElementById("connection");
  document.body.classList.toggle("away", isAway);
  word.textContent = isAway ? "The server does not answer. Trying again …" : "";
  if (!isAway) toast("The server is back.");
}

async function showVersion() {
  const { version } = await getJson("version");
  document.getElementById("version").textContent = version;
}

document.querySelector(".skip").addEventListener("click", (event) => {
  event.preventDefault();
  root.focus();
});
document.getElementById("help").addEventListener("click", showHelp);
document.addEventListener("keydown", (event) => {
  if (event.target.closest?.("input:not([type='checkbox']), textarea, select, .json-box")) return;
  if (event.key === "?") showHelp();
  if (event.key === "z" && (event.ctrlKey || event.metaKey) && undoLast()) event.preventDefault();
});
const signOutButton = document.getElementById("sign-out");
signOutButton.addEventListener("click", signOut);
onAccess((isSignedIn, isGuest) => {
  signOutButton.hidden = !isSignedIn;
  document.querySelector("nav").hidden = isGuest;
});
onConnection(showConnection);
showVersion().catch(() => {});
startRouter(show);
