// The dialog that takes counts from the clipboard, as a spreadsheet copies them, and says how they are read before they are stored.

import { h } from "../base/dom.js";
import { number } from "../base/format.js";
import { readMeasured, summedUp } from "./measured.js";

const kinds = [["at", "how many there were at each time"], ["in", "how many came in the time before, to be summed up"]];

function read(text, kind) {
  const curve = readMeasured(text);
  return kind === "in" ? summedUp(curve) : curve;
}

function preview({ t, v }) {
  const at = (k) => `${number(t[k], 6)} s, ${number(v[k], 9)} parts`;
  return `${t.length} samples: ${at(0)}; ${at(1)}${t.length > 2 ? `; … ${at(t.length - 1)}` : ""}`;
}

// The curve that is pasted, or null: nothing is.
export function askForCounts() {
  return new Promise((done) => {
    const show = () => {
      let text = "";
      let isGood = false;
      try {
        if (box.value.trim() !== "") text = preview(read(box.value, kind.value));
        isGood = text !== "";
      } catch (error) {
        text = error.message;
      }
      said.textContent = text;
      said.className = isGood ? "hint" : "fault";
      use.disabled = !isGood;
    };
    const box = h("textarea", { rows: "8", spellcheck: "false", on: { input: show } });
    const kind = h("select", { on: { change: show } }, kinds.map(([value, text]) => h("option", { value }, text)));
    const said = h("p", { role: "status", class: "hint" });
    const use = h("button", { class: "primary", value: "use", disabled: true }, "Use these counts");
    const dialog = h("dialog", { class: "card dialog", "aria-labelledby": "paste-title", on: { close: () => {
      dialog.remove();
      done(dialog.returnValue === "use" ? read(box.value, kind.value) : null);
    } } }, h("h2", { id: "paste-title" }, "Paste counts"), h("form", { method: "dialog" },
      h("label", { class: "field" }, h("span", {}, "Times in seconds, or times of day, then counts"), box),
      h("label", { class: "field" }, h("span", {}, "The counts say"), kind), said,
      h("div", { class: "row" }, use, h("button", { value: "" }, "Cancel"))));
    document.body.append(dialog);
    dialog.showModal();
  });
}
