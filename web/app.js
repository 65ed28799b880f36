// The list of runs, kept up to date by asking again, and a button for each ready example.

const PERIOD_MS = 1000;
const LIMIT = 50;
const clock = new Intl.DateTimeFormat(undefined, { dateStyle: "short", timeStyle: "medium" });

const find = (id) => document.getElementById(id);

// An element with its text and children.
function make(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

function tell(text, isFault = false) {
  const notice = find("notice");
  if (notice.textContent === text) return;
  notice.textContent = text;
  notice.className = isFault ? "fault" : "";
}

// The JSON of an answer; what a problem document says becomes an Error.
async function ask(target, options) {
  const response = await fetch(target, options);
  const value = await response.json();
  if (!response.ok) throw new Error(value.detail ?? response.statusText);
  return value;
}

function results(run) {
  const { links } = run;
  const cell = make("td");
  const add = (text, href) => cell.append(make("a", { href, textContent: text }), " ");
  add("run", links.self);
  add("curve", `${links.curve}?format=csv`);
  add("snapshots", links.snapshots);
  add("scenario", links.scenario);
  if (run.finished_at && run.started_at && !run.error) add("summary", links.summary);
  return cell;
}

function state(run) {
  const cell = make("td", {}, run.status);
  if (run.error !== null) cell.append(make("small", { className: "fault" }, run.error.detail));
  return cell;
}

function row(run) {
  const name = run.name || "unnamed";
  const share = `${Math.floor(run.progress * 100)} %`;
  const bar = make("progress", { value: run.progress, max: 1 });
  bar.setAttribute("aria-label", `Progress of ${name}`);
  const time = make("time", { dateTime: run.created_at }, clock.format(new Date(run.created_at)));
  return make(
    "tr",
    {},
    make("td", {}, name, make("small", {}, run.label || run.id)),
    make("td", {}, run.model),
    state(run),
    make("td", { className: "figures" }, bar, share),
    make("td", { className: "figures" }, time),
    results(run),
  );
}

let shown = "";

// The table is only touched when something changed, so that focus and selection stay.
function show(runs, hasMore) {
  const now = JSON.stringify(runs);
  if (now === shown) return;
  shown = now;
  const focused = document.activeElement?.getAttribute("href");
  find("runs").replaceChildren(...runs.map(row));
  find("empty").hidden = runs.length > 0;
  find("more").hidden = !hasMore;
  if (focused) find("runs").querySelector(`a[href="${CSS.escape(focused)}"]`)?.focus();
}

let isAway = false;

async function refresh() {
  try {
    const response = await fetch(`v1/runs?limit=${LIMIT}`);
    if (!response.ok) throw new Error(response.statusText);
    show((await response.json()).runs, response.headers.has("link"));
    if (isAway) tell("The daemon is back.");
    isAway = false;
  } catch {
    isAway = true;
    tell("The daemon does not answer; trying again.", true);
  }
}

async function submit(example, model, button) {
  button.disabled = true;
  try {
    const scenario = await ask(example.url);
    const run = await ask("v1/runs", {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify({ scenario, model }),
    });
    tell(`Submitted “${run.name}”.`);
    await refresh();
  } catch (error) {
    tell(`Not submitted: ${error.message}`, true);
  } finally {
    button.disabled = false;
  }
}

async function showExamples() {
  const { examples } = await ask("v1/examples");
  const items = examples.map((example) => {
    const title = example.title ?? example.name;
    const add = (model, text) => {
      const button = make("button", { type: "button" }, text);
      button.setAttribute("aria-label", `${title}, ${model} model`);
      button.addEventListener("click", () => submit(example, model, button));
      return button;
    };
    return make("li", {}, add("macro", title), " ", add("micro", "as parts"));
  });
  find("examples").replaceChildren(...items);
}

async function showVersion() {
  const { version } = await ask("version");
  find("version").textContent = `Version ${version}.`;
}

async function start() {
  for (const part of [showExamples, showVersion]) {
    part().catch((error) => tell(error.message, true));
  }
  for (;;) {
    if (!document.hidden) await refresh();
    await new Promise((resolve) => setTimeout(resolve, PERIOD_MS));
  }
}

start();
