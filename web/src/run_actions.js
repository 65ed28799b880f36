// Cancel and delete, with a way back from the second; copying of text.

import { cancelRun, removeRun } from "./api.js";
import { nameOf } from "./format.js";
import { tellFault, toast } from "./toast.js";

const going = new Map(); // id -> onGone of runs that are deleted unless undone

// Runs that are to be deleted are not shown any more.
export function isGoing(id) {
  return going.has(id);
}

// Hides the run at once and deletes it after some seconds unless that is undone. onChange: hidden, back
// again, or gone for good.
export function removeLater(run, onChange) {
  const removeNow = async () => {
    try {
      await removeRun(run.id);
    } catch (error) {
      if (error.status !== 404) {
        going.delete(run.id);
        tellFault(error);
      }
    }
    onChange();
  };
  const dismiss = toast(`Deleted “${nameOf(run)}”.`, {
    undo: () => {
      going.delete(run.id);
      onChange();
    },
    onGone: removeNow,
  });
  going.set(run.id, dismiss);
  onChange();
}

// Leaving the page confirms the deletion.
addEventListener("pagehide", () => {
  for (const dismiss of going.values()) dismiss();
});

export async function cancel(run) {
  try {
    await cancelRun(run.id);
    toast(`Cancelled “${nameOf(run)}”. What it has is kept.`);
  } catch (error) {
    tellFault(error);
  }
}

// Clipboards are for secure pages only; elsewhere the text is selected instead.
export async function copy(text, element) {
  try {
    await navigator.clipboard.writeText(text);
    toast("Copied.");
  } catch {
    getSelection().selectAllChildren(element);
    toast("Selected; copy it with the keyboard.");
  }
}
