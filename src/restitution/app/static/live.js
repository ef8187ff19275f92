// The curve while values change: each change requests a new curve, which may begin with previews. If no change
// follows, the complete run is requested.

import { drawAnswer } from "./answer.js";
import { firstImpact, whole } from "./content.js";
import { askMaps, drawCurves, drawNumbers, drawSurface } from "./curves.js";
import { updateText } from "./casefile.js";
import { redraw, showError, showGrid, showProblems } from "./form.js";
import { showWarnings } from "./messages.js";
import { lostServer, stream, tab } from "./requests.js";
import { $, state } from "./state.js";
import { duration } from "./units.js";

// Time (ms) without a change after which the smooth curve and the surface are requested.
const SHORT_REST = 100;
// Time (ms) without a change after which the complete run is requested.
const REST = 600;
// Time (ms) after which the page tells how long it has been computing, and how long it will.
const LONG = 3000;
const OF_DEPTHS = /^(\d+) of (\d+) depths/;

let asking = null; // the request under way: { abort, since, drawn }
let waiting = null; // timer of a change that waits for the request under way
let last = 300; // time (ms) that the last curve took
let resting = null; // timer that ends if no value changes for a while
let running = null; // the request under way for the smooth curve and the surface, or for the complete run
let surfaceKey = "";
let saying = null; // timer of the time beside the status

// Show `words` as the status and, while the page is `busy` with one request (an object), the time since its beginning
// and, from the `share` that is done, the time left.
export function say(words, busy, share = 0) {
  $("status").textContent = words;
  clearInterval(saying);
  $("elapsed").textContent = "";
  $("stop").hidden = !busy;
  if (!busy) return;
  const heard = performance.now();
  if (share && (busy.began === undefined || share < busy.share)) Object.assign(busy, { began: heard, from: share });
  busy.share = share;
  const rate = share > busy.from ? (heard - busy.began) / (share - busy.from) : null;
  const tell = () => {
    const now = performance.now();
    if (now - busy.since <= LONG) return;
    const left = rate === null ? null : rate * (1 - share) - (now - heard);
    $("elapsed").textContent = `${Math.round((now - busy.since) / 1000)} s${left === null ? "" : `, about ${duration(Math.max(left, 1000) / 1000)} left`}`;
  };
  tell();
  saying = setInterval(tell, 1000);
}

const shareOf = (words) => { const [, done, of] = OF_DEPTHS.exec(words) || [0, 0, 1]; return done / of; };

export function changed() {
  clearTimeout(resting);
  if (running) running.abort();
  running = null;
  mark(true);
  if (waiting) return;
  // If the curve under way will soon be complete, wait for it; otherwise request a new curve at once.
  const patience = asking && !asking.drawn ? Math.min(2000, Math.max(500, 2 * last)) - (performance.now() - asking.since) : 0;
  if (patience > 0) waiting = setTimeout(ask, patience);
  else ask();
}

// End everything that is computed for the curve; what is drawn remains.
export function stop() {
  clearTimeout(resting);
  clearTimeout(waiting);
  waiting = null;
  if (asking) asking.abort.abort();
  if (running) running.abort();
  asking = running = null;
  const { errors, preview, rows } = state.curve;
  say(preview ? `stopped; ${previewOf(state.curve)}` : errors || !rows.length ? "stopped" : "stopped; the errors are not complete");
}

export function drawAgain() { surfaceKey = ""; changed(); }

// Draw curves faint if they no longer belong to the values in the form.
function mark(stale) {
  for (const id of ["answer", "cor", "force", "pressure", "plastic"]) $(id).classList.toggle("stale", stale);
}

