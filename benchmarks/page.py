"""Time from a slider to the redrawn curve, and the memory after many changes, in Chromium.

Writes benchmarks/page.md. It needs Chromium and the extras `app` and `test`.
"""

from __future__ import annotations

import re
import statistics
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, expect, sync_playwright
from unit import machine, today

HERE = Path(__file__).parent
OUT = HERE / "page.md"
CHROMIUM = "/usr/bin/chromium"
CHANGES, MANY = 50, 200
PAUSE = 1000  # time (ms) from a preview to the next change, which cancels the refinement

GROWING = {
    'yield_pressure = "750 MPa"': 'yield_strength = "268 MPa"',
    'plasticity = "equilibrium"': "",
}
ADHESIVE = {
    **GROWING,
    "[interface]": '[interface]\nwork_of_adhesion = "0.05 J/m^2"\nadhesion = "jkr"',
    'from = "2 nm"': 'from = "20 nm"',
    'to = "5 um"': 'to = "1 um"',
    'spacing = "0.25 um"': 'spacing = "0.1 um"',
}
STEEL = (HERE / "steel.toml").read_text("utf-8")
SILICA = """
[first]
material = "silica"
radius = "5 um"
[interface]
work_of_adhesion = "0.05 J/m^2"
adhesion = "cohesive"
[roughness]
kind = "gaussian"
rms = "2 nm"
correlation_length = "0.1 um"
seed = 1
[grid]
nodes = 256
spacing = "5 nm"
[impact]
from = "10 mm/s"
to = "1 m/s"
steps = 10
"""


@dataclass(frozen=True)
class Measured:
    """A case of the page, and the positions between which its slider of Rq moves."""

    text: str
    low: int = 480
    high: int = 646
    changes: dict[str, str] = field(default_factory=dict)
    slow: bool = False

    def write(self, file: Path) -> None:
        """Write the case file."""
        text = self.text
        for old, new in self.changes.items():
            assert old in text, old
            text = text.replace(old, new)
        file.write_text(text, encoding="utf-8")

    def position(self, number: int) -> float:
        """Where change `number` moves the slider."""
        return self.low + (self.high - self.low) * (40 * (number % 5) + number % 7) / 166


def preset(name: str) -> str:
    """The text of a case that the page offers."""
    folder = HERE.parent / "src" / "restitution" / "app" / "presets"
    return (folder / f"{name}.toml").read_text("utf-8")


CASES = {
    "constant bound (`benchmarks/steel.toml`)": Measured(STEEL),
    "growing bound (Y = 268 MPa)": Measured(STEEL, changes=GROWING),
    "growing bound, adhesion `jkr`": Measured(STEEL, changes=ADHESIVE, slow=True),
    "adhesion `cohesive`": Measured(SILICA, 75, 110, slow=True),
    "preset *Steel bead*": Measured(preset("steel-bead"), 400, 450),
    "preset *Lactose powder*": Measured(preset("lactose-powder"), 70, 100, slow=True),
}
# Moves the slider of Rq, and returns the times (ms) of the first curve and, if `whole`, of the
# curve of the case, once they are painted.
MOVE = """([position, whole]) => new Promise((done) => {
  const slider = document.getElementById("field-roughness-rms-slider");
  slider.value = position;
  const began = performance.now();
  let first = null, points = null;
  const hear = ({ detail }) => requestAnimationFrame(() => setTimeout(() => {
    const painted = performance.now();
    points = points || painted;
    if (detail.partial) return;
    first = first || { ...detail, began, painted, points };
    if (whole && detail.preview) return;
    document.removeEventListener("curve", hear);
    done({ ...first, whole: painted });
  }));
  document.addEventListener("curve", hear);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
})"""

