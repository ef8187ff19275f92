// How the page draws the figures of the program: colours, ticks, legend.

import { $, element } from "./state.js";
import { prefix, quantity } from "./units.js";

export const dark = matchMedia("(prefers-color-scheme: dark)");
export const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Colours of the program's figures that the page replaces, so that each has a contrast of at least 3 with the paper.
const COLOURS = {
  light: { "#e69f00": "#b57700", "#56b4e9": "#2f86bd", "#cc79a7": "#b75f91", "#7d858e": "#6a737d", "#8c959f": "#6a737d", "#009e73": "#008560", "#d55e00": "#c35400" },
  dark: { "#0072b2": "#4db2ff", "#d55e00": "#ff8d4d", "#009e73": "#2fcf9f", "#cc79a7": "#e79ac6", "#e69f00": "#f0b429", "#56b4e9": "#7cc7f5", "#7d858e": "#a3adb8", "#8c959f": "#a3adb8", "#000000": "#e6edf3" },
};
// Units of axis titles: their SI unit, and its multiple.
const UNITS = { "m/s": ["m/s", 1], "µm": ["m", 1e-6], "nm": ["m", 1e-9], "N": ["N", 1], "MPa": ["Pa", 1e6] };
const TITLE = /^(.*) \(([^()]*)\)$/;
const BELOW = 65, AROUND = 150; // px: from the axis to the legend below its title, and of a plot beside its axes
const NARROW = 600; // width (px) of a window below which the legend is a list below the plot

export function shown(colour) {
  if (typeof colour !== "string") return colour;
  const map = COLOURS[dark.matches ? "dark" : "light"];
  const faint = /^rgba\((\d+), ?(\d+), ?(\d+), ?([\d.]+)\)$/.exec(colour);
  if (!faint) return map[colour.toLowerCase()] || colour;
  const own = `#${faint.slice(1, 4).map((part) => Number(part).toString(16).padStart(2, "0")).join("")}`;
  return map[own] ? `${map[own]}40` : colour;
}

function recoloured(trace) {
  const made = { ...trace };
  for (const part of ["line", "marker", "error_y"]) if (made[part] && made[part].color) made[part] = { ...made[part], color: shown(made[part].color) };
  if (made.fillcolor) {
    made.fillcolor = shown(made.fillcolor);
    // The edges of a band have the contrast that its faint inside lacks.
    made.line = { ...made.line, width: 1, dash: "dot", color: made.fillcolor.slice(0, 7).startsWith("#") ? made.fillcolor.slice(0, 7) : opaque(made.fillcolor) };
  }
  return made;
}

