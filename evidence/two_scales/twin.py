r"""The twin of an AFM scan, glass on steel: COR and its error by cells, surfaces and hardness.

    python -m evidence.two_scales.twin --topographies ../shared/topographies

writes twin.csv. The scan is `matrix-3.txt` (pixel 0.039 um).
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from evidence.two_scales.table import Table, options
from restitution.case.case_file import parse_case
from restitution.results.writer import ResultsFolder
from restitution.runs.ensemble import run_realisations

CASE = """\
first = {{ material = "glass", radius = "500 um"{hardness} }}
second = {{ material = "steel", radius = "flat", yield_strength = "2.03 GPa" }}
[roughness]
kind = "measured"
file = "{scan}"
size = "10 um"
extend = "twin"
seed = 1
below_grid = "{below}"
realisations = {surfaces}
[grid]
nodes = 128
spacing = "0.25 um"
{refine}
[impact]
velocity = "0.01 m/s"
"""
GIVEN = ', hardness = "5.7 GPa"'  # the library's value, without its spread
# words: keys
CASES = {
    "without patches": {"below": "omit"},
    "refine = 1": {"refine": "refine = 1"},
    "refine = 2": {"refine": "refine = 2"},
    "refine = 4": {"refine": "refine = 4"},
    "without refine": {},
    "hardness of glass given": {"hardness": GIVEN},
    "16 surfaces": {"surfaces": 16},
    "16 surfaces, hardness of glass given": {"surfaces": 16, "hardness": GIVEN},
    "refine = 8, without patches": {"below": "omit", "refine": "refine = 8"},
    "refine = 8, without patches, 16 surfaces": {
        "below": "omit",
        "refine": "refine = 8",
        "surfaces": 16,
    },
}
PARTS = ("discretisation_error", "surface_scatter", "material_error", "total_error")
COLUMNS = ("case", "refine", "nodes", "restitution", *PARTS, "seconds")
TABLE = Table(__file__, COLUMNS)


def row_of(name: str, scan: Path) -> dict[str, object]:
    keys = {"below": "patch", "refine": "", "surfaces": 1, "hardness": ""} | CASES[name]
    text = CASE.format(scan=scan.as_posix(), **keys)
    with tempfile.TemporaryDirectory() as temporary:
        out, began = ResultsFolder(Path(temporary) / "out"), time.process_time()
        run_realisations(parse_case(text), text, Path(temporary), out)
        (row,) = out.rows
    return {
        "case": name,
        "refine": int(row.get("refine", 0)),
        "nodes": int(row["contact_nodes"]),
        "restitution": f"{row['restitution']:.3f}",
        **{part: f"{row[part]:.3f}" for part in PARTS},
        "seconds": f"{time.process_time() - began:.0f}",
    }


def main() -> None:
    given = options(__doc__)
    known = [row["case"] for row in TABLE.rows()]
    for name in CASES if not given.summary else ():
        if name not in known:
            TABLE.append([row_of(name, given.topographies / "matrix-3.txt")])
    for row in TABLE.rows():
        print(*row.values(), sep=", ")


if __name__ == "__main__":
    main()
