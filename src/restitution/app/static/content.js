// The case as a tree of tables, and its keys.

import { state } from "./state.js";
import { parsed } from "./units.js";

export const TABLES = ["impact", "indentation", "load"];
const KEPT = ["first", "second", ...TABLES]; // tables that stay in the case when all their fields are empty
const OF_GRID = ["nodes", "spacing"];

export function table(name, make) {
  const { content } = state;
  if (name === "roughness") {
    if (make && !(content.roughness || []).length) content.roughness = [{}];
    return (content.roughness || [])[0];
  }
  if (make && content[name] === undefined) content[name] = {};
  return content[name];
}

const ownGrid = () => OF_GRID.some((key) => (state.content.grid || {})[key] !== undefined);

export function get(key) {
  const { content } = state;
  if (key === "depths") return TABLES.find((name) => content[name] !== undefined) || "";
  if (key === "second") return content.second === undefined ? "" : "own";
  if (key === "grid") return ownGrid() ? "own" : "";
  const [name, inner] = key.split(".");
  const value = inner === undefined ? content[name] : (table(name) || {})[inner];
  return value === undefined ? "" : value;
}

export function set(key, value) {
  const { content } = state;
  if (key === "depths") {
    for (const name of TABLES) if (name !== value) delete content[name];
    table(value, true);
  } else if (key === "second") {
    if (!value) delete content.second;
    else if (content.second === undefined) content.second = structuredClone(content.first || {});
  } else if (key === "grid") {
    if (value) content.grid = { ...state.grid, ...content.grid };
    else for (const inner of OF_GRID) set(`grid.${inner}`, "");
  } else if (key === "roughness.kind" && value === "") {
    delete content.roughness;
  } else {
    const [name, inner] = key.split(".");
    const of = inner === undefined ? content : table(name, value !== "");
    if (of === undefined) return;
    if (value === "") delete of[inner === undefined ? name : inner];
    else of[inner === undefined ? name : inner] = value;
    if (inner !== undefined && !Object.keys(of).length && !KEPT.includes(name)) delete content[name];
  }
}

// The case with the grid that the program has chosen for it.
export function whole() {
  const content = structuredClone(state.content);
  if (state.grid && !ownGrid() && Object.keys(state.grid).length) content.grid = { ...state.grid, ...content.grid };
  return content;
}

// The case without its many impacts, which only a job computes.
export function firstImpact() {
  const { impacts, ...rest } = whole();
  return rest;
}

export const fields = () => state.form.groups.flatMap((group) => group.fields);
export const shown = (field) => !field.when.length || field.when.slice(1).includes(get(field.when[0]));
export const fieldNamed = (key) => fields().find((field) => field.key === key && shown(field));

export const lastValues = new Map(); // values that fields had before a choice; a field that appears again gets its old value

// After a choice: remove the keys of fields that vanish; set fields that appear to their last or initial value.
export function settle(before) {
  const now = new Set(fields().filter(shown).map((field) => field.key));
  for (const field of before) if (!now.has(field.key) && !TABLES.includes(field.key.split(".")[0])) set(field.key, "");
  const old = new Set(before.map((field) => field.key));
  const appear = fields().filter((field) => shown(field) && !old.has(field.key));
  for (const field of appear) if (lastValues.has(field.key)) set(field.key, lastValues.get(field.key));
  const listed = ["impact.velocity", "indentation.values", "load.values"].some((key) => get(key) !== "");
  for (const field of appear) {
    if (lastValues.has(field.key)) continue;
    const spans = TABLES.includes(field.key.split(".")[0]) && listed;
    if (field.initial !== null && get(field.key) === "" && !spans) set(field.key, field.initial);
  }
}

// Change the value of a choice, and what follows from it.
export function choose(key, value) {
  const before = fields().filter(shown);
  for (const other of before) if (other.key !== key) lastValues.set(other.key, get(other.key));
  set(key, value);
  settle(before);
}

export function asText(value) { return Array.isArray(value) ? value.join(", ") : String(value); }

export function asValue(field, text) {
  const trimmed = text.trim();
  if (trimmed === "") return "";
  const listed = /\.(values|velocity)$/.test(field.key);
  if (trimmed.includes(",") || listed) return trimmed.split(",").map((part) => single(field, part.trim())).filter((part) => part !== "");
  return single(field, trimmed);
}

function single(field, text) {
  const isNumber = field.unit === "" && /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(text);
  return isNumber && field.key !== "title" && field.key !== "roughness.file" ? Number(text) : text;
}

// The library's value for a key that the case leaves out.
export function libraryValue(field) {
  const [name, inner] = field.key.split(".");
  const material = inner && state.form.library[get(`${name}.material`)];
  return (material && material[inner]) || "";
}

// The value of a field in its SI unit, or null if it is not a single number.
export function siValue(field) {
  let value = get(field.key);
  if (value === "") value = libraryValue(field);
  if (field.unit === "" && value !== "" && !isNaN(value)) return Number(value);
  if (typeof value === "number") return field.unit === "" ? value : null;
  return parsed(value, field.unit);
}

function flat(tables) {
  const values = {};
  for (const [name, value] of Object.entries(tables)) {
    const parts = name === "roughness" && Array.isArray(value) ? value : [value];
    for (const [k, inner] of parts.entries()) {
      const path = k ? `${name} ${k + 1}` : name;
      if (inner !== null && typeof inner === "object" && !Array.isArray(inner)) for (const [key, cell] of Object.entries(inner)) values[`${path}.${key}`] = asText(cell);
      else values[path] = asText(inner);
    }
  }
  return values;
}

export function differences(before, after) {
  const a = flat(before), b = flat(after);
  const keys = [...new Set([...Object.keys(a), ...Object.keys(b)])].filter((key) => a[key] !== b[key]);
  return keys.map((key) => `${key} = ${b[key] === undefined ? "(left out)" : b[key]}`).join(", ") || "the same case";
}

// Keys that belong to a material, and are cleared when another is chosen.
const OF_BODY = ["youngs_modulus", "poissons_ratio", "density", "yield_strength", "hardness", "loss_tangent", "relaxation_time"];
const OF_PAIR = ["yield_strength", "tangent_modulus", "yield_pressure", "work_of_adhesion"];

// Choose the material of a body. Values of the old one are cleared; returns these, by key. Without a material in the
// library, the values of the old one stay.
export function chooseMaterial(name, material) {
  const cleared = new Map();
  const old = state.form.library[get(`${name}.material`)] || {};
  set(`${name}.material`, material);
  if (!material) {
    for (const key of OF_BODY) if (get(`${name}.${key}`) === "" && old[key]) set(`${name}.${key}`, isNaN(old[key]) ? old[key] : Number(old[key]));
    return cleared;
  }
  const keys = [...OF_BODY.map((key) => `${name}.${key}`), ...OF_PAIR.map((key) => `interface.${key}`)];
  for (const key of keys) {
    const value = get(key);
    if (value === "" || value === "library" || value === "elastic" || value === "hardness") continue;
    cleared.set(key, value);
    set(key, "");
  }
  return cleared;
}
