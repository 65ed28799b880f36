// Numbers as people type them, and as they stand in files. The page writes 1,010 and 62.5; a reader of another country may
// type 1.010 and 62,5. A text is read by whichever decimal mark it makes sense with; where both do, "1.010" for one, and the
// country's own mark is the comma, it is refused, as a number that is a thousand times too small would be taken in silence.

const MARKS = [".", ","];

export const usesComma = () => new Intl.NumberFormat(globalThis.navigator?.language).format(0.5).includes(",");

const bare = (text) => text.replace(/[\s'’]/g, "").replace(/^−/, "-");

// With this decimal mark, the other one between groups of three digits; else NaN.
function withMark(text, mark) {
  const [whole, ...rest] = text.split(mark);
  const other = MARKS.find((one) => one !== mark);
  const isGrouped = whole.includes(other);
  if (rest.length > 1 || rest.join("").includes(other) || !/^[+-]?[\d.,]+(?:e[+-]?\d+)?$/i.test(text)) return NaN;
  if (isGrouped && !new RegExp(`^[+-]?[1-9]\\d{0,2}(?:\\${other}\\d{3})+$`).test(whole)) return NaN;
  return Number([isGrouped ? whole.replaceAll(other, "") : whole, ...rest].join("."));
}

// { value, fault }: fault is "" or says what is wrong.
export function readNumber(text, hasComma = usesComma()) {
  const found = [...new Set(MARKS.map((mark) => withMark(bare(text), mark)).filter(Number.isFinite))];
  if (found.length === 0) return { value: NaN, fault: "must be a number" };
  const [value, other] = found;
  if (found.length === 1 || !hasComma) return { value, fault: "" };
  return { value: NaN, fault: `may mean ${value} or ${other}: write ${[value, other].map((one) => writeNumber(one, true)).join(" or ")}` };
}

// Several of them, with spaces or semicolons between: { values, fault }.
export function readNumbers(text, hasComma = usesComma()) {
  const read = text.split(/[;\s]+/).filter(Boolean).map((one) => readNumber(one, hasComma));
  const fault = read.length === 0 ? "must be numbers with spaces between" : (read.find((one) => one.fault !== "")?.fault ?? "");
  return { values: read.map(({ value }) => value), fault };
}

// What is wrong with a number that has these limits, or "".
export function limitFault({ above, least, most }, value) {
  if (above !== undefined && !(value > above)) return `must be greater than ${writeNumber(above)}`;
  if (least !== undefined && value < least) return `must be at least ${writeNumber(least)}`;
  return most !== undefined && value > most ? `must be at most ${writeNumber(most)}` : "";
}

// A text that readNumber() reads as this value.
export function writeNumber(value, hasComma = usesComma()) {
  const text = String(value);
  return hasComma && Number.isFinite(withMark(text, ",")) && text.includes(".") ? `${text}0` : text;
}

// Which decimal mark all these texts make sense with, except those that are no numbers: "." or ","; both where that makes a
// difference, none where they disagree.
export function marksOf(texts) {
  const numbers = texts.map((text) => MARKS.map((mark) => withMark(bare(text), mark))).filter((read) => read.some(Number.isFinite));
  const good = MARKS.filter((_, k) => numbers.every((read) => Number.isFinite(read[k])));
  return good.length === 2 && numbers.every(([dot, comma]) => dot === comma) ? ["."] : good;
}

// The number that a text is with this decimal mark, or NaN.
export function numberWith(text, mark) {
  return withMark(bare(text), mark);
}
