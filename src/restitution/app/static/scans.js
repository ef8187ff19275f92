// Scans that a reader gives to the page.

import { fields, get, settle, shown, table } from "./content.js";
import { drawForm, showProblems } from "./form.js";
import { changed, say } from "./live.js";
import { tab, token } from "./requests.js";
import { $, element, state } from "./state.js";

export function drawUpload() {
  const input = element("input", { type: "file", id: "scan", multiple: true, "aria-label": "Scan from a file" });
  input.addEventListener("change", () => upload([...input.files]));
  return element("div", { class: "field wide long" }, element("label", { for: "scan" }, "Read a scan, or drop it onto the page; several scans of one surface are joined"), input);
}

async function upload(files) {
  const scans = [];
  for (const file of files) {
    const scan = await store(file);
    if (!scan) return;
    scans.push(scan);
  }
  if (scans.length > 1 || (scans[0] && scans[0].scans)) join(scans);
  else if (scans.length) use(scans[0]);
}

// A scan that the program has read and stored, or nothing after an error.
async function store(file) {
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
    return undefined;
  }
  if (scan.error) { showProblems({ "": `${file.name}: ${scan.error}` }); say("the scan was not read"); return undefined; }
  return scan;
}

// Several scans of one surface, or a container of such scans.
function join(scans) {
  const unsized = scans.find((scan) => scan.needs_size || scan.needs_height_unit);
  if (unsized) {
    showProblems({ "": `${unsized.needs_size || unsized.needs_height_unit}; scans that are joined must state it, or a case file with [[roughness.scan]]` });
    say("the scans were not joined");
    return;
  }
  const before = fields().filter(shown);
  const { seed } = table("roughness") || {};
  state.content.roughness = [{ kind: "joined", seed: Number.isInteger(seed) ? seed : 1, scan: scans.map(({ name }) => ({ file: name })) }];
  settle(before);
  delete state.content.grid;
  state.grid = null;
  drawForm();
  changed();
}

function use(scan) {
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
    upload([...event.dataTransfer.files]);
  });
}
