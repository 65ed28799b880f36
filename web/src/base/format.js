// Numbers, times and sizes as people read them. The page is in English, and so are its numbers.

const NBSP = " ";
const THIN = " ";

// Bytes of UTF-8, by which the server counts.
export const bytesIn = (text) => new TextEncoder().encode(text).length;

// The whole characters of a text that have so many bytes at most.
export function cut(text, most) {
  const characters = [...text];
  while (bytesIn(characters.join("")) > most) characters.pop();
  return characters.join("");
}

const formats = new Map();

function formatOf(options) {
  const key = JSON.stringify(options);
  if (!formats.has(key)) formats.set(key, new Intl.NumberFormat("en", { signDisplay: "negative", ...options })); // no -0
  return formats.get(key);
}

// Rounded to significant digits, by default 3; null is a dash.
export function number(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e7)) return scientific(value, digits);
  const whole = size >= 10 ** digits;
  return formatOf(whole ? { maximumFractionDigits: 0 } : { maximumSignificantDigits: digits }).format(value);
}

function scientific(value, digits) {
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const raised = [...String(Number(exponent))].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");
  const short = String(Number(mantissa));
  return `${short === "1" ? "" : `${short}${THIN}×${THIN}`}10${raised}`;
}

export function fixed(value, places) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  return formatOf({ minimumFractionDigits: places, maximumFractionDigits: places }).format(value);
}

export function quantity(value, unit, digits = 3) {
  const text = unit === "parts" ? parts(value, digits) : number(value, digits);
  return text === "–" || unit === "" ? text : `${text}${NBSP}${unit}`;
}

const NO_PART = 5e-3; // less is said to be none: what diffuses and what sums of densities leave

// A number of parts, whole or not.
export function parts(n, digits = 4) {
  return number(Math.abs(n) < NO_PART ? 0 : n, digits);
}

export function percent(share, places = 0) {
  return `${fixed(share * 100, places)}${NBSP}%`;
}

// 42 s, 3 min, 2 h 5 min, 4 d.
export function span(seconds) {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return "–";
  if (seconds < 10) return quantity(seconds, "s", seconds < 1 ? 2 : 2);
  if (seconds < 60) return `${Math.round(seconds)}${NBSP}s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 60) return `${minutes}${NBSP}min`;
  if (minutes < 1440) {
    const rest = minutes % 60;
    return `${Math.floor(minutes / 60)}${NBSP}h${rest === 0 ? "" : ` ${rest}${NBSP}min`}`;
  }
  return `${Math.round(minutes / 1440)}${NBSP}d`;
}

const day = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short", year: "numeric", hour: "2-digit", minute: "2-digit" });

// Of the last day how long ago it was, before it the date.
export function age(iso, now = Date.now()) {
  const seconds = (now - Date.parse(iso)) / 1000;
  if (seconds > 86400) return day.format(new Date(iso));
  return seconds < 5 ? "just now" : `${span(seconds < 10 ? 10 * Math.round(seconds / 10) || 5 : seconds)} ago`;
}

const clock = new Intl.DateTimeFormat("en-GB", { dateStyle: "medium", timeStyle: "medium" });

export function moment(iso) {
  return clock.format(new Date(iso));
}

export function bytes(n) {
  const units = ["B", "kB", "MB", "GB"];
  let k = 0;
  for (; n >= 1000 && k < units.length - 1; k++) n /= 1000;
  return quantity(n, units[k]);
}

// What things are called, as the name of a file without its ending: "Example 1, angle 75°" is "example-1-angle-75".
export function fileNameOf(...names) {
  const words = names.flatMap((name) => name.normalize("NFKD").replace(/\p{M}/gu, "").toLowerCase().match(/[\p{L}\p{N}]+(\.[\p{L}\p{N}]+)*/gu) ?? []);
  return words.join("-").slice(0, 100);
}

// How many decimal places distinguish times of this distance.
export function placesOf(step) {
  return Math.min(6, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));
}

// "/obstacles/0/from_m" is "obstacles 1 from".
export function placeOf(pointer) {
  return pointer.slice(1).replace(/\/(\d+)/g, (all, k) => ` ${Number(k) + 1}`).replace(/_(?:m|s|deg|m_s|m2|per_s)(?=\/|$)/g, "")
    .replace(/[/_]/g, " ");
}

// A message of the server with numbers, their signs and places as people read them.
export function readable(text) {
  return text.replace(/(^|[\s'"“(])((?:\/(?!v1\b)[a-z]\w*(?:\/\w+)*))(?=$|[\s'"”),.:;])/g, (all, before, pointer) => before + placeOf(pointer))
    .replace(/-?\d+(?:\.\d+)?e[+-]?\d+\b|-?\d+\.\d{5,}/gi, (digits) => number(Number(digits), 4))
    .replace(/(^|[\s(])-(?=\d)/g, "$1−");
}

// The run's name, or what stands for it.
export function nameOf(run) {
  return run.name || `Run ${run.id.slice(-8)}`;
}

export const models = { macro: "macroscopic", micro: "microscopic" };

// "macroscopic, congested": with the closure, where a run or a summary has one; `names` are the words for the models.
export function modelOf({ model, closure }, names = models) {
  return closure ? `${names[model]}, ${closure}` : names[model];
}

export const modelWords = { macro: "macro", micro: "micro" };
