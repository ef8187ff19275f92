// Curves that are kept for comparison.

import { differences } from "./content.js";
import { drawCurves } from "./curves.js";
import { redraw } from "./form.js";
import { previewOf } from "./live.js";
import { $, button, element, fill, state } from "./state.js";

const DASHES = ["dash", "dot", "dashdot", "longdash", "solid"];
const COLOURS = ["#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#d55e00"];

export function pin() {
  const { curve, pins } = state;
  if (!curve.rows.length || !curve.content) return;
  const number = pins.length ? Math.max(...pins.map((one) => one.number)) + 1 : 1;
  const before = pins.length ? pins[pins.length - 1].content : null;
  pins.push({
    number, name: `pin ${number}`, rows: curve.rows, between: curve.between, content: structuredClone(curve.content),
    words: (before ? differences(before, curve.content) : "the first pin") + (curve.preview ? `; ${previewOf(curve)}` : ""),
    colour: COLOURS[(number - 1) % COLOURS.length], dash: DASHES[(number - 1) % DASHES.length],
  });
  drawPins();
  drawCurves();
}

export function drawPins() {
  const { pins } = state;
  $("no-pins").hidden = pins.length > 0;
  if (!pins.length) { $("pins").replaceChildren(); return; }
  fill("pins", ["curve", "changes from the previous pin", "COR, first to last", ""], pins.map((one) => {
    const swatch = element("span", { class: "swatch" });
    swatch.style.background = one.colour;
    const back = button("Restore its values", () => { state.content = structuredClone(one.content); redraw(); });
    const remove = button("Remove", () => { state.pins = pins.filter((other) => other !== one); drawPins(); drawCurves(); }, { "aria-label": `Remove ${one.name}` });
    const first = one.rows[0].restitution, end = one.rows[one.rows.length - 1].restitution;
    return [element("span", {}, swatch, one.name), one.words, `${first.toFixed(4)} to ${end.toFixed(4)}`, element("span", {}, back, " ", remove)];
  }));
}
