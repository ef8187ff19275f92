"""The pages of a study and of a mixture."""

from __future__ import annotations

import json
import math
from pathlib import Path

from restitution.case.case_file import parse_toml
from restitution.contact.checks.resolution import NODES_PER_PATCH
from restitution.laws.law import Law
from restitution.laws.law_files import read_laws
from restitution.pages.methods import methods
from restitution.pages.page import Cell, Drawing, Listing, Page, PageTable, write_page
from restitution.plots.cor import IMPACT_VELOCITY, INDENTATION, Abscissa
from restitution.plots.law import MOST_LINES, families_of, mixture_figure, points_with, study_figure
from restitution.results.reader import StoredCase, StudyResults
from restitution.results.stored_files import read_json, read_text


def write_study_page(out: Path) -> Path:
    """Write `report.html` from the `table.csv` and the cases of the study in `out`."""
    study = StudyResults(out)
    cases, text = study.cases, study.text
    swept = list(cases[0].swept)
    count = {
        status: sum(case.status == status for case in cases)
        for status in ("complete", "failed", "missing")
    }
    parts: list[PageTable | Drawing | Listing] = [_cases(cases, swept), Listing("Study file", text)]
    if complete := [case for case in cases if case.status == "complete"]:
        abscissae = [INDENTATION]
        if any(points_with(case, IMPACT_VELOCITY) for case in cases):
            abscissae.append(IMPACT_VELOCITY)
        drawings = (_restitution(complete, swept, abscissa) for abscissa in abscissae)
        parts = [*drawings, *parts, methods(study.run(complete[0].name).summary)]
    page = Page(
        title=str(parse_toml(text).get("title", "")) or "Study",
        intro=[
            f"{len(cases)} cases that vary {', '.join(swept)}: "
            + ", ".join(f"{number} {status}" for status, number in count.items() if number)
        ],
        warnings=_warnings(cases, count),
        parts=parts,
    )
    return write_page(out / "report.html", page)


def _warnings(cases: list[StoredCase], count: dict[str, int]) -> list[str]:
    warnings = []
    resolved = [point.resolved for case in cases for point in case.curve.points]
    few = len(resolved) - int(sum(resolved))
    if few:
        warnings.append(
            f"{few} of {len(resolved)} depths are not resolved: at least half of their contact "
            f"is in patches of fewer than {NODES_PER_PATCH} nodes, or the cells are too large for "
            "adhesion, so their numbers depend on the grid"
        )
    if count["failed"] or count["missing"]:
        warnings.append(
            f"{count['failed']} cases failed and {count['missing']} are missing; the table of "
            "cases states the reasons"
        )
    return warnings


def _restitution(drawn: list[StoredCase], swept: list[str], abscissa: Abscissa) -> Drawing:
    axis = abscissa.axis
    table: list[list[Cell]] = [
        [
            *case.swept.values(),
            abscissa.scale * getattr(point, abscissa.variable),
            point.restitution,
            "true" if point.resolved else "false",
        ]
        for case in drawn
        for point in points_with(case, abscissa)
    ]
    figure = study_figure(drawn, abscissa)
    lines = min(len(drawn), MOST_LINES)
    few = "" if len(drawn) == lines else f" The first {lines} of {len(drawn)} cases."
    return Drawing(
        f"Restitution against {axis.label}",
        figure,
        f"Coefficient of restitution against {axis.label}, one line for each of {lines} cases",
        f"Open markers: not resolved by the grid. A click in the legend hides a case.{few}",
        PageTable("Restitution", [*swept, axis.title, "COR", "resolved"], table),
    )


def _cases(cases: list[StoredCase], swept: list[str]) -> PageTable:
    rows: list[list[Cell]] = []
    for case in cases:
        cor = [e for point in case.curve.points if not math.isnan(e := point.restitution)]
        resolved = int(sum(point.resolved for point in case.curve.points))
        rows.append(
            [
                case.name,
                *case.swept.values(),
                case.status,
                min(cor, default=None),
                max(cor, default=None),
                f"{resolved} of {len(case.curve.points)}",
                case.reason,
            ]
        )
    columns = ["case", *swept, "status", "smallest COR", "largest COR", "depths resolved", "reason"]
    return PageTable("Cases", columns, rows)


def write_mixture_page(out: Path) -> Path:
    """Write `report.html` from the laws, the summary and the mixture file in `out`."""
    laws, summary = read_laws([out]), read_json(out / "summary.json")
    rows: list[list[Cell]] = [
        [key.replace("_", " "), value if isinstance(value, (int, float)) else json.dumps(value)]
        for key, value in summary.items()
        if key not in ("title", "warnings") and value is not None
    ]
    coverage = laws[0].coverage
    page = Page(
        title=summary["title"] or "Mixture",
        intro=[
            f"{summary['pairs']} pairs of particles and walls, from {summary['curves_computed']} "
            "computed curves. The laws of other pairs are interpolated between computed reduced "
            "radii R*, at equal values of loading work divided by R*³.",
            *(
                [f"COR is that of surfaces that earlier impacts have covered {coverage:g} times."]
                if coverage is not None
                else []
            ),
        ],
        warnings=summary["warnings"],
        parts=[
            *map(_drawing, families_of(laws).values()),
            PageTable("Summary", ["quantity", "value"], rows),
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
        PageTable("COR", columns, rows),
    )


def _micrometres(radius: float | None) -> Cell:
    return "flat" if radius is None else 1e6 * radius
