// Cancel and delete, with a way back from the second; copying of text.

import { cancelRun, removeRun } from "../base/api.js";
import { nameOf } from "../base/format.js";
import { tellFault, toast } from "../base/toast.js";

const going = new Map(); // id -> onGone of runs that are deleted unless undone

// Runs that are to be deleted are not shown any more.
export function isGoing(id) {
  return going.has(id);
}

async function removeOne({ id }) {
  try {
    await removeRun(id);
  } catch (error) {
    if (error.status === 404) return;
    going.delete(id);
    tellFault(error);
  }
}

// Hides a run, or several, at once and deletes them after some seconds unless that is undone. onChange(isBack): hidden,
// back again, or gone for good.
export function removeLater(runs, onChange) {
  const all = [runs].flat();
  const what = all.length === 1 ? `“${nameOf(all[0])}”` : `${all.length} runs`;
  const dismiss = toast(`Deleted ${what}.`, {
    undo: () => {
      for (const { id } of all) going.delete(id);
      onChange(true);
    },
    onGone: () => Promise.all(all.map(removeOne)).then(() => onChange(false)),
  });
  for (const { id } of all) going.set(id, dismiss);
  onChange(false);
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
