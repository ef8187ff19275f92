// The plots, maps and tables of the curve that the page shows.

import { isResolved } from "./answer.js";
import { css, draw, numbers } from "./figures.js";
import { previewOf, say } from "./live.js";
import { lostServer, stream, tab } from "./requests.js";
import { $, escaped, fill, state } from "./state.js";
import { digits, quantity, withError } from "./units.js";

const KEYS = { velocity: "impact_velocity_m_per_s", indentation: "max_indentation_m" };
const MODEL = "#8250df", DARK_MODEL = "#c297ff"; // colour of the band of the error of the model
const NEXT = 30; // time (ms) from the curve to the figure below it, so that the browser paints the curve first
let drawingForce = null;
const view = () => document.querySelector("input[name=view]:checked").value;

export const depthNow = () => Math.min(state.cursor === null ? Infinity : state.cursor, state.curve.rows.length - 1);

export function drawCurves() {
  const { curve, pins } = state;
  const what = view() === "velocity" && curve.figures.velocity ? "velocity" : "indentation";
  const key = KEYS[what], scale = what === "velocity" ? 1 : 1e6;
  const at = curve.rows[depthNow()];
  const line = (x) => ({ type: "line", xref: "x", yref: "paper", y0: 0, y1: 1, x0: x, x1: x, line: { color: css("--soft"), width: 1 } });
  const shapes = at && at[key] > 0 ? [line(scale * at[key])] : [];
  const others = [...(curve.under ? [underneath(curve.under)] : []), ...pins];
  const { between } = what === "velocity" ? curve : { between: null };
  const traces = [...modelBand(curve, between, key, scale), ...others.map((other) => pinTrace(other, key, scale, "restitution"))];
  draw("cor", joined(told(opened(curve.figures[what])), between), traces, shapes);
  clearTimeout(drawingForce);
  drawingForce = setTimeout(() => draw("force", told(curve.figures.force), others.map((other) => pinTrace(other, "max_indentation_m", 1e6, "force_N")), at ? [line(1e6 * at.max_indentation_m)] : []), NEXT);
  const cors = curve.rows.map((row) => row.restitution);
  $("cor").setAttribute("aria-label", cors.length
    ? `${curve.preview ? "Preview of the c" : "C"}oefficient of restitution from ${Math.min(...cors).toFixed(3)} to ${Math.max(...cors).toFixed(3)} against ${what === "velocity" ? "impact velocity" : "indentation"}; the numbers are in a table below`
    : "Coefficient of restitution: nothing computed");
  $("cursor").max = Math.max(0, curve.rows.length - 1);
  $("cursor").value = depthNow();
  showCursor();
}

// The figure of a preview: its own curve is dashed, and the legend says what it is.
function told(spec) {
  if (!spec || !state.curve.preview) return spec;
  const name = ({ name: words, mode }) => (mode === "lines+markers" ? escaped(previewOf(state.curve)) : /^total error/.test(words) ? "usual error of such a preview" : words);
  const data = spec.data.map((trace) => ({ ...trace, name: name(trace), ...(trace.mode === "lines+markers" ? { line: { ...trace.line, dash: "dash" } } : {}) }));
  return { ...spec, data };
}

// Markers of points at which the grid does not resolve adhesion are open, too.
function opened(spec) {
  const { rows } = state.curve;
  if (!spec || rows.every((row) => row.adhesion_resolved !== false)) return spec;
  const data = spec.data.map((trace) => {
    if (trace.mode !== "lines+markers" || numbers(trace.x).length !== rows.length) return trace;
    const symbol = [trace.marker.symbol].flat()[0].replace("-open", "");
    return { ...trace, marker: { ...trace.marker, symbol: rows.map((row) => (isResolved(row) ? symbol : `${symbol}-open`)) } };
  });
  return { ...spec, data };
}

// A curve whose points are joined as a law interpolates them, with its jump where the pair begins to rebound.
function joined(spec, between) {
  if (!spec) return spec;
  const data = spec.data.flatMap((trace) => {
    const x = numbers(trace.x);
    if (trace.mode !== "lines+markers" || x.length < 2) return [trace];
    const line = { type: "scatter", mode: "lines", line: trace.line, name: trace.name, showlegend: false, hoverinfo: "skip", ...(between
      ? { x: between.velocity, y: between.quasi_static } : withJump(x, numbers(trace.y))) };
    // The legend shows a marker on a line, but the line between the markers is the other trace.
    const sample = trace.showlegend === false ? [] : [{ ...trace, x: [null], y: [null], error_y: undefined, marker: { ...trace.marker, symbol: String([trace.marker.symbol].flat()[0]).replace("-open", "") } }];
    return [line, { ...trace, mode: "markers", showlegend: false }, ...sample];
  });
  return { ...spec, data };
}

