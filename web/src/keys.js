// What the keyboard does.

import { h } from "./dom.js";

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
  ["?", "this list"],
];

export function showKeys() {
  const dialog = h("dialog", { class: "card dialog keys-dialog", "aria-labelledby": "keys-title",
    on: { close: () => dialog.remove(), click: (event) => event.target === dialog && dialog.close() } },
  h("h2", { id: "keys-title" }, "Keyboard"),
  h("dl", { class: "facts" }, keys.map(([key, what]) => h("div", {}, h("dt", {}, h("kbd", {}, key)), h("dd", {}, what)))),
  h("form", { method: "dialog" }, h("button", { class: "primary" }, "Close")));
  document.body.append(dialog);
  dialog.showModal();
}
