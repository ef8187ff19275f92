// The form: a field for each key of the case that the program's rules describe.

import { asText, asValue, choose, chooseMaterial, fieldNamed, fields, get, libraryValue, set, shown, siValue } from "./content.js";
import { changed } from "./live.js";
import { inWords, remedyButtons } from "./messages.js";
import { drawUpload } from "./scans.js";
import { $, button, element, state } from "./state.js";

// Units that a slider writes, smallest first.
const SLIDER_UNITS = {
  "m": ["pm", "nm", "um", "mm", "m"], "Pa": ["Pa", "kPa", "MPa", "GPa"], "kg/m^3": ["kg/m^3"], "s": ["ns", "us", "ms", "s"],
  "N": ["nN", "uN", "mN", "N"], "J/m^2": ["mJ/m^2", "J/m^2"], "m/s": ["um/s", "mm/s", "m/s"],
};

const idOf = (field) => `field-${field.key.replace(".", "-")}`;
const unfolded = new Map(); // whether a reader has opened a group, by its title
const helped = new Set(); // keys whose help is shown
let cleared = new Map(); // values that the last change of a material has cleared

function fromSlider(field, position) {
  const share = position / 1000;
  let value = field.low + share * (field.high - field.low);
  if (field.logarithmic) value = field.low * (field.high / field.low) ** share;
  if (field.whole) return field.key === "grid.nodes" ? Math.max(8, 8 * Math.round(value / 8)) : Math.round(value);
  if (field.unit === "") return Number(value.toPrecision(3));
  const units = SLIDER_UNITS[field.unit];
  const unit = units.findLast((name) => value >= 0.9995 * state.form.units[field.unit][name]) || units[0];
  return `${Number((value / state.form.units[field.unit][unit]).toPrecision(3))} ${unit}`;
}

function toSlider(field) {
  const value = siValue(field);
  if (value === null) return null;
  const share = field.logarithmic ? Math.log(value / field.low) / Math.log(field.high / field.low) : (value - field.low) / (field.high - field.low);
  return Math.round(1000 * Math.min(1, Math.max(0, share)));
}

export function drawForm() {
  const focused = document.activeElement && document.activeElement.id;
  $("groups").replaceChildren(...state.form.groups.map(drawGroup).filter(Boolean));
  if (focused && $(focused)) $(focused).focus();
  showGrid();
}

// After a change by a button: draw the form, and compute.
export function redraw() { drawForm(); changed(); }

// A group is open at first unless its fields are rarely needed and left out.
function isOpen(group, visible) {
  if (unfolded.has(group.title)) return unfolded.get(group.title);
  return !group.closed || (group.title !== "Unloading and title" && visible.some((field) => get(field.key) !== "" && field.key !== "grid.refine"));
}

function drawGroup(group) {
  const visible = group.fields.filter(shown);
  if (!visible.length) return null;
  const parts = visible.filter((field) => !field.more).map(drawField);
  const rare = visible.filter((field) => field.more);
  if (rare.length) {
    const title = `${group.title}, more`;
    const open = unfolded.has(title) ? unfolded.get(title) : rare.some((field) => get(field.key) !== "");
    const more = element("details", { open }, element("summary", {}, "More"), ...rare.map(drawField));
    more.addEventListener("toggle", () => unfolded.set(title, more.open));
    parts.push(more);
  }
  if (group.title === "Surface") {
    const others = (state.content.roughness || []).length - 1;
    if (others > 0) parts.unshift(element("p", { class: "hint" }, `This case adds the heights of ${others + 1} roughness tables. The fields show the first table; edit the others in the case file below.`));
    parts.push(drawUpload());
  }
  if (group.title === "First particle" && cleared.size) parts.push(drawCleared());
  const verdict = group.title === "Grid" ? [element("span", { id: "grid-verdict", class: "soft" })] : [];
  const made = element("details", { class: "group", open: isOpen(group, visible) }, element("summary", {}, element("span", { class: "title" }, group.title), ...verdict), ...parts);
  made.addEventListener("toggle", () => unfolded.set(group.title, made.open));
  return made;
}

function drawCleared() {
  const words = [...cleared].map(([key, value]) => `${fieldNamed(key) ? fieldNamed(key).label : key} ${asText(value)}`).join(", ");
  const back = button("Put back", () => {
    for (const [key, value] of cleared) set(key, value);
    cleared = new Map();
    redraw();
  });
  return element("p", { class: "warning", id: "cleared", role: "status" }, `Cleared, because typed for the old material: ${words}. `, back);
}

// The grid that the program has chosen, beside the title of its group.
export function showGrid() {
  const { grid, content } = state;
  if (!$("grid-verdict")) return;
  const { nodes, spacing } = { ...grid, ...content.grid };
  const finer = get("grid.refine") === "auto" || (grid && grid.refine === "auto") ? ", refined" : "";
  $("grid-verdict").textContent = nodes && spacing ? `${[nodes].flat().join(" × ")} nodes of ${asText(spacing).replace("um", "µm")}${finer}` : grid ? "the pixels of the scan" : "";
}