REPORT = """\
# Time from a slider to the redrawn curve

{date}, {machine}. Written by `benchmarks/page.py`.

The page of `restitution app` ran in Chromium (headless, without a GPU) on the same machine. The
slider of Rq moved {changes} times. The time is measured from the move until the browser has painted
the first new points of COR, and the first new curve: that of the case, or a preview with fewer
depths and larger cells.
Without adhesion, each move follows when the curve of the case has been drawn; with adhesion, one
second after the preview, so that it cancels the refinement. The table shows the median of the times
(largest time in brackets), the parts of that of the first curve (solve, server and transfer,
drawing), and the time of the whole curve.

| case | first points, ms | first curve, ms | solve, ms | transfer, ms | drawing, ms | whole, s |
|---|---|---|---|---|---|---|
{rows}

The steel spheres have 24 depths on 512² nodes, with adhesion (w = 0.05 J/m²) from 20 nm to 1 µm on
cells of 0.1 µm. `cohesive`: silica spheres (R = 5 µm, w = 0.05 J/m²), 10 velocities, 256² nodes.
The page chooses the grids of the presets: 512² nodes and 12 velocities, and with adhesion those
that resolve it and 8 velocities.
With adhesion, the time of the whole curve is that of one change.

First curves:

{previews}

Memory of the server and its processes, with the constant bound: {before:.0f} MiB after {changes}
changes, and {after:.0f} MiB after {many} more.
"""


def times(page: Page, case: Measured, count: int) -> list[dict[str, Any]]:
    """The times of `count` changes of the slider, back and forth."""
    moved = []
    for number in range(count):
        moved.append(page.evaluate(MOVE, [case.position(number), not case.slow]))
        if case.slow:
            page.wait_for_timeout(PAUSE)
    return moved


def row(name: str, moved: list[dict[str, Any]], whole: list[float]) -> str:
    """Format a row of the table."""
    parts = (
        [t["points"] - t["began"] for t in moved],
        [t["painted"] - t["began"] for t in moved],
        [t["solve"] for t in moved],
        [t["received"] - t["asked"] - t["solve"] for t in moved],
        [t["painted"] - t["received"] for t in moved],
    )
    cells = [f"{statistics.median(part):.0f} ({max(part):.0f})" for part in parts]
    cells.append(f"{statistics.median(whole) / 1000:.2f} ({max(whole) / 1000:.2f})")
    return f"| {name} | {' | '.join(cells)} |"


def first_curves(name: str, moved: list[dict[str, Any]]) -> str:
    """Say what the first curves of a case were."""
    kinds = Counter(t["preview"] or "the curve of the case" for t in moved)
    return f"* {name}: " + "; ".join(f"{words} ({n} times)" for words, n in kinds.most_common())


def memory(pid: int) -> float:
    """Resident memory (MiB) of a process and its children."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    status = Path(f"/proc/{pid}/status").read_text()
    own = int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024
    return own + sum(memory(int(child)) for child in children)


def measured(
    case: Measured, file: Path, more: int
) -> tuple[list[dict[str, Any]], list[float], tuple[float, float]]:
    """Move the slider of the page of a case.

    Returns the times of the first curves, those of whole curves (ms), and the memory (MiB) of the
    server after `CHANGES` moves, and after `more` moves.
    """
    command = [sys.executable, "-m", "restitution", "app", str(file), "--no-browser"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    address = server.stdout.readline().split()[-1]
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1400, "height": 900})
            page.set_default_timeout(600_000)
            page.goto(address)
            ready = re.compile("^preview" if case.slow else "^complete")
            expect(page.locator("#status")).to_have_text(ready, timeout=120_000)
            times(page, case, 5)
            moved = times(page, case, CHANGES)
            whole = [t["whole"] - t["began"] for t in moved]
            if case.slow:
                last = page.evaluate(MOVE, [case.low + 1, True])
                whole = [last["whole"] - last["began"]]
            before = memory(server.pid)
            times(page, case, more)
            after = memory(server.pid)
            browser.close()
    finally:
        server.terminate()
        server.wait(20)
    return moved, whole, (before, after)


def main() -> None:
    """Time the cases and write the page."""
    rows, previews, held = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, case in CASES.items():
            file = Path(folder) / "case.toml"
            case.write(file)
            moved, whole, memories = measured(
                case, file, MANY if case.text is STEEL and not case.changes else 0
            )
            rows.append(row(name, moved, whole))
            previews.append(first_curves(name, moved))
            held.append(memories)
            print(rows[-1], previews[-1], held[-1], sep="\n")
    OUT.write_text(
        REPORT.format(
            date=today(),
            machine=machine(),
            changes=CHANGES,
            many=MANY,
            rows="\n".join(rows),
            previews="\n".join(previews),
            before=held[0][0],
            after=held[0][1],
        ),
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
