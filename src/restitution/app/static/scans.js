// Scans that a reader gives to the page.

import { fields, get, settle, shown, table } from "./content.js";
import { drawForm, showProblems } from "./form.js";
import { changed, say } from "./live.js";
import { tab, token } from "./requests.js";
import { $, element, state } from "./state.js";

export function drawUpload() {
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
  state.content.roughness = [{ kind: "measured", file: scan.name }];
  if (seeds.detrend) state.content.roughness[0].detrend = seeds.detrend;
  settle(before);
  delete state.content.grid; // the pixels of the scan are the grid
  state.grid = null;
  drawForm();
  if (scan.needs_size) showProblems({ "roughness.size": `${scan.needs_size}; give its edge lengths, such as 10 um, 10 um` });
  if (scan.needs_height_unit) showProblems({ "roughness.height_unit": `${scan.needs_height_unit}; choose the unit of the heights` });
  changed();
}

export function listenForScans() {
  const holdsFile = (event) => [...event.dataTransfer.types].includes("Files");
  document.addEventListener("dragover", (event) => { if (holdsFile(event)) { event.preventDefault(); $("drop").hidden = false; } });
  document.addEventListener("dragleave", (event) => { if (!event.relatedTarget) $("drop").hidden = true; });
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    $("drop").hidden = true;
    if (event.dataTransfer.files[0]) upload(event.dataTransfer.files[0]);
  });
}
