// Numbers with SI prefixes, as the program prints them.

import { state } from "./state.js";

const PREFIXES = { "-5": "f", "-4": "p", "-3": "n", "-2": "µ", "-1": "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T" };
const isNumber = (value) => typeof value === "number" && Number.isFinite(value);

// The power of ten and the prefix with which `value` is written.
export function prefix(value, unit) {
  const least = unit === "m" ? -3 : -5;
  const order = value ? Math.floor(Math.log10(Math.abs(Number(value.toPrecision(4)))) / 3 + 1e-12) : 0;
  const kept = Math.max(least, Math.min(4, order));
  return { scale: 10 ** (3 * kept), name: PREFIXES[kept] + unit };
}

export function quantity(value, unit, figures = 4) {
  if (!isNumber(value)) return "unknown";
  const { scale, name } = prefix(value, unit);
  return `${Number((value / scale).toPrecision(figures))} ${name}`;
}

// A value with its error, to the digits that the error has: "91.6 ± 4.8 mm/s".
export function withError(value, error, unit) {
  if (!isNumber(value)) return "unknown";
  if (!isNumber(error) || error <= 0 || value === 0) return quantity(value, unit, 3);
  const { scale, name } = prefix(value, unit);
  const places = Math.max(0, Math.min(8, 1 - Math.floor(Math.log10(error / scale))));
  return `${(value / scale).toFixed(places)} ± ${(error / scale).toFixed(places)} ${name}`;
}

// The value of a text such as "0.5 m/s" in the SI unit, or null.
export function parsed(text, unit) {
  const match = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(\S.*?)\s*$/i.exec(String(text));
  const factor = match && (state.form.units[unit] || {})[match[2].replace("µ", "u")];
  return factor ? Number(match[1]) * factor : null;
}

export const digits = (value, n = 4) => (value === null || value === undefined ? "–" : typeof value === "boolean" ? (value ? "yes" : "no") : Number(value.toPrecision(n)).toString());

export function duration(seconds) {
  if (seconds < 100) return `${Math.max(1, Math.round(seconds))} s`;
  return seconds < 6000 ? `${Math.round(seconds / 60)} min` : `${Math.round(seconds / 3600)} h`;
}
