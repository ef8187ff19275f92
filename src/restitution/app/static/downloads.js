// Files that a reader takes away, and the lines of a DEM code.

import { firstImpact, whole } from "./content.js";
import { finished } from "./jobs.js";
import { lostServer, post, stream, tab } from "./requests.js";
import { $, element, state } from "./state.js";

function values(what) {
  const done = finished[$("take-of").value];
  const of = done ? done.sent : { content: what === "case" ? whole() : firstImpact(), grids: 1 };
  return { tab, content: of.content, grids: of.grids, code: $("code").value, velocity: what === "export" || what === "show" ? $("code-velocity").value : "" };
}

async function take(what) {
  $("take-status").textContent = "preparing the file…";
  try {
    const response = await post("take", { ...values(what), what });
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

// Show what a DEM code reads, without its comments.
async function show() {
  const tell = (words) => { $("take-status").textContent = words; };
  tell("preparing the lines…");
  try {
    await stream("show", values("show"), undefined, (line) => {
      if (line.progress) tell(line.progress);
      else if (line.text !== undefined) {
        $("code-lines").hidden = false;
        $("code-lines").textContent = line.text;
        tell(`the lines of ${line.file}; Export gives the whole file`);
      } else tell(line.error || Object.values(line.problems || { "": "replaced by a newer request" })[0]);
    });
  } catch (error) {
    tell(lostServer(error));
  }
}

export function listenForDownloads() {
  for (const one of document.querySelectorAll("[data-take]")) one.addEventListener("click", () => take(one.dataset.take));
  $("show-lines").addEventListener("click", show);
  $("code").append(...state.form.codes.map((code) => element("option", {}, code)));
}
