"""Time from a slider to the redrawn curve, and the memory after many changes, in Chromium.

Writes benchmarks/page.md. It needs Chromium and the extras `app` and `test`.
"""

from __future__ import annotations

import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, expect, sync_playwright
from unit import machine, today

HERE = Path(__file__).parent
OUT = HERE / "page.md"
CHROMIUM = "/usr/bin/chromium"
CHANGES, MANY = 50, 200
CASES = {
    "constant bound (`benchmarks/steel.toml`)": {},
    "growing bound (Y = 268 MPa)": {
        'yield_pressure = "750 MPa"': 'yield_strength = "268 MPa"',
        'plasticity = "equilibrium"': "",
    },
}
# Moves the slider of Rq, and returns the times (ms) of the new curve once it is painted.
MOVE = """(position) => new Promise((done) => {
  const slider = document.getElementById("field-roughness-rms-slider");
  slider.value = position;
  const began = performance.now();
  document.addEventListener("curve", ({ detail }) => requestAnimationFrame(() => setTimeout(() =>
    done({ ...detail, began, painted: performance.now() }))), { once: true });
  slider.dispatchEvent(new Event("input", { bubbles: true }));
})"""

REPORT = """\
# Time from a slider to the redrawn curve

{date}, {machine}. Written by `benchmarks/page.py`.

The page of `restitution app` ran in Chromium (headless, without a GPU) on the same machine. The
slider of Rq moved {changes} times, each time after the previous curve had been drawn. Each curve
has 24 depths on 512² nodes. The time is measured from the move until the browser has painted the
new curve of COR. The table shows the median of this time in ms (largest time in brackets), and the
parts of the time.

| case | whole | solve | server and transfer | drawing |
|---|---|---|---|---|
{rows}

The upper limit ("bound") of the contact pressure either is constant or grows with deformation. With
the growing bound each depth takes two solutions; see `growing-bound.md`.

Memory of the server and its processes, with the constant bound: {before:.0f} MiB after {changes}
changes, and {after:.0f} MiB after {many} more.
"""


def times(page: Page, count: int) -> list[dict[str, float]]:
    """The times of `count` changes of the slider, back and forth."""
    return [page.evaluate(MOVE, 480 + 40 * (k % 5) + k % 7) for k in range(count)]


def row(name: str, found: list[dict[str, float]]) -> str:
    """Format a row of the table."""
    parts = {
        "whole": [t["painted"] - t["began"] for t in found],
        "solve": [t["solve"] for t in found],
        "transfer": [t["received"] - t["asked"] - t["solve"] for t in found],
        "drawing": [t["painted"] - t["received"] for t in found],
    }
    cells = (f"{statistics.median(each):.0f} ({max(each):.0f})" for each in parts.values())
    return f"| {name} | {' | '.join(cells)} |"


def memory(pid: int) -> float:
    """Resident memory (MiB) of a process and its children."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    status = Path(f"/proc/{pid}/status").read_text()
    own = int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024
    return own + sum(memory(int(child)) for child in children)


def measured(case: Path, count: int) -> tuple[list[dict[str, float]], int, Any]:
    """Move the slider of the page of `case`; return the times, and the memory before and after.

    The memory (MiB) of the server is measured after `CHANGES` moves, and after `count` more.
    """
    command = [sys.executable, "-m", "restitution", "app", str(case), "--no-browser"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    address = server.stdout.readline().split()[-1]
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1400, "height": 900})
            page.goto(address)
            expect(page.locator("#status")).to_contain_text("complete", timeout=120_000)
            times(page, 5)
            found = times(page, CHANGES)
            before = memory(server.pid)
            times(page, count)
            after = memory(server.pid)
            browser.close()
    finally:
        server.terminate()
        server.wait(20)
    return found, before, after


def main() -> None:
    """Time the cases and write the page."""
    rows, held = [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, changes in CASES.items():
            text = (HERE / "steel.toml").read_text("utf-8")
            for old, new in changes.items():
                text = text.replace(old, new)
            case = Path(folder) / "case.toml"
            case.write_text(text, encoding="utf-8")
            found, before, after = measured(case, MANY if not changes else 0)
            rows.append(row(name, found))
            held.append((before, after))
            print(rows[-1], held[-1])
    OUT.write_text(
        REPORT.format(
            date=today(),
            machine=machine(),
            changes=CHANGES,
            many=MANY,
            rows="\n".join(rows),
            before=held[0][0],
            after=held[0][1],
        ),
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
