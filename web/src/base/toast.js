// Notifications at the edge of the page: what was done, and a button to undo it.

import { h, iconButton } from "./dom.js";

const SHOWN_MS = 6000;

const undoable = []; // how to undo what the open notifications tell, the last one last

// { undo, onGone }: undo() when the button was used, onGone() when it was not. It stays while it has the focus or the pointer.
export function toast(text, { undo, onGone, isFault = false } = {}) {
  const box = document.getElementById("toasts");
  let isOpen = true;
  let timer = 0;
  const leave = (isUndone) => {
    if (!isOpen) return;
    isOpen = false;
    clearTimeout(timer);
    element.remove();
    if (undo) undoable.splice(undoable.indexOf(takeBack), 1);
    if (isUndone) undo();
    else onGone?.();
  };
  const takeBack = () => leave(true);
  const wait = () => {
    clearTimeout(timer);
    timer = setTimeout(() => leave(false), SHOWN_MS);
  };
  const hold = () => clearTimeout(timer);
  const element = h(
    "div",
    { class: isFault ? "toast fault" : "toast", on: { focusin: hold, pointerenter: hold, focusout: wait, pointerleave: wait } },
    h("span", {}, text),
    undo ? h("button", { type: "button", class: "quiet", title: "Ctrl+Z", on: { click: takeBack } }, "Undo") : null,
    iconButton("close", "Dismiss", () => leave(false), { class: "bare" }),
  );
  if (undo) undoable.push(takeBack);
  wait();
  box.append(element);
  return () => leave(false);
}

// What the last open notification tells; false: there is nothing to undo.
export function undoLast() {
  const takeBack = undoable.at(-1);
  takeBack?.();
  return takeBack !== undefined;
}

export function tellFault(error) {
  if (error.name !== "AbortError") toast(error.message, { isFault: true });
}
