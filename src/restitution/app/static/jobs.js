// Runs in the background, by the id of their button.

import { answerVelocity, drawAnswer } from "./answer.js";
import { firstImpact, get, whole } from "./content.js";
import { draw } from "./figures.js";
import { inWords } from "./messages.js";
import { lostServer, stream, tab } from "./requests.js";
import { $, fill, state } from "./state.js";
import { digits, quantity } from "./units.js";

const COVERAGE = 1; // of the run-in at the velocity of the answer, if the form has none
const WORN = { impact_velocity_m_per_s: "velocity (m/s)", coverage: "coverage", impacts: "impacts", restitution: "COR", total_error: "total error", restitution_5: "5 % of places below", restitution_95: "95 % of places below" };

export const JOBS = {
  finer: {
    values: () => ({ content: firstImpact(), grids: Number($("grids").value) }),
    figure: (line) => line.figures.velocity || line.figures.indentation,
    words: (line) => {
      const worst = Math.max(...line.results.map((row) => row.discretisation_error || 0));
      return ` on grids refined ${line.grids.join(", ")} times; discretisation error of COR at most ${digits(worst, 2)}`;
    },
  },
  worn: {
    missing: () => (state.content.impacts === undefined ? "give a coverage in the form, which has one for depths given as impact velocities" : ""),
    values: () => ({ content: whole(), grids: 1 }),
    figure: (line) => line.worn_figure,
    words: (line) => {
      fill("worn-numbers", Object.values(WORN), (line.worn || []).map((row) => Object.keys(WORN).map((key) => ({ value: row[key], text: digits(row[key], 3) }))));
      return "";
    },
  },
  // At the velocity of the answer only.
  runin: {
    missing: () => (get("depths") !== "impact" || !answerVelocity() ? "give the depths as impact velocities first" : ""),
    values: () => ({ content: { ...whole(), total_error: false, impact: { velocity: quantity(answerVelocity(), "m/s", 6).replace("µ", "u") }, impacts: { coverage: COVERAGE, ...state.content.impacts } }, grids: 1 }),
    words: () => "",
    keep: (line) => ({ rows: line.worn || [], velocity: answerVelocity(), of: state.curve.content }),
  },
};
const jobs = {}; // the requests under way
export const finished = {}; // the last results: { sent, figure }

export async function runJob(name) {
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
      else if (line.problems) tell(Object.entries(line.problems).map(([key, words]) => inWords(key ? `${key}: ${words}` : words)).join("; "));
      else if (line.results) {
        finished[name] = { sent, figure: job.figure && job.figure(line), ...(job.keep ? job.keep(line) : {}) };
        drawJob(name);
        tell(`complete in ${line.seconds.toFixed(1)} s${job.words(line)}${line.failure ? `; ${line.failure}` : ""}`);
        const choice = $("take-of").querySelector(`[value=${name}]`);
        if (choice) choice.disabled = false;
        drawAnswer();
      }
    });
  } catch (error) {
    tell(error.name === "AbortError" ? "cancelled" : lostServer(error));
  }
  delete jobs[name];
  $(`${name}-cancel`).hidden = true;
  $(name).disabled = false;
}

export function drawJob(name) {
  if (!finished[name] || !finished[name].figure) return;
  $(`${name}-cor`).hidden = false;
  draw(`${name}-cor`, finished[name].figure);
}

export function listenForJobs() {
  for (const name of Object.keys(JOBS)) {
    $(name).addEventListener("click", () => runJob(name));
    $(`${name}-cancel`).addEventListener("click", () => jobs[name] && jobs[name].abort());
  }
}
