// The case as the text of a file.

import { lastValues, whole } from "./content.js";
import { forgetCleared, redraw } from "./form.js";
import { lostServer, post } from "./requests.js";
import { $, state } from "./state.js";

let edited = false; // the user has edited the text, but not pressed “Use this text” yet

// While this is true, the text is not replaced, because the user's changes or selection would be lost.
const isEdited = () => edited || document.activeElement === $("case-text");

export async function updateText() {
  if (!$("case-file").open || isEdited()) return;
  try {
    const file = await (await post("text", { content: whole() })).json();
    if (!isEdited()) $("case-text").value = file.text;
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
  edited = false;
  state.content = answer.content;
  lastValues.clear();
  forgetCleared();
  redraw();
}

export function listenForText() {
  $("case-file").addEventListener("toggle", updateText);
  $("case-text").addEventListener("input", () => { edited = true; });
  $("case-text").addEventListener("blur", updateText);
  $("use-text").addEventListener("click", useText);
}
