// The search of /docs: as one types, what has all words in its title or text, titles first.

const MOST = 30;
const field = document.getElementById("q");
const shown = document.getElementById("found");
let entries = null; // [kind, title, path, text, lower title, lower text]; loaded when it is needed

async function load() {
  const answer = await fetch("/docs/search.json");
  if (!answer.ok) throw new Error(`The list cannot be read (${answer.status}).`);
  entries ??= (await answer.json()).map((entry) => [...entry, entry[1].toLowerCase(), entry[3].toLowerCase()]);
}

// Small is good; Infinity: a word is missing. Operations and chapters come before members of the same rank.
function rankOf([kind, , , , title, text], words) {
  const ranks = words.map((word) => {
    if (title === word) return 0;
    if (title.startsWith(word)) return 1;
    if (title.includes(word)) return 2;
    return text.includes(word) ? 4 : Infinity;
  });
  return ranks.reduce((sum, rank) => sum + rank, 0) + (["operation", "chapter", "problem"].includes(kind) ? 0 : 0.5);
}

function element(name, text, attributes = {}) {
  const made = Object.assign(document.createElement(name), attributes);
  made.append(text);
  return made;
}

function itemOf([kind, title, path, text]) {
  const item = element("li", element("a", title, { href: path }));
  item.append(" ", element("span", kind, { className: "kind" }), element("p", text));
  return item;
}

async function search() {
  const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
  shown.hidden = words.length === 0;
  if (words.length === 0) return;
  try {
    if (entries === null) await load();
  } catch (error) {
    shown.replaceChildren(element("p", error.message));
    return;
  }
  if (words.join(" ") !== field.value.toLowerCase().split(/\s+/).filter(Boolean).join(" ")) return; // typed on meanwhile
  const found = entries.map((entry) => [rankOf(entry, words), entry]).filter(([rank]) => rank < Infinity)
    .sort(([a], [b]) => a - b).map(([, entry]) => entry);
  const items = document.createElement("ol");
  items.append(...found.slice(0, MOST).map(itemOf));
  const more = found.length > MOST ? `The first ${MOST} of ${found.length}.` : "";
  shown.replaceChildren(element("p", found.length === 0 ? "Nothing has all of these words." : more), items);
}

field.addEventListener("input", search);
field.form.addEventListener("submit", (event) => {
  event.preventDefault();
  shown.querySelector("a")?.click();
});
field.value = new URLSearchParams(location.search).get("q") ?? "";
search();
