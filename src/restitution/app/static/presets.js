// Cases to begin with.

import { lastValues } from "./content.js";
import { forgetCleared, redraw } from "./form.js";
import { $, element, state } from "./state.js";

const SCAN = "scan";

export function listPresets() {
  $("preset").append(
    element("option", { value: "" }, "this case"),
    ...state.form.presets.map(({ title }, number) => element("option", { value: number }, title)),
    element("option", { value: SCAN }, "Own scan…"),
  );
  $("preset").addEventListener("change", () => {
    const { value } = $("preset");
    if (value === SCAN) { $("preset").value = ""; $("scan").click(); return; }
    if (value === "") return;
    state.content = structuredClone(state.form.presets[Number(value)].content);
    state.grid = null;
    lastValues.clear();
    forgetCleared();
    redraw();
  });
  const first = state.form.presets.findIndex(({ content }) => JSON.stringify(content) === JSON.stringify(state.content));
  $("preset").value = first < 0 ? "" : String(first);
}
