// What helps a reader: four steps to begin with, what words mean, and what the keyboard does.

import { h, link } from "./base/dom.js";
import { address } from "./base/router.js";
import { schemas, titleOf } from "./run/key_figures.js";

const steps = [
  [address("new", "", { example: "example-1" }), "Begin with Example 1", "192 cylinders before a deflector. “Run both models” solves it twice."],
  [address("compare"), "Compare", "Press play: parts and density under one clock, both outflow curves, and a sentence on how far they agree."],
  [address("studies", "new", { example: "example-1" }), "Find the best angle", "A study solves the line at many angles, with repeats, and says which are best and how sure that is."],
  [address("new", "", { blank: "1" }), "Draw your own line", "Choose goods, add belts, deflectors and feeds, or lay them over a drawing of the hall."],
];

const words = [
  ["Microscopic model", "Every part is a body that moves by Newton’s laws, with contact and friction. It is the more accurate one."],
  ["Macroscopic model", "A density of cargo that moves by a conservation law. It is fast at any number of parts."],
  ["Density", "How full a place is: 1 is as close as equal parts can be packed."],
  ["Closure", "How the density model slows down cargo that is packed: congested for goods of any kind, dispersive as in the paper."],
  ["Deflector", "A plate that guides cargo to one side of the belt; the way past its tip is the opening."],
  ["Jam", "A time in which nothing leaves although cargo is there, longer than the scenario’s jam time."],
  ["Bridge", "Parts that hold each other up before an opening, so that nothing comes through. Only parts do that, not a density."],
  ["Warm-up", "The time at the start that figures leave out, while the belt fills."],
  ["Substream, replication", "The same line with other chances of arrival. Several show how much of a figure is chance."],
  ["95 % interval, ±", "In 95 of 100 such runs it covers the mean of a run without end."],
  ["Validity", "Whether the model was compared with others for goods and openings like these; “outside” tells where it was not."],
  ["Study", "Runs of one line that differ in a few numbers, to find the best or to see how a figure depends on them."],
  ["Indifference", "A difference too small to matter: what is better by less counts as equal."],
];

const keys = [
  ["Space or K", "play, pause"],
  ["← →", "one snapshot back, on"],
  ["Home, End", "first, newest snapshot"],
  [", .", "slower, faster"],
  ["F", "follow a run that is still computed"],
  ["+ − 0", "zoom in, out, whole belt; so does the wheel with Ctrl"],
  ["W A S D", "move what is seen up, left, down, right, where it is zoomed"],
  ["Tab to the belt, then arrows", "move the probe that shows the density; with Shift by single pixels"],
  ["Ctrl+Z, with Shift", "of a line that is edited: undo, redo; elsewhere take back a deletion, while it is told"],
  ["?", "this help"],
];

const scopes = { RunFigures: "", FeedFigures: "of a feed", CounterFigures: "of a counter", PhotoEyeFigures: "of a photo eye", BeltFigures: "of a belt", FailureFigures: "of a kind of failure", OutletFigures: "of an outlet", SinkFigures: "of a sink" };

// "Throughput [parts/h]" and what it means, of each key figure, as the API's description has it. A figure of several numbers has
// what each of them means.
function figureRows(known) {
  return Object.entries(scopes).flatMap(([name, scope]) => Object.entries(known[name]?.properties ?? {}).filter(([word]) => word !== "id")
    .map(([word, { description, properties }]) => {
      const parts = Object.entries(properties ?? {}).map(([part, { description: said }]) => `${part.replaceAll("_", " ")}: ${said}`);
      return [[titleOf(word), scope].filter(Boolean).join(" "), [description, ...parts].filter(Boolean).join(". ")];
    }));
}

const facts = (rows, mark = (text) => text) => h("dl", { class: "facts" }, rows.map(([word, what]) => h("div", {}, h("dt", {}, mark(word)), h("dd", {}, what))));
const fold = (title, isOpen, ...content) => h("details", { open: isOpen }, h("summary", {}, title), content);

export function showHelp() {
  const figures = h("div", {});
  const dialog = h("dialog", { class: "card dialog help-dialog", "aria-labelledby": "help-title",
    on: { close: () => dialog.remove(), click: (event) => (event.target === dialog || event.target.closest("a")) && dialog.close() } },
  h("h2", { id: "help-title" }, "Help"),
  fold("In four steps", true, h("ol", {}, steps.map(([target, name, what]) => h("li", {}, link(target, name), ` ${what}`)))),
  fold("Words", false, facts(words)),
  fold("Key figures", false, figures),
  fold("Keyboard", true, facts(keys, (key) => h("kbd", {}, key))),
  h("p", {}, link("docs", "The manual"), " says the rest."),
  h("form", { method: "dialog" }, h("button", { class: "primary" }, "Close")));
  document.body.append(dialog);
  dialog.showModal();
  schemas().then((known) => figures.replaceChildren(facts(figureRows(known))));
}
