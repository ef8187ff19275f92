"""The page of a mixture: COR of every pair against velocity."""

from __future__ import annotations

import json
from pathlib import Path

from restitution.laws.law import Law
from restitution.laws.law_files import read_laws
from restitution.pages.page import Cell, Drawing, Listing, Page, Table, write_page
from restitution.plots.mixture import families_of, mixture_figure
from restitution.results.stored_files import read_json, read_text


def write_mixture_page(out: Path) -> Path:
    """Write `report.html` from the laws, the summary and the mixture file in `out`."""
    laws, summary = read_laws([out]), read_json(out / "summary.json")
    rows: list[list[Cell]] = [
        [key.replace("_", " "), value if isinstance(value, (int, float)) else json.dumps(value)]
        for key, value in summary.items()
        if key not in ("title", "warnings")
    ]
    page = Page(
        title=summary["title"] or "Mixture",
        intro=[
            f"{summary['pairs']} pairs of particles and walls, from {summary['curves_computed']} "
            "computed curves. The laws of other pairs are interpolated between computed reduced "
            "radii R*, at equal values of loading work divided by R*³."
        ],
        warnings=summary["warnings"],
        parts=[
            *map(_drawing, families_of(laws).values()),
            Table("Summary", ["quantity", "value"], rows),
            Listing("Mixture file", read_text(out / "mixture.toml")),
        ],
    )
    return write_page(out / "report.html", page)


def _drawing(laws: list[Law]) -> Drawing:
    name = f"{laws[0].first.name} on {laws[0].second.name}"
    rows: list[list[Cell]] = [
        [
            _micrometres(law.first.radius),
            _micrometres(law.second.radius),
            point.velocity,
            point.restitution,
            point.error,
            "true" if point.resolved else "false",
        ]
        for law in laws
        for point in law.points
    ]
    columns = ["R₁ (µm)", "R₂ (µm)", "V (m/s)", "COR", "error", "resolved"]
    return Drawing(
        name,
        mixture_figure("", laws),
        f"Coefficient of restitution of {name} against impact velocity, one line for each pair",
        "One line for each pair of sizes.",
        Table("COR", columns, rows),
    )


def _micrometres(radius: float | None) -> Cell:
    return "flat" if radius is None else 1e6 * radius
