"""The pages of a study and of a mixture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from restitution.case.case_file import parse_toml
from restitution.contact.checks.resolution import NODES_PER_PATCH
from restitution.display import quantity
from restitution.errors import DomainError
from restitution.laws.law import Estimate, Law
from restitution.laws.law_files import read_laws
from restitution.laws.particle import Particle
from restitution.pages.answer import body_in_words, middle_of, round_velocities
from restitution.pages.methods import methods
from restitution.pages.page import (
    Answer,
    Cell,
    Choice,
    ChosenCell,
    Drawing,
    Listing,
    Page,
    PageTable,
    write_page,
)
from restitution.pages.words import e_in_words, si, table_of
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
    drawings: list[Drawing] = []
    details: list[PageTable | Listing] = [Listing("Study file", text)]
    answer = Answer()
    if complete := [case for case in cases if case.status == "complete"]:
        abscissae = [INDENTATION]
        if any(points_with(case, IMPACT_VELOCITY) for case in cases):
            abscissae.insert(0, IMPACT_VELOCITY)
        drawings = [_restitution(complete, swept, abscissa) for abscissa in abscissae]
        details.append(methods(study.run(complete[0].name).summary))
        answer = Answer(_range_of(complete))
    page = Page(
        title=str(parse_toml(text).get("title", "")) or "Study",
        intro=[
            f"{len(cases)} cases that vary {', '.join(swept)}: "
            + ", ".join(f"{number} {status}" for status, number in count.items() if number)
        ],
        warnings=_warnings(cases, count),
        answer=answer,
        top=drawings,
        parts=[_cases(cases, swept)],
        details=details,
    )
    return write_page(out / "report.html", page)


def _range_of(cases: Sequence[StoredCase]) -> str:
    cor = [
        e for case in cases for point in case.curve.points if math.isfinite(e := point.restitution)
    ]
    return f"e from {min(cor):.2f} to {max(cor):.2f}" if cor else ""


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
            "–" if math.isnan(point.restitution) else f"{point.restitution:.4f}",
            "yes" if point.resolved else "no",
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
                f"{min(cor):.4f}" if cor else "–",
                f"{max(cor):.4f}" if cor else "–",
                f"{resolved} of {len(case.curve.points)}",
                case.reason,
            ]
        )
    columns = ["case", *swept, "status", "smallest COR", "largest COR", "depths resolved", "reason"]
    return PageTable("Cases", columns, rows)


_MOST_ROWS = 1500  # of all tables of numbers; more are left to pairs.csv
_UNRESOLVED = "°"  # stands behind COR of a contact that the grid does not resolve


def write_mixture_page(out: Path, velocity: float | None = None) -> Path:
    """Write `report.html` from the laws, the summary and the mixture file in `out`.

    COR of all pairs is shown at `velocity` (m/s), or in the middle of their velocities; readers can
    choose others. Raises `DomainError` outside the velocities of all laws.
    """
    laws, summary = read_laws([out]), read_json(out / "summary.json")
    kept = {k: v for k, v in summary.items() if k not in ("title", "warnings") and v is not None}
    coverage = laws[0].coverage
    drawings = [_drawing(members, laws) for members in families_of(laws).values()]
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
        answer=_answer(laws, velocity),
        top=drawings[:2],
        parts=drawings[2:],
        details=[
            table_of("Summary", kept),
            Listing("Mixture file", read_text(out / "mixture.toml")),
        ],
    )
    return write_page(out / "report.html", page)


def _answer(laws: Sequence[Law], velocity: float | None) -> Answer:
    low, high = min(law.lowest for law in laws), max(law.highest for law in laws)
    velocities = round_velocities(low, high) or [low, high]
    if velocity is not None and velocity not in velocities:
        velocities = sorted([*velocities, velocity])
    chosen = velocities.index(middle_of(velocities) if velocity is None else velocity)
    estimates = [[_estimate(law, V) for law in laws] for V in velocities]
    known = [one.restitution for one in estimates[chosen] if one]
    if not known:
        laws[0].at(velocities[chosen])  # raises DomainError, which names the computed velocities
    first = dict.fromkeys(body for law in laws for body in (law.first, law.second) if not body.wall)
    bodies = dict.fromkeys([*first, *(body for law in laws for body in (law.first, law.second))])
    number: dict[Particle, dict[Particle, ChosenCell]] = {body: {} for body in bodies}
    for k, law in enumerate(laws):
        number[law.first][law.second] = number[law.second][law.first] = ChosenCell(k)
    notes = [
        "COR ± error; – outside the computed velocities of a pair"
        + (f"; {_UNRESOLVED} not resolved by the grid." if _unresolved(estimates) else ".")
    ]
    matrix: list[list[Cell]] = [
        [body_in_words(row), *(number[row].get(column) for column in bodies)] for row in first
    ]
    return Answer(
        f"e from {min(known):.2f} to {max(known):.2f} at {quantity(velocities[chosen], 'm/s')}",
        choice=Choice(
            "Impact velocity",
            [quantity(V, "m/s") for V in velocities],
            [[_in_words(one) for one in row] for row in estimates],
            [
                PageTable("COR by pair", ["", *map(body_in_words, bodies)], matrix, notes),
                _pairs(laws),
            ],
            chosen,
        ),
    )


def _estimate(law: Law, velocity: float) -> Estimate | None:
    try:
        return law.at(velocity)
    except DomainError:
        return None


def _in_words(estimate: Estimate | None) -> str:
    if estimate is None:
        return "–"
    mark = "" if estimate.resolved else f" {_UNRESOLVED}"
    return e_in_words(estimate.restitution, estimate.error) + mark


def _unresolved(estimates: Sequence[Sequence[Estimate | None]]) -> bool:
    return any(one is not None and not one.resolved for row in estimates for one in row)


def _pairs(laws: Sequence[Law]) -> PageTable:
    adhesive = any(law.work_of_adhesion for law in laws)
    rows: list[list[Cell]] = [
        [
            body_in_words(law.first),
            body_in_words(law.second),
            quantity(law.radius, "m"),
            ChosenCell(k),
            *([law.sticking if law.sticks_below else "–"] if adhesive else []),
            f"{quantity(law.lowest, 'm/s')} to {quantity(law.highest, 'm/s')}",
        ]
        for k, law in enumerate(laws)
    ]
    sticks = ["sticks below"] if adhesive else []
    return PageTable("Pairs", ["first", "second", "R*", "COR", *sticks, "computed from"], rows)


def _drawing(laws: list[Law], all_laws: Sequence[Law]) -> Drawing:
    name = f"{laws[0].first.name} on {laws[0].second.name}"
    rows: list[list[Cell]] = [
        [
            si(law.first.radius, "m") if law.first.radius else "flat",
            si(law.second.radius, "m") if law.second.radius else "flat",
            quantity(point.velocity, "m/s"),
            f"{point.restitution:.4f}",
            f"{point.error:.4f}",
            "yes" if point.resolved else "no",
        ]
        for law in laws
        for point in law.points
    ]
    columns = ["R₁", "R₂", "impact velocity", "COR", "± error", "resolved"]
    few = sum(len(law.points) for law in all_laws) <= _MOST_ROWS
    numbers = PageTable("COR", columns, rows) if few else PageTable("COR", text=["See pairs.csv."])
    return Drawing(
        name,
        mixture_figure("", laws, all_laws),
        f"Coefficient of restitution of {name} against impact velocity, one line for each pair",
        "One line for each pair of sizes.",
        numbers,
    )
