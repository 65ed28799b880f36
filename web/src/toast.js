// Notifications at the edge of the page: what was done, and a button to undo it.

import { h, iconButton } from "./dom.js";

const SHOWN_MS = 6000;

// { undo, onGone }: undo() when the button was used, onGone() when it was not.
export function toast(text, { undo, onGone, isFault = false } = {}) {
  const box = document.getElementById("toasts");
  let isOpen = true;
  const leave = (isUndone) => {
    if (!isOpen) return;
    isOpen = false;
    clearTimeout(timer);
    element.remove();
    if (isUndone) undo();
    else onGone?.();
  };
  const element = h(
    "div",
    { class: isFault ? "toast fault" : "toast" },
    h("span", {}, text),
    undo ? h("button", { type: "button", class: "quiet", on: { click: () => leave(true) } }, "Undo") : null,
    iconButton("close", "Dismiss", () => leave(false), { class: "bare" }),
  );
  const timer = setTimeout(() => leave(false), SHOWN_MS);
  box.append(element);
  return () => leave(false);
}

export function tellFault(error) {
  if (error.name !== "AbortError") toast(error.message, { isFault: true });
}