function opaque(colour) {
  const [, ...parts] = /^rgba\((\d+), ?(\d+), ?(\d+)/.exec(colour);
  return `#${parts.map((part) => Number(part).toString(16).padStart(2, "0")).join("")}`;
}

// The lower edge of a band is the trace before it.
function withEdges(traces) {
  return traces.map((trace, number) => {
    const next = traces[number + 1];
    return next && next.fill === "tonexty" ? { ...trace, line: { ...next.line } } : trace;
  });
}

function themed(layout) {
  const ink = css("--ink"), line = css("--line");
  layout.font = { ...layout.font, color: ink };
  for (const axis of ["xaxis", "yaxis", "yaxis2"]) if (layout[axis]) Object.assign(layout[axis], { gridcolor: line, linecolor: line, zerolinecolor: line });
  if (layout.modebar) layout.modebar = { ...layout.modebar, color: css("--soft"), activecolor: ink };
  return layout;
}

// Ticks with SI prefixes on a logarithmic axis; on a linear one, data in the unit that suits them.
function ticks(layout, traces, name, narrow) {
  const axis = layout[`${name}axis`], title = axis && axis.title && TITLE.exec(axis.title.text || "");
  if (!title || !UNITS[title[2]]) return traces;
  const [unit, factor] = UNITS[title[2]];
  if (axis.type === "log") {
    const [low, high] = axis.range || [-9, 2];
    const steps = high - low > (narrow ? 1 : 2.2) ? [1] : [1, 2, 5];
    const decades = Array.from({ length: Math.ceil(high) - Math.floor(low) + 7 }, (_, k) => Math.floor(low) - 3 + k);
    const values = decades.flatMap((k) => steps.map((digit) => Number(`${digit}e${k}`)));
    axis.title = { ...axis.title, text: title[1] };
    Object.assign(axis, { tickmode: "array", tickvals: values, ticktext: values.map((value) => quantity(value * factor, unit)), minor: { dtick: "D1", showgrid: false, ticks: "outside" } });
    return traces;
  }
  const ends = axis.range || (axis.autorangeoptions ? [axis.autorangeoptions.minallowed, axis.autorangeoptions.maxallowed] : []);
  const values = [...ends, ...traces.flatMap((trace) => Array.from(numbers(trace[name])))].filter(Number.isFinite).map(Math.abs);
  const best = prefix(Math.max(0, ...values) * factor, unit), times = factor / best.scale;
  Object.assign(axis, { title: { ...axis.title, text: `${title[1]} (${best.name})` }, ticksuffix: "", exponentformat: "none" });
  if (times === 1) return traces;
  if (axis.range) axis.range = axis.range.map((end) => end * times);
  const allowed = axis.autorangeoptions;
  if (allowed) axis.autorangeoptions = { minallowed: scaled(allowed.minallowed, times), maxallowed: scaled(allowed.maxallowed, times) };
  for (const shape of layout.shapes) if (shape[`${name}ref`] !== "paper") for (const end of ["0", "1"]) shape[name + end] *= times;
  const pattern = new RegExp(`(%\\{${name}:[^}]*\\}) ${title[2]}`);
  return traces.map((trace) => {
    const hover = trace.hovertemplate && trace.hovertemplate.replace(pattern, `$1 ${best.name}`);
    return { ...trace, [name]: trace[name] && Array.from(numbers(trace[name]), (value) => scaled(value, times)), ...(hover ? { hovertemplate: hover } : {}) };
  });
}

const scaled = (value, times) => (Number.isFinite(value) ? value * times : value);

// The numbers of an array that the program may have sent as text.
export function numbers(values) {
  if (!values || values.bdata === undefined) return values || [];
  const bytes = Uint8Array.from(atob(values.bdata), (one) => one.charCodeAt(0)).buffer;
  const Kind = { f8: Float64Array, f4: Float32Array, i1: Int8Array, u1: Uint8Array, i2: Int16Array, u2: Uint16Array, i4: Int32Array, u4: Uint32Array }[values.dtype];
  return Array.from(new Kind(bytes));
}

// Let an axis with fixed ends include `values`.
function widen(axis, values) {
  const here = axis && axis.type === "log" ? values.filter((value) => value > 0).map(Math.log10) : values.filter(Number.isFinite);
  if (!axis || !here.length) return;
  const allowed = axis.autorangeoptions || {};
  const [first, last] = axis.range || [allowed.minallowed, allowed.maxallowed];
  const margin = 0.03 * (Math.max(...here, last ?? -Infinity) - Math.min(...here, first ?? Infinity));
  const low = first > Math.min(...here) ? Math.min(...here) - margin : first;
  const high = last < Math.max(...here) ? Math.max(...here) + margin : last;
  if (axis.range) axis.range = [low, high];
  else if (axis.autorangeoptions) axis.autorangeoptions = { minallowed: low, maxallowed: high };
}

export function draw(id, spec, more = [], shapes = []) {
  if (!spec) { Plotly.purge($(id)); $(id).dataset.drawn = ""; listed(id, []); return; }
  const layout = themed(structuredClone(spec.layout)), narrow = innerWidth < NARROW;
  layout.shapes = [...(layout.shapes || []), ...shapes].map((shape) => ({ ...shape, line: { ...shape.line, color: shown(shape.line && shape.line.color) } }));
  for (const name of ["x", "y"]) widen(layout[`${name}axis`], more.flatMap((trace) => (trace.meta === "wide" ? Array.from(trace[name]) : [])));
  let traces = withEdges([...spec.data, ...more].map(recoloured));
  if (!traces.some((trace) => trace.type === "heatmap")) for (const name of ["x", "y"]) traces = ticks(layout, traces, name, narrow);
  if (narrow) {
    layout.showlegend = false;
    layout.margin = { l: 55, r: 10, t: 10, b: 42 };
    layout.font.size = 12;
  } else if (layout.legend) layout.legend.y = -BELOW / Math.max(100, $(id).clientHeight - AROUND);
  listed(id, narrow ? traces : []);
  $(id).dataset.drawn = "yes";
  const bar = { modeBarButtons: [["toImage", "zoom2d", "pan2d", "resetScale2d"]], displayModeBar: narrow ? false : "hover", displaylogo: false };
  return Plotly.react($(id), traces, layout, { responsive: true, showSendToCloud: false, ...bar });
}

// The legend as a list below a narrow plot.
function listed(id, traces) {
  const list = $(`${id}-legend`);
  if (!list) return;
  const entries = new Map();
  for (const trace of traces) if (trace.name && trace.showlegend !== false && !entries.has(trace.name)) entries.set(trace.name, trace);
  list.replaceChildren(...[...entries].map(([name, trace]) => element("li", {}, sample(trace), name.replace(/&lt;/g, "<").replace(/&gt;/g, ">").replace(/&amp;/g, "&"))));
}

function sample({ mode = "lines", line = {}, marker = {}, fill, fillcolor }) {
  const made = element("canvas", { width: 48, height: 24, class: "sample", "aria-hidden": "true" }), pen = made.getContext("2d");
  const dashes = { dash: [10, 6], dot: [3, 5], dashdot: [10, 5, 3, 5], longdash: [16, 6] }[line.dash] || (/px/.test(line.dash || "") ? line.dash.split(",").map((part) => 2 * parseFloat(part)) : []);
  if (fill) { pen.fillStyle = fillcolor; pen.fillRect(0, 4, 48, 16); }
  pen.strokeStyle = pen.fillStyle = line.color && mode.includes("lines") ? line.color : [marker.color].flat()[0] || line.color || css("--ink");
  pen.lineWidth = 3;
  if (mode.includes("lines") && line.width !== 0) { pen.setLineDash(dashes); pen.beginPath(); pen.moveTo(0, 12); pen.lineTo(48, 12); pen.stroke(); }
  if (mode.includes("markers")) {
    const symbol = String([marker.symbol].flat()[0]);
    pen.setLineDash([]);
    pen.beginPath();
    if (symbol.startsWith("line-ns")) { pen.moveTo(24, 2); pen.lineTo(24, 22); pen.stroke(); } else {
      pen.arc(24, 12, 6, 0, 7);
      if (symbol.endsWith("-open")) pen.stroke(); else pen.fill();
    }
  }
  return made;
}
