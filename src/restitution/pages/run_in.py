"""The part of a run's page on repeated impacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from restitution.display import quantity
from restitution.pages.page import Drawing, PageTable
from restitution.plots.run_in import impacts_figure, run_in_figure
from restitution.repeated.points import RepeatedImpact, RunInPoint

_COLUMNS = {
    "velocity (m/s)": "velocity",
    "coverage": "coverage",
    "impacts": "impacts",
    "COR": "restitution",
    "± total": "total_error",
    "standard deviation": "restitution_std",
    "5 % quantile": "restitution_5",
    "median": "restitution_50",
    "95 % quantile": "restitution_95",
}


def run_in_parts(
    points: Sequence[RunInPoint],
    impacts: Sequence[Sequence[RepeatedImpact]],
    summary: Mapping[str, Any],
) -> tuple[Drawing, Drawing, PageTable]:
    """The figures and tables of a run-in, whose entry of `summary.json` is `summary`."""
    rows = [[getattr(point, name) for name in _COLUMNS.values()] for point in points]
    last = max(point.coverage for point in points)
    after = Drawing(
        "Restitution after many impacts",
        run_in_figure(points),
        f"Mean coefficient of restitution against impact velocity up to coverage {last:.3g}",
        f"Means over {points[0].places:.0f} places; the bands hold 90 % of the places.",
        PageTable("Restitution at each coverage", list(_COLUMNS), rows),
    )
    during = Drawing(
        "Restitution during the impacts",
        impacts_figure(impacts),
        "Coefficient of restitution of each impact against coverage",
        "Thin: each impact. Thick: moving mean.",
        PageTable(
            "Sequences",
            ["sequence", "velocity (m/s)", "impacts", "coverage", "COR of the last half", "steady"],
            [
                [k, one[-1].velocity, len(one), one[-1].coverage, *_steady(entry)]
                for k, (one, entry) in enumerate(zip(impacts, summary["sequences"], strict=True), 1)
            ],
        ),
    )
    surfaces = [
        [
            one["sequence"],
            name,
            of["file"],
            *(quantity(of[key], "m") for key in ("Sq_m", "Sz_m")),
            *(of[key] for key in ("Ssk", "Sku", "Sdq")),
        ]
        for one in summary["sequences"]
        for name, of in one["surfaces"].items()
    ]
    table = PageTable(
        "Surfaces after the impacts",
        ["sequence", "body", "file", "Sq", "Sz", "Ssk", "Sku", "Sdq"],
        surfaces,
        ['Each file is a scan for another case: kind = "measured", file = "…".'],
    )
    return after, during, table


def _trend(state: Mapping[str, Any]) -> str:
    return f"{state['trend']:+.2g} ± {state['trend_error']:.2g} per coverage"


def _steady(entry: Mapping[str, Any]) -> tuple[str, str]:
    state = entry["steady_state"]
    if state is None:
        return "–", "too few impacts"
    words = "yes" if state["steady"] else f"no ({_trend(state)})"
    return f"{state['restitution']:.3f} ± {state['error']:.2g}", words
