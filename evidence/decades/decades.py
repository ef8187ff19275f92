"""A law over four decades of velocity from grids chosen by depth, against direct runs in between.

Writes decades.csv: the law has 17 velocities from 0.001 to 10 m/s, and twelve others are drawn at
random for each of four contacts. `strict_error` does not include the errors of grid, surface and
materials, because law and direct run share them. Takes about three minutes.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from evidence.shared import write_table
from restitution.case.case_file import parse_case
from restitution.laws.from_results import bare_law
from restitution.laws.law import Law
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case

CASE = """
total_error = {total}
first = {{ material = "{material}", radius = "{radius}" }}
second = "steel"
[roughness]
kind = "{kind}"
rms = "{rms}"
correlation_length = "{length}"
seed = {seed}
[grid]
nodes = {nodes}
spacing = "{spacing}"
refine = "auto"
[impact]
velocity = [{velocities}]
"""
CONTACTS = (
    ("aluminium", "500 um", "gaussian", "0.2 um", "10 um", 11, 512, "0.5 um"),
    ("steel", "300 um", "gaussian", "0.1 um", "5 um", 12, 512, "0.25 um"),
    ("glass", "1 mm", "gaussian", "0.5 um", "20 um", 13, 512, "0.6 um"),
    ("lactose", "200 um", "gaussian", "0.1 um", "8 um", 14, 400, "0.4 um"),
)
NAMES = ("material", "radius", "kind", "rms", "length", "seed", "nodes", "spacing")
VELOCITIES = np.geomspace(0.001, 10.0, 17)
BETWEEN = 12


def law_at(contact: dict[str, object], velocities: np.ndarray, folder: Path, total: str) -> Law:
    """The law of `contact` at `velocities` (m/s), computed directly."""
    listed = ", ".join(f'"{V:.12g} m/s"' for V in velocities)
    text = CASE.format(**contact, velocities=listed, total=total)
    run_case(parse_case(text), text, folder, ResultsFolder(folder))
    return bare_law(folder)


def checks(number: int, place: Path) -> list[dict]:
    """Compare the law of one contact with direct runs, at velocities that set no constant."""
    contact = dict(zip(NAMES, CONTACTS[number], strict=True))
    law = law_at(contact, VELOCITIES, place / f"law-{number}", "true")
    bare = [
        replace(point, error=0.0) for point in law.points
    ]  # then `at` gives the error of interpolation alone
    strict = replace(law, points=tuple(bare))
    drawn = np.random.default_rng(100 + number).uniform(np.log(0.001), np.log(10.0), BETWEEN)
    direct = law_at(contact, np.sort(np.exp(drawn)), place / f"direct-{number}", "false")
    return [
        {
            "material": contact["material"],
            "velocity_m_per_s": f"{point.velocity:.6g}",
            "restitution_law": f"{law.at(point.velocity).restitution:.5f}",
            "restitution_direct": f"{point.restitution:.5f}",
            "error": f"{law.at(point.velocity).error:.5f}",
            "strict_error": f"{strict.at(point.velocity).error + point.error:.5f}",
            "resolved": law.at(point.velocity).resolved and point.resolved,
        }
        for point in direct.points
    ]


def main() -> None:
    """Write the table, and print how often the errors hold."""
    with tempfile.TemporaryDirectory() as folder:
        rows = [row for k in range(len(CONTACTS)) for row in checks(k, Path(folder))]
    write_table("decades/decades.csv", rows)
    for name in ("error", "strict_error"):
        held = [
            abs(float(row["restitution_law"]) - float(row["restitution_direct"]))
            <= float(row[name])
            for row in rows
        ]
        print(f"{name}: {sum(held)} of {len(held)} held")
    print(f"resolved: {sum(row['resolved'] for row in rows)} of {len(rows)}")


if __name__ == "__main__":
    main()
