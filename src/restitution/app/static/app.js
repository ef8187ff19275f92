"use strict";
// The page of `restitution app`. The case is a tree of tables, as in a case file; fields of the form
// show its keys. Each change requests a new curve, which may begin with previews. If no change
// follows, the complete run is requested.

const token = location.hash.slice(1);
const tab = crypto.randomUUID();
const $ = (id) => document.getElementById(id);
// Time (ms) without a change after which the smooth curve and the surface are requested.
const SHORT_REST = 100;
// Time (ms) without a change after which the complete run is requested.
const REST = 600;
// Time (ms) after which curves that do not belong to the values in the form are drawn faint.
const FAINT = 400;
// Time (ms) after which the page tells how long it has been computing.
const LONG = 3000;
const DASHES = ["dash", "dot", "dashdot", "longdash", "solid"];
const PIN_COLOURS = ["#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#d55e00"];
// Units that a slider writes, smallest first.
const SLIDER_UNITS = {
  "m": ["pm", "nm", "um", "mm", "m"], "Pa": ["Pa", "kPa", "MPa", "GPa"], "kg/m^3": ["kg/m^3"],
  "N": ["nN", "uN", "mN", "N"], "J/m^2": ["mJ/m^2", "J/m^2"], "m/s": ["um/s", "mm/s", "m/s"],
};

let form = null;
let content = {};
// The curve that is drawn. `preview` says in words what a preview leaves out. While the curve of the case replaces a
// preview, from its shallow end, `under` is the preview below it.
let curve = { rows: [], figures: {}, errors: false, preview: "", under: null };
let cursor = null; // index of the depth at the cursor; null: the deepest depth
let pins = [];
let surfaceKey = "";

// ---- requests ---------------------------------------------------------------------------------

async function post(name, values, signal) {
  const response = await fetch(`api/${name}`, {
    method: "POST", signal, body: JSON.stringify(values),
    headers: { "Content-Type": "application/json", "X-Token": token },
  });
  if (!response.ok) throw new Error((await response.text()) || `request refused (${response.status})`);
  return response;
}

async function stream(name, values, signal, take) {
  const response = await post(name, values, signal);
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  for (let rest = ""; ;) {
    const { value, done } = await reader.read();
    if (done) return;
    const lines = (rest + value).split("\n");
    rest = lines.pop();
    for (const line of lines) take(JSON.parse(line));
  }
}

let saying = null; // timer of the time beside the status

// Show `words` as the status and, while the page is `busy` with one request (an object), the time since its beginning.
function say(words, busy) {
  $("status").textContent = words;
  clearInterval(saying);
  $("elapsed").textContent = "";
  if (!busy) return;
  const tell = () => {
    const time = performance.now() - busy.since;
    if (time > LONG) $("elapsed").textContent = `${Math.round(time / 1000)} s`;
  };
  tell();
  saying = setInterval(tell, 1000);
}

// ---- the tree of tables -----------------------------------------------------------------------

const TABLES = ["indentation", "impact", "load"];
const KEPT = ["first", "second", ...TABLES]; // tables that stay in the case when all their fields are empty

function table(name, make) {
  if (name === "roughness") {
    if (make && !(content.roughness || []).length) content.roughness = [{}];
    return (content.roughness || [])[0];
  }
  if (make && content[name] === undefined) content[name] = {};
  return content[name];
}

function get(key) {
  if (key === "depths") return TABLES.find((name) => content[name] !== undefined) || "";
  if (key === "second") return content.second === undefined ? "" : "own";
  const [name, inner] = key.split(".");
  const value = inner === undefined ? content[name] : (table(name) || {})[inner];
  return value === undefined ? "" : value;
}

