// How the editor looks: by the variables of the page's style, in light and dark.

import { HighlightStyle } from "@codemirror/language";
import { EditorView } from "@codemirror/view";
import { tags } from "@lezer/highlight";

export const highlighting = HighlightStyle.define([
  { tag: tags.propertyName, color: "var(--accent)" },
  { tag: tags.string, color: "var(--good)" },
  { tag: [tags.bool, tags.null], color: "var(--warn)" },
]);

// The marks of faults are characters and wavy lines: those of the library are images that the page's policy forbids.
const signs = [["error", "✕", "var(--danger)"], ["warning", "!", "var(--warn)"]];
const marks = signs.map(([severity, sign, color]) => ({
  [`.cm-lintRange-${severity}`]: { backgroundImage: "none", textDecoration: `underline wavy ${color}` },
  [`.cm-lint-marker-${severity}`]: { content: "normal", color, fontWeight: "700", textAlign: "center" },
  [`.cm-lint-marker-${severity}:before`]: { content: `"${sign}"` },
  [`.cm-lintPoint-${severity}:after`]: { borderBottomColor: color },
  [`.cm-diagnostic-${severity}`]: { borderLeftColor: color },
}));

export const theme = EditorView.theme(Object.assign({
  "&": { height: "100%", color: "var(--text)", backgroundColor: "var(--surface)" },
  "&.cm-focused": { outline: "none" }, // the box around it shows the focus
  ".cm-scroller": { font: '0.87rem/1.5 ui-monospace, "SF Mono", "Cascadia Mono", Menlo, "DejaVu Sans Mono", monospace' },
  ".cm-content": { padding: "10px 0", caretColor: "var(--text)" },
  ".cm-gutters": { color: "var(--muted)", backgroundColor: "var(--raised)", borderRight: "1px solid var(--border)" },
  ".cm-activeLineGutter": { color: "var(--text)", backgroundColor: "transparent" },
  ".cm-panels, .cm-tooltip": { color: "var(--text)", backgroundColor: "var(--raised)", borderColor: "var(--border)" },
  ".cm-textfield": { color: "var(--text)", backgroundColor: "var(--surface)", borderColor: "var(--strong-border)" },
  ".cm-button": { color: "var(--text)", background: "var(--surface)", borderColor: "var(--strong-border)" },
  ".cm-selectionMatch, .cm-searchMatch, &.cm-focused .cm-matchingBracket": { backgroundColor: "var(--accent-soft)" },
  ".cm-searchMatch-selected": { backgroundColor: "var(--warn-soft)" },
  "&.cm-focused .cm-nonmatchingBracket": { backgroundColor: "var(--danger-soft)" },
}, ...marks));