function drawField(field) {
  const id = idOf(field);
  const name = element("label", { for: id }, field.label);
  const row = element("div", { class: field.choices.length ? `field wide${field.key.endsWith(".material") || field.key === "second" ? " long" : ""}` : "field", id: `${id}-row` }, element("span", { class: "name" }, name, ...drawHelp(field, id)));
  const box = field.choices.length ? drawChoice(field, id) : drawText(field, id);
  if (field.switch) row.append(drawSwitch(field, id, box));
  else row.append(box);
  const described = [`${id}-problem`];
  if (field.hint) described.push(`${id}-hint`);
  box.setAttribute("aria-describedby", described.join(" "));
  if (field.low !== null && !field.choices.length) row.append(drawSlider(field, id));
  if (field.hint) row.append(element("p", { class: "hint", id: `${id}-hint` }, field.hint));
  row.append(element("p", { class: "hint help-text", id: `${id}-help`, hidden: !helped.has(field.key) }, field.help));
  row.append(element("p", { class: "problem", id: `${id}-problem`, role: "alert", hidden: true }));
  return row;
}

function drawHelp(field, id) {
  if (!field.help) return [];
  const open = helped.has(field.key);
  return [button("?", (event) => {
    const now = $(`${id}-help`).hidden;
    $(`${id}-help`).hidden = !now;
    event.currentTarget.setAttribute("aria-expanded", String(now));
    if (now) helped.add(field.key); else helped.delete(field.key);
  }, { class: "help", "aria-label": `What is ${field.label || "this"}?`, "aria-expanded": String(open), "aria-controls": `${id}-help` })];
}

function drawChoice(field, id) {
  const options = field.choices.map(([value, label]) => element("option", { value }, label));
  const select = element("select", { id }, ...options);
  select.value = String(get(field.key));
  if (select.selectedIndex < 0) { // keep a value that the form does not know
    select.append(element("option", { value: asText(get(field.key)) }, asText(get(field.key))));
    select.value = asText(get(field.key));
  }
  select.title = select.selectedOptions[0] ? select.selectedOptions[0].textContent : "";
  select.addEventListener("change", () => {
    const [name, inner] = field.key.split(".");
    if (inner === "material") cleared = chooseMaterial(name, select.value);
    else choose(field.key, select.value);
    redraw();
  });
  return select;
}

function drawText(field, id) {
  const input = element("input", { id, type: "text", spellcheck: "false" });
  input.value = asText(get(field.key));
  input.placeholder = libraryValue(field) || (field.switch ? "none" : "");
  input.addEventListener("input", () => {
    set(field.key, asValue(field, input.value));
    followed(field, id);
    changed();
  });
  return input;
}

// A switch that sets the key to its initial value, or leaves it out.
function drawSwitch(field, id, box) {
  const on = element("input", { type: "checkbox", id: `${id}-switch`, "aria-label": field.switch });
  on.checked = get(field.key) !== "";
  on.addEventListener("change", () => {
    set(field.key, on.checked ? field.initial : "");
    box.value = asText(get(field.key));
    followed(field, id);
    changed();
  });
  return element("span", { class: "switched" }, on, box);
}

// The slider and the switch follow the field. A field without a value has no slider.
function followed(field, id) {
  if ($(`${id}-slider`)) placeSlider(field, $(`${id}-slider`));
  if ($(`${id}-switch`)) $(`${id}-switch`).checked = get(field.key) !== "";
}

function drawSlider(field, id) {
  const slider = element("input", { id: `${id}-slider`, type: "range", min: 0, max: 1000, step: 1, "aria-label": `${field.label}, slider` });
  placeSlider(field, slider);
  slider.addEventListener("input", () => {
    const value = fromSlider(field, Number(slider.value));
    set(field.key, value);
    $(id).value = asText(value);
    slider.setAttribute("aria-valuetext", asText(value));
    changed();
  });
  return slider;
}

function placeSlider(field, slider) {
  const position = toSlider(field);
  slider.value = position === null ? 500 : position;
  const value = asText(get(field.key)) || libraryValue(field);
  slider.hidden = position === null && !value;
  slider.setAttribute("aria-valuetext", value || "left out");
}

// The field that a message is about. If the message is about a table, this is the first field of the table that the message names.
function fieldOf(key, words) {
  const visible = fields().filter(shown);
  const inside = visible.filter((field) => field.key.startsWith(`${key}.`));
  const named = inside.find((field) => new RegExp(`\\b${field.key.split(".")[1]}\\b`).test(words));
  return visible.find((field) => field.key === key) || named || inside[0];
}

export function showProblems(problems) {
  for (const box of document.querySelectorAll("#groups .problem")) box.hidden = true;
  for (const box of document.querySelectorAll("#groups .field > .remedies, #general-remedies > *")) box.remove();
  for (const box of document.querySelectorAll("#groups [aria-invalid]")) box.removeAttribute("aria-invalid");
  const rest = [];
  for (let [key, words] of Object.entries(problems)) {
    // A message that is about a key of the case starts with this key.
    const own = key ? null : /^([a-z_]+(?:\.[a-z_]+)?): (.*)$/s.exec(words);
    if (own) [, key, words] = own;
    const field = fieldOf(key, words);
    const box = field && $(`${idOf(field)}-problem`);
    if (!box) { rest.push(key ? `${key}: ${words}` : words); continue; }
    box.textContent = inWords(words);
    box.hidden = false;
    box.after(...remedyButtons(words, redraw));
    $(idOf(field)).setAttribute("aria-invalid", "true");
    for (let closed = box.closest("details"); closed; closed = closed.parentElement.closest("details")) closed.open = true;
  }
  $("general").textContent = inWords(rest.join("; "));
  $("general").hidden = !rest.length;
  $("general-remedies").replaceChildren(...remedyButtons(rest.join("; "), redraw));
}

export const showError = (message) => showProblems({ "": message });

export function forgetCleared() { cleared = new Map(); unfolded.clear(); }