function set(key, value) {
  if (key === "depths") {
    for (const name of TABLES) if (name !== value) delete content[name];
    table(value, true);
  } else if (key === "second") {
    if (!value) delete content.second;
    else if (content.second === undefined) content.second = structuredClone(content.first || {});
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

const fields = () => form.groups.flatMap((group) => group.fields);
const shown = (field) => !field.when.length || field.when.slice(1).includes(get(field.when[0]));

const lastValues = new Map(); // values that fields had before a choice; a field that appears again gets its old value

// After a choice: remove the keys of fields that vanish; set fields that appear to their last or initial value.
function settle(before) {
  const now = new Set(fields().filter(shown).map((field) => field.key));
  for (const field of before) if (!now.has(field.key) && !TABLES.includes(field.key.split(".")[0])) set(field.key, "");
  const old = new Set(before.map((field) => field.key));
  for (const field of fields().filter(shown)) if (!old.has(field.key) && lastValues.has(field.key)) set(field.key, lastValues.get(field.key));
  const listed = ["impact.velocity", "indentation.values", "load.values"].some((key) => get(key) !== "");
  for (const field of fields().filter(shown)) {
    if (lastValues.has(field.key)) continue;
    const spans = TABLES.includes(field.key.split(".")[0]) && listed;
    if (!old.has(field.key) && field.initial !== null && get(field.key) === "" && !spans) set(field.key, field.initial);
  }
}

// ---- texts and values of fields ---------------------------------------------------------------

function asText(value) { return Array.isArray(value) ? value.join(", ") : String(value); }

function asValue(field, text) {
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
function libraryValue(field) {
  const [name, inner] = field.key.split(".");
  const material = inner && form.library[get(`${name}.material`)];
  return (material && material[inner]) || "";
}

// The value of a field in its SI unit, or null if it is not a single number.
function siValue(field) {
  let value = get(field.key);
  if (value === "") value = libraryValue(field);
  if (field.unit === "" && value !== "" && !isNaN(value)) return Number(value);
  if (typeof value === "number") return field.unit === "" ? value : null;
  const match = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(\S.*?)\s*$/i.exec(String(value));
  const factor = match && (form.units[field.unit] || {})[match[2]];
  return factor ? Number(match[1]) * factor : null;
}

function fromSlider(field, position) {
  const share = position / 1000;
  let value = field.low + share * (field.high - field.low);
  if (field.logarithmic) value = field.low * (field.high / field.low) ** share;
  if (field.whole) return field.key === "grid.nodes" ? Math.max(8, 8 * Math.round(value / 8)) : Math.round(value);
  if (field.unit === "") return Number(value.toPrecision(3));
  const units = SLIDER_UNITS[field.unit];
  const unit = units.findLast((name) => value >= 0.9995 * form.units[field.unit][name]) || units[0];
  return `${Number((value / form.units[field.unit][unit]).toPrecision(3))} ${unit}`;
}

function toSlider(field) {
  const value = siValue(field);
  if (value === null) return null;
  const share = field.logarithmic ? Math.log(value / field.low) / Math.log(field.high / field.low) : (value - field.low) / (field.high - field.low);
  return Math.round(1000 * Math.min(1, Math.max(0, share)));
}

// ---- the form ---------------------------------------------------------------------------------

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === true) made.setAttribute(key, "");
    else if (value !== null && value !== false) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

const idOf = (field) => `field-${field.key.replace(".", "-")}`;

function drawForm() {
  const focused = document.activeElement && document.activeElement.id;
  $("groups").replaceChildren(...form.groups.map(drawGroup).filter(Boolean));
  if (focused && $(focused)) $(focused).focus();
}

const opened = new Set(); // titles of groups whose fields under “More” are shown

function drawGroup(group) {
  const visible = group.fields.filter(shown);
  if (!visible.length) return null;
  const parts = visible.filter((field) => !field.more).map(drawField);
  const rare = visible.filter((field) => field.more);
  if (rare.length) {
    const open = opened.has(group.title) || rare.some((field) => get(field.key) !== "");
    const more = element("details", { open }, element("summary", {}, "More"), ...rare.map(drawField));
    more.addEventListener("toggle", () => (more.open ? opened.add(group.title) : opened.delete(group.title)));
    parts.push(more);
  }
  if (group.title === "Surface") {
    const others = (content.roughness || []).length - 1;
    if (others > 0) parts.unshift(element("p", { class: "hint" }, `This case adds the heights of ${others + 1} roughness tables. The fields show the first table; edit the others in the case file below.`));
    parts.push(drawUpload());
  }
  if (!group.closed) return element("fieldset", {}, element("legend", {}, group.title), ...parts);
  const inner = element("details", {}, element("summary", {}, group.title), ...parts);
  return element("fieldset", {}, inner);
}

function drawField(field) {
  const id = idOf(field);
  const row = element("div", { class: field.choices.length ? "field wide" : "field", id: `${id}-row` }, element("label", { for: id }, field.label));
  const box = field.choices.length ? drawChoice(field, id) : drawText(field, id);
  row.append(box);
  const described = [`${id}-problem`];
  if (field.hint) described.push(`${id}-hint`);
  box.setAttribute("aria-describedby", described.join(" "));
  if (field.low !== null && !field.choices.length) row.append(drawSlider(field, id));
  if (field.hint) row.append(element("p", { class: "hint", id: `${id}-hint` }, field.hint));
  row.append(element("p", { class: "problem", id: `${id}-problem`, role: "alert", hidden: true }));
  return row;
}

function drawChoice(field, id) {
  const options = field.choices.map(([value, label]) => element("option", { value }, label));
  const select = element("select", { id }, ...options);
  select.value = String(get(field.key));
  if (select.selectedIndex < 0) { // keep a value that the form does not know
    select.append(element("option", { value: asText(get(field.key)) }, asText(get(field.key))));
    select.value = asText(get(field.key));
  }
  select.addEventListener("change", () => {
    const before = fields().filter(shown);
    for (const other of before) if (other.key !== field.key) lastValues.set(other.key, get(other.key));
    set(field.key, select.value);
    settle(before);
    drawForm();
    changed();
  });
  return select;
}

function drawText(field, id) {
  const input = element("input", { id, type: "text", spellcheck: "false" });
  input.value = asText(get(field.key));
  input.placeholder = libraryValue(field);
  input.addEventListener("input", () => {
    set(field.key, asValue(field, input.value));
    const slider = $(`${id}-slider`);
    if (slider) placeSlider(field, slider);
    changed();
  });
  return input;
}

function drawSlider(field, id) {
  const slider = element("input", { id: `${id}-slider`, type: "range", min: 0, max: 1000, step: 1, "aria-label": `${field.label}, slider` });
  placeSlider(field, slider);
  slider.addEventListener("input", () => {
    const value = fromSlider(field, Number(slider.value));
    set(field.key, value);
    $(id).value = asText(value);
    slider.classList.remove("unset");
    slider.setAttribute("aria-valuetext", asText(value));
    changed();
  });
  return slider;
}

function placeSlider(field, slider) {
  const position = toSlider(field);
  slider.value = position === null ? 500 : position;
  const value = asText(get(field.key)) || libraryValue(field);
  slider.classList.toggle("unset", !value);
  slider.setAttribute("aria-valuetext", value || "left out");
}

// The field that a message is about. If the message is about a table, this is the first field of the table that the message names.
function fieldOf(key, words) {
  const visible = fields().filter(shown);
  const inside = visible.filter((field) => field.key.startsWith(`${key}.`));
  const named = inside.find((field) => new RegExp(`\\b${field.key.split(".")[1]}\\b`).test(words));
  return visible.find((field) => field.key === key) || named || inside[0];
}

function showProblems(problems) {
  for (const box of document.querySelectorAll("#groups .problem")) box.hidden = true;
  for (const box of document.querySelectorAll("#groups [aria-invalid]")) box.removeAttribute("aria-invalid");
  const rest = [];
  for (let [key, words] of Object.entries(problems)) {
    // A message that is about a key of the case starts with this key.
    const own = key ? null : /^([a-z_]+(?:\.[a-z_]+)?): (.*)$/s.exec(words);
    if (own) [, key, words] = own;
    const field = fieldOf(key, words);
    const box = field && $(`${idOf(field)}-problem`);
    if (!box) { rest.push(key ? `${key}: ${words}` : words); continue; }
    box.textContent = words;
    box.hidden = false;
    $(idOf(field)).setAttribute("aria-invalid", "true");
    const closed = box.closest("details");
    if (closed) closed.open = true;
  }
  $("general").textContent = rest.join("; ");
  $("general").hidden = !rest.length;
}

const showError = (message) => showProblems({ "": message });

// ---- the curve while values change ------------------------------------------------------------

let asking = null; // the request under way: { abort, since, drawn }
let waiting = null; // timer of a change that waits for the request under way
let last = 300; // time (ms) that the last curve took
let resting = null; // timer that ends if no value changes for a while
let running = null; // the request under way for the smooth curve and the surface, or for the complete run

function changed() {
  clearTimeout(resting);
  if (running) running.abort();
  running = null;
  if (waiting) return;
  // If the curve under way will soon be complete, wait for it; otherwise request a new curve at once.
  const patience = asking && !asking.drawn ? Math.min(2000, Math.max(500, 2 * last)) - (performance.now() - asking.since) : 0;
  if (patience > 0) waiting = setTimeout(ask, patience);
  else ask();
}

// Draw curves faint if they no longer belong to the values in the form.
function mark(stale) {
  for (const id of ["cor", "force", "pressure", "plastic"]) $(id).classList.toggle("stale", stale);
}

async function ask() {
  clearTimeout(waiting);
  waiting = null;
  if (asking) asking.abort.abort();
  const mine = { abort: new AbortController(), since: performance.now(), drawn: false };
  asking = mine;
  say("computing…", mine);
  setTimeout(() => { if (asking === mine && !mine.drawn) mark(true); }, FAINT);
  let failed = false, whole = false;
  const sent = structuredClone(content);
  try {
    await stream("curve", { tab, content: sent }, mine.abort.signal, (line) => {
      if (asking !== mine) return;
      if (line.problems) { failed = true; mark(true); showProblems(line.problems); say("not computed: correct the marked value"); }
      else if (line.error) { failed = true; mark(true); showError(line.error); say(line.lost ? "stopped" : "not computed"); }
      else if (line.next) say(`${previewOf(curve)}; next: ${line.next} (${line.progress})`, mine);
      else if (line.curve) {
        const received = performance.now();
        takeCurve(line, sent, mine);
        if (!mine.drawn) last = performance.now() - mine.since;
        mine.drawn = true;
        whole = line.seconds !== undefined;
        record(mine.since, line, received);
        if (waiting) ask();
      }
    });
  } catch (error) {
    if (error.name !== "AbortError") { failed = true; say(lostServer(error)); }
  }
  if (asking !== mine) return;
  asking = null;
  updateText();
  if (!failed && whole && !waiting) resting = setTimeout(drawSmooth, SHORT_REST);
}

// Report to the benchmark when a curve was requested, received and drawn, and how long the solve took (ms).
function record(start, line, received) {
  const detail = { asked: start, solve: 1000 * line.spent, received, drawn: performance.now(), preview: line.preview || "", partial: Boolean(line.progress) };
  document.dispatchEvent(new CustomEvent("curve", { detail }));
}

const previewOf = ({ preview }) => `preview: ${preview}`;

function takeCurve(line, sent, request) {
  showProblems(line.failure ? problemsOf(line.failure) : {});
  const before = curve.preview ? curve : curve.under;
  const under = line.progress && !line.preview && before && before.request === request ? before : null;
  curve = { rows: line.curve, figures: line.figures, errors: false, content: sent, preview: line.preview || "", under, request };
  mark(false);
  showWarnings(line);
  drawCurves();
  drawNumbers();
  if (curve.preview) say(`${previewOf(curve)}${line.progress ? ` (${line.progress})` : ""}; refining…`, request);
  else if (line.progress) say(`${line.progress}${under ? `; the rest is a ${previewOf(under)}` : ""}`, request);
  else say(`${line.curve.length} depths in ${line.seconds.toFixed(2)} s`);
}

const problemsOf = (failure) => ({ "": `Some depths are missing. ${failure}` });

async function drawSmooth() {
  askMaps();
  const mine = new AbortController();
  running = mine;
  try {
    await stream("smooth", { tab, shown: surfaceKey }, mine.signal, (line) => {
      if (running !== mine || asking) return;
      if (line.figures) { curve.figures = line.figures; drawCurves(); }
      else if (line.surface) { surfaceKey = line.surface_key; drawSurface(line); }
    });
  } catch (error) {
    if (error.name !== "AbortError") say(lostServer(error));
  }
  if (running === mine) resting = setTimeout(runWhole, REST - SHORT_REST);
}

async function runWhole() {
  const mine = new AbortController();
  running = mine;
  const sent = structuredClone(content), busy = { since: performance.now() };
  say("computing the errors…", busy);
  try {
    await stream("run", { tab, content: firstImpact(), grids: 1 }, mine.signal, (line) => {
      if (running !== mine || asking) return;
      if (line.progress) say(`computing the errors: ${line.progress}`, busy);
      else if (line.problems) showProblems(line.problems);
      else if (line.error) { showError(line.error); say("the errors are unknown"); }
      else if (line.results) {
        curve = { rows: line.results, figures: line.figures, errors: true, content: sent, preview: "", under: null };
        if (line.failure) showProblems(problemsOf(line.failure));
        showWarnings(line);
        drawCurves();
        drawNumbers();
        say(`complete in ${line.seconds.toFixed(1)} s${line.includes ? `; the total error includes ${line.includes}` : ""}`);
      }
    });
  } catch (error) {
    if (error.name !== "AbortError") say(lostServer(error));
  }
  if (running === mine) running = null;
}

const lostServer = (error) => (error instanceof TypeError ? "the program does not answer: start restitution app again" : error.message);

// ---- drawing ----------------------------------------------------------------------------------

const dark = matchMedia("(prefers-color-scheme: dark)");
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const view = () => document.querySelector("input[name=view]:checked").value;

function themed(layout) {
  const ink = css("--ink"), line = css("--line");
  layout.font = { ...layout.font, color: ink };
  for (const axis of ["xaxis", "yaxis", "yaxis2"]) if (layout[axis]) Object.assign(layout[axis], { gridcolor: line, linecolor: line, zerolinecolor: line });
  return layout;
}

function draw(id, spec, traces = [], shapes = []) {
  if (!spec) { Plotly.purge($(id)); $(id).dataset.drawn = ""; return; }
  const layout = themed(structuredClone(spec.layout));
  layout.shapes = [...(layout.shapes || []), ...shapes];
  for (const name of ["x", "y"]) widen(layout[`${name}axis`], traces.flatMap((trace) => (trace.meta === "wide" ? trace[name] : [])));
  if (innerWidth < 600 || $(id).clientHeight < 300) { // the legend would leave no room for the plot
    layout.showlegend = false;
    layout.margin = { l: 55, r: 10, t: 15, b: 45 };
  }
  $(id).dataset.drawn = "yes";
  return Plotly.react($(id), [...spec.data, ...traces], layout, { responsive: true, displaylogo: false, showSendToCloud: false });
}

// Let an axis with fixed ends include `values`.
function widen(axis, values) {
  const at = axis && axis.type === "log" ? values.filter((value) => value > 0).map(Math.log10) : values.filter(Number.isFinite);
  if (!axis || !at.length) return;
  const allowed = axis.autorangeoptions || {};
  const [first, last] = axis.range || [allowed.minallowed, allowed.maxallowed];
  const margin = 0.03 * (Math.max(...at, last ?? -Infinity) - Math.min(...at, first ?? Infinity));
  const low = first > Math.min(...at) ? Math.min(...at) - margin : first;
  const high = last < Math.max(...at) ? Math.max(...at) + margin : last;
  if (axis.range) axis.range = [low, high];
  else if (axis.autorangeoptions) axis.autorangeoptions = { minallowed: low, maxallowed: high };
}

const depthNow = () => Math.min(cursor === null ? Infinity : cursor, curve.rows.length - 1);
const KEYS = { velocity: "impact_velocity_m_per_s", indentation: "max_indentation_m" };

function drawCurves() {
  const what = view() === "velocity" && curve.figures.velocity ? "velocity" : "indentation";
  const scale = what === "velocity" ? 1 : 1e6;
  const at = curve.rows[depthNow()];
  const line = (x) => ({ type: "line", yref: "paper", y0: 0, y1: 1, x0: x, x1: x, line: { color: css("--soft"), width: 1 } });
  const shapes = at && at[KEYS[what]] > 0 ? [line(scale * at[KEYS[what]])] : [];
  const others = [...(curve.under ? [underneath(curve.under)] : []), ...pins];
  const traces = [...modelBand(KEYS[what], scale), ...others.map((other) => pinTrace(other, KEYS[what], scale, "restitution"))];
  draw("cor", told(curve.figures[what]), traces, shapes);
  draw("force", told(curve.figures.force), others.map((other) => pinTrace(other, "max_indentation_m", 1e6, "force_N")), at ? [line(1e6 * at.max_indentation_m)] : []);
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
  if (!spec || !curve.preview) return spec;
  const data = spec.data.map((trace) => (trace.mode === "lines+markers"
    ? { ...trace, name: escaped(previewOf(curve)), line: { ...trace.line, dash: "dash" } } : trace));
  return { ...spec, data };
}

const underneath = ({ rows, preview }) => ({ rows, name: escaped(previewOf({ preview })), colour: css("--soft"), dash: "dash" });

// The band of COR ± the error of the plasticity model. The live curve has this error, but no total error.
function modelBand(key, scale) {
  const rows = curve.rows.filter((row) => row[key] > 0);
  const edge = (sign) => ({
    type: "scatter", mode: "lines", line: { width: 0 }, hoverinfo: "skip", x: rows.map((row) => scale * row[key]),
    y: rows.map((row) => Math.min(1, Math.max(0, row.restitution + sign * row.model_error))),
  });
  if (!rows.some((row) => row.model_error > 0)) return [];
  return [
    { ...edge(-1), showlegend: false },
    { ...edge(1), fill: "tonexty", fillcolor: "rgba(0,114,178,0.15)", name: "± error of the model" },
  ];
}

function pinTrace(pin, key, scale, quantity) {
  const rows = pin.rows.filter((row) => row[key] > 0);
  return {
    type: "scatter", mode: "lines", name: pin.name, meta: "wide", x: rows.map((row) => scale * row[key]), y: rows.map((row) => row[quantity]),
    line: { color: pin.colour, dash: pin.dash, width: 2 }, hovertemplate: `%{x:.4g}<br>%{y:.4g}<extra>${pin.name}</extra>`,
  };
}

const escaped = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
const digits = (value, n = 4) => (value === null || value === undefined ? "–" : typeof value === "boolean" ? (value ? "yes" : "no") : Number(value.toPrecision(n)).toString());

function showCursor() {
  const row = curve.rows[depthNow()];
  if (!row) { $("cursor-text").textContent = ""; return; }
  const velocity = row.impact_velocity_m_per_s === null ? "" : `${digits(row.impact_velocity_m_per_s)} m/s, `;
  const total = curve.errors && row.total_error !== null ? ` ± ${digits(row.total_error, 2)}` : "";
  const words = `${velocity}${digits(1e9 * row.max_indentation_m)} nm, ${digits(row.force_N)} N: COR ${row.restitution.toFixed(4)}${total} (model ± ${digits(row.model_error, 2)})${row.resolved ? "" : ", not resolved"}${curve.preview ? " – preview" : ""}`;
  $("cursor-text").textContent = words;
  $("cursor").setAttribute("aria-valuetext", words);
}

let mapping = false, mapAgain = false;

async function askMaps() {
  if (mapping) { mapAgain = true; return; }
  mapping = true;
  try {
    await stream("maps", { tab, depth: Math.max(0, depthNow()) }, undefined, (line) => {
      if (!line.pressure) return;
      draw("pressure", line.pressure);
      draw("plastic", line.plastic);
      const yields = line.plastic ? `, plastic displacement up to ${digits(line.largest.plastic_nm)} nm` : ", no plastic displacement";
      $("maps-text").textContent = `At an indentation of ${digits(1e9 * line.indentation_m)} nm: pressure up to ${digits(line.largest.pressure_MPa)} MPa${yields}`;
    });
  } catch (error) {
    say(lostServer(error));
  }
  mapping = false;
  if (mapAgain) { mapAgain = false; askMaps(); }
}

function drawSurface(line) {
  draw("surface", line.surface);
  fill("statistics", ["parameter", "value"], line.statistics);
}

function fill(id, names, rows) {
  const head = element("thead", {}, element("tr", {}, ...names.map((name) => element("th", { scope: "col" }, name))));
  const body = element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map((cell) =>
    cell instanceof Node ? element("td", {}, cell) : element("td", /^[-\d.e+]+$/.test(cell) ? { class: "number" } : {}, cell)))));
  $(id).replaceChildren(head, body);
}

