// The answer at the top: e at one velocity, what happens to an adhesive pair, and whether the grid resolves it.

import { choose, get, set } from "./content.js";
import { redraw } from "./form.js";
import { finished } from "./jobs.js";
import { $, button, element, state } from "./state.js";
import { parsed, quantity, withError } from "./units.js";

const FIRST = 1; // velocity (m/s) of the answer unless a reader has typed one
const NEAR = 1e-3; // relative difference of a computed velocity from the one in the case
let typed = false, exportTyped = false;

// Values at `velocity` (m/s), linear in ln V between the nearest of many; null outside them.
export function at(velocity, between) {
  if (!between || !velocity) return null;
  const V = between.velocity, last = V.length - 1;
  if (velocity < V[0] * (1 - NEAR) || velocity > V[last] * (1 + NEAR)) return null;
  const after = velocity >= V[last] ? last : Math.max(1, V.findIndex((v) => v >= velocity));
  if (!last) return Object.fromEntries(Object.entries(between).map(([name, values]) => [name, values[0]]));
  const share = Math.min(1, Math.max(0, Math.log(velocity / V[after - 1]) / Math.log(V[after] / V[after - 1])));
  return Object.fromEntries(Object.entries(between).map(([name, values]) => {
    const [a, b] = [values[after - 1], values[after]];
    return [name, a === null || b === null ? null : (1 - share) * a + share * b];
  }));
}

export const answerVelocity = () => parsed($("answer-velocity").value, "m/s");

export function listenForAnswer() {
  $("answer-velocity").addEventListener("input", () => { typed = true; drawAnswer(); });
  $("code-velocity").addEventListener("input", () => { exportTyped = true; });
}

const rounded = (value) => Number(value.toPrecision(1));

export function drawAnswer() {
  const { curve } = state, { between } = curve;
  if (!typed && between && !curve.partial) {
    const V = between.velocity, low = V[0], high = V[V.length - 1];
    const inside = FIRST >= low && FIRST <= high * (1 + NEAR) ? FIRST : Math.max(low, Math.min(high, rounded(0.5 * high)));
    $("answer-velocity").value = quantity(inside, "m/s", 3);
  }
  if (!exportTyped) $("code-velocity").value = $("answer-velocity").value;
  // While the curve grows from its shallow end, the preview below it still answers at higher velocities.
  const V = answerVelocity(), { under } = curve, own = at(V, between), rest = own || !under ? null : at(V, under.between);
  const here = own || rest, shown = rest ? under : curve;
  $("answer-velocity").setAttribute("aria-invalid", String(V === null));
  $("answer-value").textContent = here ? inDigits(V, here, shown) : "e = –";
  $("answer-detail").replaceChildren(...(here ? detail(here, shown) : outside(V, between)));
  $("answer-facts").replaceChildren(...facts(V, here).flatMap(([name, ...values]) => [element("dt", {}, name), element("dd", {}, ...values)]));
}

// e with its error, and as many digits as the error allows.
function inDigits(V, { restitution, total_error: error }, curve) {
  if (curve.preview) {
    const [sticks, rebounds] = onset(curve.rows);
    if (sticks && V > sticks.impact_velocity_m_per_s && V < rebounds.impact_velocity_m_per_s) return `e ≈ 0 to ${rebounds.restitution.toFixed(2)}`;
    return withDigits(restitution, error, "≈");
  }
  if (curve.partial) return `e ≈ ${restitution.toFixed(2)}`;
  if (error === null || !curve.errors) return `e = ${restitution.toFixed(3)}`;
  return withDigits(restitution, error);
}

// The last row that sticks and the first that rebounds, if there are both.
function onset(rows) {
  const next = rows.findIndex((row) => row.restitution > 0);
  return next > 0 ? [rows[next - 1], rows[next]] : [];
}

function withDigits(restitution, error, is = "=") {
  if (error === null || error === undefined) return `e ${is} ${restitution.toFixed(3)}`;
  const places = Math.min(4, Math.max(2, error > 0 ? Math.ceil(-Math.log10(error)) : 2));
  return `e ${is} ${restitution.toFixed(places)} ± ${Math.max(error, 10 ** -places).toFixed(places)}`;
}

function detail({ total_error: error, model_error: model }, curve) {
  const kind = curve.preview ? "A preview with the error that is usual on its cells. " : curve.partial ? "The curve is not complete yet. "
    : error === null || !curve.errors ? "The error is not known yet. " : `The error is that ${curve.errors}. `;
  return [kind, model > 0 ? `The choice of the model may change e by another ± ${model.toPrecision(1)}.` : ""];
}

