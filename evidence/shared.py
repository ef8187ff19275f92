"""What several scripts share: two steel spheres, and functions that write tables and figures."""

from __future__ import annotations

import csv
from pathlib import Path

from restitution import Body, Pair
from restitution.plots.figure import Figure
from restitution.plots.static import write_figure

HERE = Path(__file__).parent
IMAGES = HERE.parent / "docs" / "images"
STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850)
PAIR = Pair(STEEL, STEEL)  # R* = 250 um, E* = 112 GPa


def write_table(name: str, rows: list[dict]) -> None:
    """Write `rows` as `name`, a path relative to this folder."""
    with open(HERE / name, "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def write_image(name: str, figure: Figure) -> None:
    """Write `figure` as `name`.png among the images of the documentation."""
    write_figure(IMAGES / name, figure)