const SHOWN = { impact_velocity_m_per_s: "velocity (m/s)", max_indentation_m: "indentation (m)", force_N: "force (N)", restitution: "COR", restitution_error: "numerical error", total_error: "total error", model_error: "model error", resolved: "resolved" };

function drawNumbers() {
  const keys = Object.keys(SHOWN);
  fill("numbers", Object.values(SHOWN), curve.rows.map((row) => keys.map((key) => digits(row[key], key.endsWith("error") ? 2 : 6))));
}

function showWarnings({ information, warnings }) {
  const notes = warnings.map((words) => element("p", { class: "warning", role: "note" }, words));
  if (information) notes.push(element("p", { class: "information", role: "note" }, information));
  $("warnings").replaceChildren(...notes);
}

// ---- pins -------------------------------------------------------------------------------------

function pin() {
  if (!curve.rows.length || !curve.content) return;
  const number = pins.length ? Math.max(...pins.map((pin) => pin.number)) + 1 : 1;
  const before = pins.length ? pins[pins.length - 1].content : null;
  pins.push({
    number, name: `pin ${number}`, rows: curve.rows, content: structuredClone(curve.content),
    words: (before ? differences(before, curve.content) : "the first pin") + (curve.preview ? `; ${previewOf(curve)}` : ""),
    colour: PIN_COLOURS[(number - 1) % PIN_COLOURS.length], dash: DASHES[(number - 1) % DASHES.length],
  });
  drawPins();
  drawCurves();
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

function differences(before, after) {
  const a = flat(before), b = flat(after);
  const keys = [...new Set([...Object.keys(a), ...Object.keys(b)])].filter((key) => a[key] !== b[key]);
  return keys.map((key) => `${key} = ${b[key] === undefined ? "(left out)" : b[key]}`).join(", ") || "the same case";
}

function drawPins() {
  $("no-pins").hidden = pins.length > 0;
  if (!pins.length) { $("pins").replaceChildren(); return; }
  fill("pins", ["curve", "changes from the previous pin", "COR, first to last", ""], pins.map((pin) => {
    const swatch = element("span", { class: "swatch" });
    swatch.style.background = pin.colour;
    const back = element("button", { type: "button" }, "Restore its values");
    back.addEventListener("click", () => { content = structuredClone(pin.content); drawForm(); changed(); });
    const remove = element("button", { type: "button", "aria-label": `Remove ${pin.name}` }, "Remove");
    remove.addEventListener("click", () => { pins = pins.filter((other) => other !== pin); drawPins(); drawCurves(); });
    const first = pin.rows[0].restitution, end = pin.rows[pin.rows.length - 1].restitution;
    return [element("span", {}, swatch, pin.name), pin.words, `${first.toFixed(4)} to ${end.toFixed(4)}`, element("span", {}, back, " ", remove)];
  }));
}

// ---- scans ------------------------------------------------------------------------------------

function drawUpload() {
  const input = element("input", { type: "file", id: "scan", "aria-label": "Scan from a file" });
  input.addEventListener("change", () => { if (input.files[0]) upload(input.files[0]); });
  return element("div", { class: "field wide" }, element("label", { for: "scan" }, "Read a scan, or drop it onto the page"), input);
}

async function upload(file) {
  say(`reading ${file.name}…`);
  let scan;
  try {
    const response = await fetch("api/upload", {
      method: "POST", body: file,
      headers: { "Content-Type": "application/octet-stream", "X-Token": token, "X-Tab": tab, "X-File-Name": encodeURIComponent(file.name) },
    });
    if (!response.ok) throw new Error(await response.text());
    scan = await response.json();
  } catch (error) {
    showProblems({ "roughness.file": error.message, "": get("roughness.kind") === "measured" ? "" : error.message });
    say("the scan was not read");
    return;
  }
  if (scan.error) { showProblems({ "": `${file.name}: ${scan.error}` }); say("the scan was not read"); return; }
  const before = fields().filter(shown);
  const seeds = { ...(table("roughness") || {}) };
  content.roughness = [{ kind: "measured", file: scan.name }];
  if (seeds.detrend) content.roughness[0].detrend = seeds.detrend;
  settle(before);
  if (scan.nodes && scan.nodes[0] * scan.nodes[1] <= 1.1e6) delete content.grid; // the pixels of the scan are the grid
  else if (scan.nodes) content.grid = { nodes: 512, spacing: `${Number((1e9 * Math.max(...scan.spacing_m)).toPrecision(4))} nm` };
  drawForm();
  if (scan.needs_size) showProblems({ "roughness.size": `${scan.needs_size}; give its edge lengths, such as 10 um, 10 um` });
  if (scan.needs_height_unit) showProblems({ "roughness.height_unit": `${scan.needs_height_unit}; choose the unit of the heights` });
  changed();
}

// ---- the case as a file, finer runs, files to download ----------------------------------------

let textEdited = false; // the user has edited the text, but not pressed “Use this text” yet

// While this is true, the text is not replaced, because the user's changes or selection would be lost.
const editsText = () => textEdited || document.activeElement === $("case-text");

async function updateText() {
  if (!$("case-file").open || editsText()) return;
  try {
    const file = await (await post("text", { content })).json();
    if (!editsText()) $("case-text").value = file.text;
  } catch (error) { $("text-problem").textContent = error.message; }
}

async function useText() {
  let answer;
  try {
    answer = await (await post("content", { text: $("case-text").value })).json();
  } catch (error) { answer = { error: lostServer(error) }; }
  $("text-problem").hidden = !answer.error;
  $("text-problem").textContent = answer.error || "";
  if (answer.error) return;
  textEdited = false;
  content = answer.content;
  lastValues.clear();
  drawForm();
  changed();
}

// The case without its many impacts, which only a job computes.
function firstImpact() {
  const { impacts, ...rest } = structuredClone(content);
  return rest;
}

// Runs in the background, by the id of their button.
const JOBS = {
  finer: {
    values: () => ({ content: firstImpact(), grids: Number($("grids").value) }),
    figure: (line) => line.figures.velocity || line.figures.indentation,
    words: (line) => {
      const worst = Math.max(...line.results.map((row) => row.discretisation_error || 0));
      return ` on grids refined ${line.grids.join(", ")} times; discretisation error of COR at most ${digits(worst, 2)}`;
    },
  },
  worn: {
    missing: () => (content.impacts === undefined ? "give a coverage in the form, which has one for depths given as impact velocities" : ""),
    values: () => ({ content: structuredClone(content), grids: 1 }),
    figure: (line) => line.worn_figure,
    words: (line) => {
      fill("worn-numbers", Object.values(WORN), (line.worn || []).map((row) => Object.keys(WORN).map((key) => digits(row[key], 3))));
      return "";
    },
  },
};
const WORN = { impact_velocity_m_per_s: "velocity (m/s)", coverage: "coverage", impacts: "impacts", restitution: "COR", total_error: "total error", restitution_5: "5 % of places below", restitution_95: "95 % of places below" };
const jobs = {}; // the requests under way
const finished = {}; // the last results: { sent, figure }

async function runJob(name) {
  const job = JOBS[name], tell = (words) => { $(`${name}-status`).textContent = words; };
  const missing = job.missing ? job.missing() : "";
  if (jobs[name] || missing) { if (missing) tell(missing); return; }
  const mine = new AbortController();
  jobs[name] = mine;
  $(`${name}-cancel`).hidden = false;
  $(name).disabled = true;
  tell("starting…");
  const sent = { tab, ...job.values() };
  try {
    await stream("run", sent, mine.signal, (line) => {
      if (line.progress) tell(line.progress);
      else if (line.replaced) tell("cancelled");
      else if (line.error) tell(line.error);
      else if (line.problems) tell(Object.entries(line.problems).map(([key, words]) => `${key}: ${words}`).join("; "));
      else if (line.results) {
        finished[name] = { sent, figure: job.figure(line) };
        $(`${name}-cor`).hidden = false;
        drawJob(name);
        tell(`complete in ${line.seconds.toFixed(1)} s${job.words(line)}${line.failure ? `; ${line.failure}` : ""}`);
        $("take-of").querySelector(`[value=${name}]`).disabled = false;
      }
    });
  } catch (error) {
    tell(error.name === "AbortError" ? "cancelled" : lostServer(error));
  }
  delete jobs[name];
  $(`${name}-cancel`).hidden = true;
  $(name).disabled = false;
}

function drawJob(name) { if (finished[name]) draw(`${name}-cor`, finished[name].figure); }

async function take(what) {
  const done = finished[$("take-of").value];
  const of = done ? done.sent : { content: what === "case" ? content : firstImpact(), grids: 1 };
  const values = { tab, content: of.content, grids: of.grids, what, code: $("code").value, velocity: what === "export" ? $("code-velocity").value : "" };
  $("take-status").textContent = "preparing the file…";
  try {
    const response = await post("take", values);
    const named = /filename="?([^";]+)/.exec(response.headers.get("Content-Disposition") || "");
    if (!named) { $("take-status").textContent = (await response.json()).error; return; }
    const link = element("a", { href: URL.createObjectURL(await response.blob()), download: named[1] });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    $("take-status").textContent = `${named[1]} was downloaded`;
  } catch (error) {
    $("take-status").textContent = lostServer(error);
  }
}