function outside(V, between) {
  if (V === null) return ["Type a velocity with its unit, such as 0.5 m/s or 20 mm/s."];
  if (!between) return [get("depths") === "impact" ? "No velocity is computed yet." : "No impact velocity is known: give the densities."];
  const [low, high] = [between.velocity[0], between.velocity[between.velocity.length - 1]];
  if (state.curve.partial) return [`Computed up to ${quantity(high, "m/s", 3)} so far.`];
  const words = `Computed from ${quantity(low, "m/s", 3)} to ${quantity(high, "m/s", 3)}; nothing is extrapolated. `;
  return [words, button("Compute this velocity too", () => {
    if (get("depths") !== "impact") choose("depths", "impact");
    set(V < low ? "impact.from" : "impact.to", quantity(V, "m/s").replace("µ", "u"));
    for (const key of ["impact.velocity"]) if (get(key) !== "") set(key, "");
    redraw();
  })];
}

// The row nearest to a velocity.
function nearest(V) {
  const rows = state.curve.rows.filter((row) => row.impact_velocity_m_per_s > 0);
  const off = (row) => Math.abs(Math.log(row.impact_velocity_m_per_s / V));
  return rows.reduce((best, row) => (best === null || off(row) < off(best) ? row : best), null);
}

function facts(V, here) {
  const adhesive = state.curve.rows.some((row) => row.pull_off_force_N > 0);
  return [...worn(V, here), ...(adhesive ? attraction(V) : []), ...resolution()];
}

function worn(V, here) {
  const done = finished.runin, e = done && done.velocity === V && JSON.stringify(done.of) === JSON.stringify(state.curve.content) ? done.rows : null;
  if (get("depths") !== "impact" || !here) return [];
  if (!e) return [["After run-in", element("span", { class: "soft" }, "not computed; the value above is that of new surfaces")]];
  const end = e[e.length - 1];
  return [["After run-in", `${withDigits(end.restitution, end.total_error)} where impacts have covered the surface ${Number(end.coverage.toPrecision(2))} times (${end.impacts} impacts); new: ${e[0].restitution.toFixed(3)}`]];
}

function attraction(V) {
  const { sticking, between, rows, partial } = state.curve;
  const row = V ? nearest(V) : null;
  const below = sticking.sticks_below_m_per_s, error = sticking.sticks_below_error_m_per_s;
  const first = between ? between.restitution.findIndex((e) => e > 0) : -1;
  let sticks = "not in the computed range";
  if (below > 0) sticks = `below ${withError(below, error, "m/s")}`;
  else if (below === 0) sticks = error > 0 ? `not above ${quantity(error, "m/s", 2)}` : "at no velocity";
  else if (rows.every((one) => one.sticks)) sticks = partial ? `at ${quantity(rows[rows.length - 1].impact_velocity_m_per_s, "m/s", 2)}; faster impacts follow` : "at every computed velocity";
  else if (first > 0) {
    const [low, high] = onset(rows).map((one) => quantity(one.impact_velocity_m_per_s, "m/s", 2));
    sticks = `below about ${quantity(between.velocity[first], "m/s", 2)}${low && high ? ` (computed: ${low} sticks, ${high} rebounds)` : ""}`;
  }
  const force = row && row.pull_off_force_N > 0 ? `${withError(row.pull_off_force_N, row.pull_off_error_N, "N")}, after ${quantity(row.impact_velocity_m_per_s, "m/s", 2)}` : "unknown";
  return [["Sticks", sticks], ["Pull-off force", force]];
}

export const isResolved = (row) => row.resolved !== false && row.adhesion_resolved !== false;

function resolution() {
  const { rows, preview, partial } = state.curve;
  if (!rows.length || preview || partial) return [["Grid", element("span", { class: "soft" }, preview ? "coarser cells for the preview" : "…")]];
  const open = rows.filter((row) => !isResolved(row));
  if (!open.length) return [["Grid", element("span", { id: "resolved" }, "resolved ✓")]];
  const shallow = open.map((row) => row.impact_velocity_m_per_s).filter((v) => v > 0);
  const where = shallow.length ? ` (${quantity(Math.min(...shallow), "m/s", 2)}${shallow.length > 1 ? ` to ${quantity(Math.max(...shallow), "m/s", 2)}` : ""})` : "";
  const refine = get("grid.refine") === "auto" ? [] : [" ", button("Refine where needed", () => { set("grid.refine", "auto"); redraw(); })];
  return [["Grid", element("span", { id: "resolved" }, `not resolved at ${open.length} of ${rows.length} depths${where}: too few cells in the patches of contact`), ...refine]];
}