async function ask() {
  clearTimeout(waiting);
  waiting = null;
  if (asking) asking.abort.abort();
  const mine = { abort: new AbortController(), since: performance.now(), drawn: false };
  asking = mine;
  say("computing…", mine);
  let failed = false, complete = false;
  const sent = structuredClone(state.content);
  try {
    await stream("curve", { tab, content: sent }, mine.abort.signal, (line) => {
      if (asking !== mine) return;
      if (line.problems) { failed = true; mark(true); showProblems(line.problems); say("not computed: correct the marked value"); }
      else if (line.error) { failed = true; mark(true); showError(line.error); say(line.lost ? "stopped" : "not computed"); }
      else if (line.grid) { state.grid = line.grid; showGrid(); }
      else if (line.next) say(`${previewOf(state.curve)}; next: ${line.next} (${line.progress})`, mine);
      else if (line.curve) {
        const received = performance.now();
        takeCurve(line, whole(), mine);
        if (!mine.drawn) last = performance.now() - mine.since;
        mine.drawn = true;
        complete = line.seconds !== undefined;
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
  if (!failed && complete && !waiting) resting = setTimeout(drawSmooth, SHORT_REST);
}

// Report to the benchmark when a curve was requested, received and drawn, and how long the solve took (ms).
function record(start, line, received) {
  const detail = { asked: start, solve: 1000 * line.spent, received, drawn: performance.now(), preview: line.preview || "", partial: Boolean(line.progress) };
  document.dispatchEvent(new CustomEvent("curve", { detail }));
}

export const previewOf = ({ preview }) => `preview: ${preview}`;

function takeCurve(line, sent, request) {
  showProblems(line.failure ? problemsOf(line.failure) : {});
  const before = state.curve.preview ? state.curve : state.curve.under;
  const under = line.progress && !line.preview && before && before.request === request ? before : null;
  state.curve = { ...numbersOf(line), errors: "", content: sent, preview: line.preview || "", under, request, partial: Boolean(line.progress) };
  mark(false);
  show(line);
  const { preview } = state.curve;
  if (preview) say(`${previewOf(state.curve)}${line.progress ? ` (${line.progress})` : ""}; refining…`, request);
  else if (line.progress) say(`${line.progress}${under ? `; the rest is a ${previewOf(under)}` : ""}`, request, shareOf(line.progress));
  else say(`${line.curve.length} depths in ${line.seconds.toFixed(2)} s`);
}

const numbersOf = (line) => ({ rows: line.curve || line.results, figures: line.figures, between: line.between || null, sticking: line.sticking || {} });

function show(line) {
  showWarnings(line, redraw);
  drawCurves();
  drawNumbers();
  drawAnswer();
}

const problemsOf = (failure) => ({ "": `Some depths are missing. ${failure}` });

async function drawSmooth() {
  askMaps();
  const mine = new AbortController();
  running = mine;
  try {
    await stream("smooth", { tab, shown: surfaceKey }, mine.signal, (line) => {
      if (running !== mine || asking) return;
      if (line.surface) { surfaceKey = line.surface_key; drawSurface(line); }
      else if (line.curve) { // with the errors that take little time
        const smooth = state.curve.figures;
        state.curve = { ...state.curve, ...numbersOf(line), errors: line.errors };
        state.curve.figures = withReferences(line.figures, smooth);
        show(line);
        say(`errors ${line.errors} known; next: difference between surfaces`);
      } else if (line.figures) { state.curve.figures = line.figures; drawCurves(); }
    });
  } catch (error) {
    if (error.name !== "AbortError") say(lostServer(error));
  }
  if (running === mine) resting = setTimeout(runWhole, REST - SHORT_REST);
}

// The figures of a curve with the reference lines of others, which have those of smooth bodies, too.
function withReferences(figures, others) {
  const merged = {};
  for (const [name, figure] of Object.entries(figures)) {
    const has = new Set(figure.data.map((trace) => trace.name));
    const more = ((others[name] || {}).data || []).filter((trace) => trace.mode === "lines" && trace.name && !has.has(trace.name));
    merged[name] = { ...figure, data: [...figure.data, ...more] };
  }
  return merged;
}

async function runWhole() {
  const mine = new AbortController();
  running = mine;
  const sent = whole(), busy = { since: performance.now() };
  say("computing the errors…", busy);
  try {
    await stream("run", { tab, content: firstImpact(), grids: 1 }, mine.signal, (line) => {
      if (running !== mine || asking) return;
      if (line.progress) say(`computing the errors: ${line.progress.replace("error: ", "")}`, busy, line.share);
      else if (line.problems) showProblems(line.problems);
      else if (line.error) { showError(line.error); say("the errors are unknown"); }
      else if (line.results) {
        state.curve = { ...numbersOf(line), errors: line.includes ? `of ${line.includes}` : "", complete: true, content: sent, preview: "", under: null };
        if (line.failure) showProblems(problemsOf(line.failure));
        show(line);
        say(`complete in ${line.seconds.toFixed(1)} s`);
      }
    });
  } catch (error) {
    if (error.name !== "AbortError") say(lostServer(error));
  }
  if (running === mine) running = null;
}