// ---- start ------------------------------------------------------------------------------------

function listen() {
  for (const radio of document.querySelectorAll("input[name=view]")) radio.addEventListener("change", drawCurves);
  $("cursor").addEventListener("input", () => { cursor = Number($("cursor").value); drawCurves(); askMaps(); });
  $("pin").addEventListener("click", pin);
  $("form").addEventListener("submit", (event) => event.preventDefault());
  $("case-file").addEventListener("toggle", updateText);
  $("case-text").addEventListener("input", () => { textEdited = true; });
  $("case-text").addEventListener("blur", updateText);
  $("use-text").addEventListener("click", useText);
  for (const name of Object.keys(JOBS)) {
    $(name).addEventListener("click", () => runJob(name));
    $(`${name}-cancel`).addEventListener("click", () => jobs[name] && jobs[name].abort());
  }
  for (const button of document.querySelectorAll("[data-take]")) button.addEventListener("click", () => take(button.dataset.take));
  $("code").append(...form.codes.map((code) => element("option", {}, code)));
  const holdsFile = (event) => [...event.dataTransfer.types].includes("Files");
  document.addEventListener("dragover", (event) => { if (holdsFile(event)) { event.preventDefault(); $("drop").hidden = false; } });
  document.addEventListener("dragleave", (event) => { if (!event.relatedTarget) $("drop").hidden = true; });
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    $("drop").hidden = true;
    if (event.dataTransfer.files[0]) upload(event.dataTransfer.files[0]);
  });
  dark.addEventListener("change", () => { drawCurves(); askMaps(); Object.keys(JOBS).forEach(drawJob); surfaceKey = ""; changed(); });
}

async function start() {
  if (!token) { say("open the complete address that the terminal shows, with the part after #"); return; }
  try {
    const first = await (await post("start", {})).json();
    form = first.form;
    content = first.content;
  } catch (error) { say(lostServer(error)); return; }
  listen();
  drawForm();
  changed();
}

start();
