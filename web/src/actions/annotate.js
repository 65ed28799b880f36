// The dialog in which a run or a study gets another name or line; a run also another label and notes.

import { h } from "../base/dom.js";
import { tellFault } from "../base/toast.js";

const fields = [["name", "Name", 200], ["label", "Label", 100], ["line", "Line", 100], ["notes", "Notes", 500]];

// known: { name, label, line, notes } of a run, { name, line } of a study; onChange(patch): what is changed is sent, a promise.
export function annotate(known, onChange) {
  const boxes = fields.filter(([member]) => known[member] !== undefined).map(([member, label, most]) => {
    const box = h("input", { type: "text", maxlength: String(most), autocomplete: "off", value: known[member] });
    return { member, box, element: h("label", { class: "field" }, h("span", {}, label), box) };
  });
  const dialog = h("dialog", { class: "card dialog", "aria-labelledby": "annotate-title", on: { close: () => {
    dialog.remove();
    const changed = boxes.filter(({ member, box }) => box.value !== known[member]).map(({ member, box }) => [member, box.value]);
    if (dialog.returnValue === "keep" && changed.length > 0) onChange(Object.fromEntries(changed)).catch(tellFault);
  } } }, h("h2", { id: "annotate-title" }, "What it is called"), h("form", { method: "dialog" }, boxes.map(({ element }) => element),
    h("div", { class: "row" }, h("button", { class: "primary", value: "keep" }, "Keep"), h("button", { value: "" }, "Cancel"))));
  document.body.append(dialog);
  dialog.showModal();
}