// Where a curve leaves zero, it jumps at the first point that rebounds.
function withJump(x, y) {
  const first = y.findIndex((value) => value > 0);
  if (first < 1 || y[first - 1] !== 0) return { x, y };
  return { x: [...x.slice(0, first), x[first], ...x.slice(first)], y: [...y.slice(0, first), 0, ...y.slice(first)] };
}

const underneath = ({ rows, preview, between }) => ({ rows, between, name: escaped(previewOf({ preview })), colour: css("--soft"), dash: "dash" });

// The band of COR ± the error of the choice of the model.
function modelBand({ rows }, between, key, scale) {
  const known = rows.filter((row) => row[key] > 0);
  if (!known.some((row) => row.model_error > 0)) return [];
  const x = between ? between.velocity : known.map((row) => scale * row[key]);
  const e = between ? between.quasi_static : known.map((row) => row.restitution);
  const model = between ? between.model_error : known.map((row) => row.model_error);
  const edge = (sign) => ({ type: "scatter", mode: "lines", hoverinfo: "skip", meta: "wide", x, y: e.map((value, k) => Math.min(1, Math.max(0, value + sign * model[k]))) });
  const colour = matchMedia("(prefers-color-scheme: dark)").matches ? DARK_MODEL : MODEL;
  return [
    { ...edge(-1), showlegend: false },
    { ...edge(1), fill: "tonexty", fillcolor: `${colour}26`, name: "± error of the model" },
  ];
}

function pinTrace(pin, key, scale, quantityOf) {
  const rows = pin.rows.filter((row) => row[key] > 0);
  const fine = key === KEYS.velocity && quantityOf === "restitution" ? pin.between : null;
  const points = fine ? { x: fine.velocity, y: fine.quasi_static } : withJump(rows.map((row) => scale * row[key]), rows.map((row) => row[quantityOf]));
  return {
    type: "scatter", mode: "lines", name: pin.name, meta: "wide", ...points,
    line: { color: pin.colour, dash: pin.dash, width: 2 }, hovertemplate: `%{x:.4g}<br>%{y:.4g}<extra>${pin.name}</extra>`,
  };
}

export function showCursor() {
  const { curve } = state, row = curve.rows[depthNow()];
  if (!row) { $("cursor-text").textContent = ""; return; }
  const velocity = row.impact_velocity_m_per_s === null ? "" : `${quantity(row.impact_velocity_m_per_s, "m/s")}, `;
  const total = (curve.errors || curve.preview) && row.total_error !== null ? ` ± ${digits(row.total_error, 2)}` : "";
  const words = `${velocity}${quantity(row.max_indentation_m, "m")}, ${quantity(row.force_N, "N")}: COR ${row.restitution.toFixed(4)}${total} (model ± ${digits(row.model_error, 2)})${isResolved(row) ? "" : ", not resolved"}${curve.preview ? " – preview" : ""}`;
  $("cursor-text").textContent = words;
  $("cursor").setAttribute("aria-valuetext", words);
}

let mapping = false, mapAgain = false;

export async function askMaps() {
  if (mapping) { mapAgain = true; return; }
  mapping = true;
  try {
    await stream("maps", { tab, depth: Math.max(0, depthNow()) }, undefined, (line) => {
      if (!line.pressure) return;
      draw("pressure", line.pressure);
      draw("plastic", line.plastic);
      const yields = line.plastic ? `, plastic displacement up to ${quantity(1e-9 * line.largest.plastic_nm, "m")}` : ", no plastic displacement";
      $("maps-text").textContent = `At an indentation of ${quantity(line.indentation_m, "m")}: pressure up to ${quantity(1e6 * line.largest.pressure_MPa, "Pa")}${yields}`;
    });
  } catch (error) {
    say(lostServer(error));
  }
  mapping = false;
  if (mapAgain) { mapAgain = false; askMaps(); }
}

export function drawSurface(line) {
  draw("surface", line.surface);
  fill("statistics", ["parameter", "value"], line.statistics);
}

const SHOWN = {
  impact_velocity_m_per_s: ["velocity", "m/s"], max_indentation_m: ["indentation", "m"], force_N: ["force", "N"], restitution: ["COR", ""],
  restitution_error: ["numerical error", ""], total_error: ["total error", ""], model_error: ["model error", ""], resolved: ["resolved", ""],
};
const ADHESIVE = { adhesion_resolved: ["adhesion resolved", ""], pull_off_force_N: ["pull-off force", "N"] };

export function drawNumbers() {
  const { rows } = state.curve;
  const columns = { ...SHOWN, ...(rows.some((row) => row.pull_off_force_N > 0) ? ADHESIVE : {}) };
  const text = (key, unit, row) => {
    if (key === "pull_off_force_N") return withError(row[key], row.pull_off_error_N, unit);
    return unit && typeof row[key] === "number" ? quantity(row[key], unit) : digits(row[key], key.endsWith("error") ? 2 : 6);
  };
  fill("numbers", Object.values(columns).map(([name]) => name), rows.map((row) => Object.entries(columns).map(([key, [, unit]]) => ({ value: row[key], text: text(key, unit, row) }))));
}
