// Messages of the program in the words of the page, with buttons that apply their remedies.

import { asText, choose, fieldNamed, fields, get, set, shown } from "./content.js";
import { $, button, element, state } from "./state.js";
import { parsed } from "./units.js";

const TABLE = "first|second|interface|roughness|grid|impact|indentation|load|unloading|impacts";
const KEY = new RegExp(`\\b(${TABLE})\\.([a-z_]+)\\b`, "g");
const VALUE = new RegExp(`(?:\\b(${TABLE})\\.)?\\b([a-z_]+) = ("([^"]+)"|\\d+(?:\\.\\d+)?)`, "g");
const EDGE = /grid of (?:about|at least) ([\d.]+ \S+?)(?: x ([\d.]+ \S+?))?(?:[ ,;.]|$)/;

const labelOf = (field) => (field.label || "Roughness").replace(/ \(.*/, "");

// A text with the labels of fields instead of their keys.
export const inWords = (words) => words.replace(KEY, (key) => (fieldNamed(key) ? `“${labelOf(fieldNamed(key))}”` : key));

// What a message recommends: pairs of words and a function that does it.
export function remedies(words) {
  const offers = new Map();
  for (const [, name, inner, raw, text] of words.matchAll(VALUE)) {
    const field = name ? fieldNamed(`${name}.${inner}`) : fields().find((one) => shown(one) && one.key.endsWith(`.${inner}`));
    const value = text === undefined ? Number(raw) : text;
    if (field && asText(get(field.key)) !== String(value)) offers.set(`Set ${labelOf(field)} to ${value}`, () => (field.choices.length ? choose(field.key, value) : set(field.key, value)));
  }
  if (/\brefine\b|finer grid|smaller spacing/.test(words) && ![...offers.keys()].some((key) => key.includes("Refine")) && get("grid.refine") !== "auto") {
    offers.set("Refine where needed", () => set("grid.refine", "auto"));
  }
  const edge = EDGE.exec(words);
  if (edge) offers.set("Use a larger grid", () => enlarge(...[edge[1], edge[2] || edge[1]].map((text) => parsed(text, "m"))));
  if (/work_of_adhesion/.test(words) && /"library"/.test(words)) {
    offers.set("Use the library's value", () => set("interface.work_of_adhesion", "library"));
    offers.set("No adhesion", () => set("interface.work_of_adhesion", "0 J/m^2"));
  }
  return [...offers];
}

function enlarge(...edges) {
  const spacing = asText({ ...state.grid, ...state.content.grid }.spacing || "").split(",")[0];
  const cell = parsed(spacing, "m"), edge = Math.max(...edges);
  if (!cell || !edge) { choose("grid", ""); return; }
  state.content.grid = { ...state.content.grid, nodes: 32 * Math.ceil(edge / cell / 32), spacing };
}

export function remedyButtons(words, apply) {
  const made = remedies(words).map(([label, act]) => button(label, () => { act(); apply(); }));
  return made.length ? [element("span", { class: "remedies" }, ...made)] : [];
}

// Show warnings, each beside the field that it names if this can be seen, or below the curve.
export function showWarnings({ information, warnings }, apply) {
  for (const note of document.querySelectorAll("#groups .warning:not(#cleared)")) note.remove();
  const rest = [];
  for (const words of warnings) {
    const note = element("p", { class: "warning", role: "note" }, inWords(words), ...remedyButtons(words, apply));
    const [key] = words.match(KEY) || [];
    const row = key && fieldNamed(key) && $(`field-${key.replace(".", "-")}-row`);
    if (row && !row.closest("details:not([open])")) row.append(note);
    else rest.push(note);
  }
  if (information) rest.push(element("p", { class: "information", role: "note" }, inWords(information)));
  $("warnings").replaceChildren(...rest);
}
