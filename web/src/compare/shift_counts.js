// The dialog that shifts measured counts in time, whose clock did not begin with the run: by hand, or as fits a run best.

import { h } from "../base/dom.js";
import { number } from "../base/format.js";
import { readNumber, writeNumber } from "../base/numbers.js";
import { distanceOf, fittedShift, shifted } from "../plot/series.js";

// How many seconds later the counts shall be, or null: they stay. reference: the curve { name, t, v } that they are laid over, with samples.
export function askForShift(curve, reference) {
  return new Promise((done) => {
    const show = () => {
      const { value, fault } = readNumber(box.value);
      const distance = fault ? null : distanceOf(shifted(curve, value), reference);
      said.textContent = fault ? `It ${fault}.` : distance === null ? `Fewer than two samples are within ${reference.name}.`
        : `Root mean square distance from ${reference.name}: ${number(distance, 4)} parts.`;
      said.className = fault ? "fault" : "hint";
      use.disabled = fault !== "" || value === 0;
    };
    const fit = () => {
      box.value = writeNumber(fittedShift(curve, reference) ?? 0);
      show();
    };
    const box = h("input", { type: "text", inputmode: "decimal", autocomplete: "off", value: "0", on: { input: show } });
    const said = h("p", { role: "status", class: "hint" });
    const use = h("button", { class: "primary", value: "use" }, "Shift the counts");
    const dialog = h("dialog", { class: "card dialog", "aria-labelledby": "shift-title", on: { close: () => {
      dialog.remove();
      done(dialog.returnValue === "use" ? readNumber(box.value).value : null);
    } } }, h("h2", { id: "shift-title" }, `Shift ${curve.label} in time`), h("form", { method: "dialog" },
      h("label", { class: "field" }, h("span", {}, "Later by"), h("span", { class: "with-unit" }, box, h("span", { class: "unit" }, "s"))), said,
      h("div", { class: "row" }, use, h("button", { type: "button", on: { click: fit } }, "Fit"), h("button", { value: "" }, "Cancel"))));
    document.body.append(dialog);
    dialog.showModal();
    show();
  });
}
