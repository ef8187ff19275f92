// The page of `restitution app`: it starts, and tells each part what it answers for.

import { listenForAnswer } from "./answer.js";
import { listenForText } from "./casefile.js";
import { askMaps, drawCurves } from "./curves.js";
import { listenForDownloads } from "./downloads.js";
import { dark } from "./figures.js";
import { drawForm } from "./form.js";
import { drawJob, JOBS, listenForJobs } from "./jobs.js";
import { changed, drawAgain, say, stop } from "./live.js";
import { pin } from "./pins.js";
import { listPresets } from "./presets.js";
import { lostServer, post, token } from "./requests.js";
import { listenForScans } from "./scans.js";
import { $, state } from "./state.js";

function listen() {
  for (const radio of document.querySelectorAll("input[name=view]")) radio.addEventListener("change", drawCurves);
  $("cursor").addEventListener("input", () => { state.cursor = Number($("cursor").value); drawCurves(); askMaps(); });
  $("pin").addEventListener("click", pin);
  $("stop").addEventListener("click", stop);
  $("form").addEventListener("submit", (event) => event.preventDefault());
  for (const help of document.querySelectorAll("[data-help]")) {
    help.addEventListener("click", () => {
      const text = $(help.dataset.help);
      text.hidden = !text.hidden;
      help.setAttribute("aria-expanded", String(!text.hidden));
    });
  }
  for (const part of [listenForAnswer, listenForText, listenForJobs, listenForDownloads, listenForScans, listPresets]) part();
  const again = () => { drawCurves(); askMaps(); Object.keys(JOBS).forEach(drawJob); };
  dark.addEventListener("change", () => { again(); drawAgain(); });
  let width = innerWidth, resized = null;
  addEventListener("resize", () => {
    clearTimeout(resized);
    if (innerWidth !== width) resized = setTimeout(() => { width = innerWidth; again(); }, 200);
  });
}

async function start() {
  if (!token) { say("open the complete address that the terminal shows, with the part after #"); return; }
  try {
    const first = await (await post("start", {})).json();
    state.form = first.form;
    state.content = first.content;
  } catch (error) { say(lostServer(error)); return; }
  listen();
  drawForm();
  changed();
}

start();
