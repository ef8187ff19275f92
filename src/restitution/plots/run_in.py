"""Figures of repeated impacts: COR against coverage and velocity, and against the impact number."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from restitution.curve.columns import array
from restitution.display import quantity
from restitution.plots.cor import bars, cor_chart
from restitution.plots.figure import DOTTED, GREY, PALETTE, Axis, Band, Figure, Line, Points, Series
from restitution.repeated.points import RepeatedImpact, RunInPoint
from restitution.results.reader import RunResults

_MOST = len(PALETTE)  # largest number of curves in a figure
_WINDOW = 30  # part of the impacts over which the moving mean is taken
_SAME = 0.2  # coverages whose relative difference is below this value belong to one curve


class CoverageCurve(NamedTuple):
    """COR against velocity at one coverage."""

    coverage: float
    points: list[RunInPoint]


def coverage_curves(points: Sequence[RunInPoint]) -> list[CoverageCurve]:
    """Split `points` into curves; the coverages of a curve differ because impacts are whole."""
    by_velocity: dict[float, list[RunInPoint]] = {}
    for point in points:
        by_velocity.setdefault(point.velocity, []).append(point)
    levels = zip(*(by_velocity[V] for V in sorted(by_velocity)), strict=True)
    return [CoverageCurve(float(array(level, "coverage").mean()), list(level)) for level in levels]


def run_in_figures(run: RunResults) -> Iterator[tuple[str, Figure]]:
    """The figures of a run and the names of their files; none without repeated impacts."""
    if run.run_in:
        title = run.summary["title"]
        yield "run-in-velocity", run_in_figure(run.run_in, title)
        yield "run-in-impacts", impacts_figure(run.impacts, title)


def run_in_figure(points: Sequence[RunInPoint], title: str = "") -> Figure:
    """Draw COR against velocity, a curve for each coverage."""
    curves = coverage_curves(points)
    keep = np.unique(np.linspace(0, len(curves) - 1, min(_MOST, len(curves))).round().astype(int))
    series: list[Series] = []
    for color, k in zip(PALETTE, keep.tolist(), strict=False):
        curve = curves[k]
        V, e = (array(curve.points, name) for name in ("velocity", "restitution"))
        low, high = (array(curve.points, f"restitution_{end}") for end in (5, 95))
        error, words = bars(e, np.nan_to_num(array(curve.points, "total_error")))
        label = "new surfaces" if curve.coverage == 0 else f"coverage {curve.coverage:.2g}"
        series += [
            Band(V, low, high, "90 % of the places" if k == keep[0] else "", color),
            Points(V, e, label, color=color, joined=True, error=error, error_label=words),
        ]
    V = array(points, "velocity")
    axis = Axis("impact velocity", "m/s", "log", 0.8 * float(V.min()), 1.25 * float(V.max()))
    return Figure(title, [cor_chart(axis, series)])


def impacts_figure(impacts: Sequence[Sequence[RepeatedImpact]], title: str = "") -> Figure:
    """Draw COR against coverage: each impact, and a moving mean of each sequence."""
    keep = np.unique(np.linspace(0, len(impacts) - 1, min(_MOST, len(impacts))).round().astype(int))
    series: list[Series] = []
    for color, k in zip(PALETTE, keep.tolist(), strict=False):
        one = impacts[k]
        x, e = array(one, "coverage"), array(one, "restitution")
        speeds = {point.velocity for point in one}
        label = f"at {quantity(one[0].velocity, 'm/s')}" if len(speeds) == 1 else "all velocities"
        width = max(1, len(one) // _WINDOW)
        mean = np.convolve(e, np.full(width, 1 / width), "valid")
        series += [
            Line(x, e, name=label, color=GREY, dash=DOTTED, width=0.6),
            Line(x[width // 2 :][: mean.size], mean, label, color=color, width=1.8),
        ]
    return Figure(title, [cor_chart(Axis("coverage"), series)])
