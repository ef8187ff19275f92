"""Figures of COR against impact velocity: a law, theories, a mixture, a fit, or a study."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from restitution.curve.columns import array
from restitution.curve.point import Point
from restitution.display import quantity
from restitution.laws.law import Law
from restitution.plots.cor import IMPACT_VELOCITY, Abscissa, bars, cor_axis, cor_chart, onset
from restitution.plots.figure import (
    BLUE,
    DASHED,
    GREY,
    ORANGE,
    PALETTE,
    SOLID,
    SYMBOLS,
    Array,
    Band,
    Chart,
    Dash,
    Figure,
    Line,
    Mark,
    Points,
    Series,
)
from restitution.results.reader import StoredCase

if TYPE_CHECKING:  # only `restitution fit` needs the solver
    from restitution.fit.fit import Fit

# Colour, dashes and width of the line of each law. Lines that often coincide at COR = 1 differ in
# width.
LAW_LINES: dict[str, tuple[str, Dash, float]] = {
    "hertz": ("#8f8f8f", SOLID, 5.0),
    "sticking": ("#b37d00", SOLID, 3.2),
    "thornton-ning": ("#000000", SOLID, 1.4),
    "thornton-ning-force": ("#009e73", (8, 2), 1.4),
    "johnson": ("#c8609a", (10, 1.5), 1.6),
    "mdr": ("#000080", (5, 1, 1, 1), 1.4),
    "lammps-mdr": ("#000080", (5, 1, 1, 1), 1.4),
    "constant": ("#a58a40", SOLID, 3.2),
    "walton-braun": ("#8c564b", DASHED, 1.2),
    "luding": ("#2a9db0", (3, 1, 1, 1, 1, 1), 1.6),
    "eepa": ("#808000", (2, 3), 1.4),
    "brilliantov": ("#d55e00", (7, 1, 2, 1), 1.2),
}

_FINE = 400  # number of points of a fitted line


def law_figure(law: Law) -> Figure:
    """Plot the computed COR with its error, and each fit in the range of the fitted velocities."""
    V = law.column("velocity")
    series: list[Series] = [computed_points(law, "computed", "not resolved")]
    if law.fit is not None:
        fine = np.geomspace(law.fit.lowest, law.fit.highest, _FINE)
        label = f"compact fit (within {law.fit.worst:.1g})"
        series.append(Line(fine, law.fit.restitution(fine), label, color=BLUE))
    for other in law.laws:
        values = np.array(other.restitution, dtype=float)  # None becomes NaN
        label = f"{other.name} ({other.worst:.2g})"
        color, dash, width = LAW_LINES[other.name]
        series.append(Line(V, values, label, color=color, dash=dash, width=width))
    chart = cor_chart(IMPACT_VELOCITY.axis, series)
    return Figure(law.title, [chart], "largest difference in brackets")


def computed_points(law: Law, label: str, open_label: str) -> Points:
    """Make a marker for each point of `law`, open where the grid does not resolve the contact."""
    cor = law.column("restitution")
    error, error_label = bars(cor, law.column("error"))
    return Points(
        law.column("velocity"),
        cor,
        label,
        error=error,
        error_label=error_label,
        open=~law.column("resolved").astype(bool),
        open_label=open_label,
    )


def theory_figure(
    title: str,
    lines: Sequence[tuple[str, bool, Array, Array]],
    marks: Mapping[str, float],
    law: Law | None = None,
) -> Figure:
    """Plot theories, and the computed points of `law`.

    Each of `lines` is a tuple: the name, whether the line is a fit, the velocities (m/s), and COR.
    `marks` maps the symbols "V_y" and "V_s" to velocities (m/s).
    """
    series: list[Series] = (
        [] if law is None else [computed_points(law, "computed", "computed, not resolved")]
    )
    for name, fitted, V, e in lines:
        if np.isfinite(e).any():
            color, dash, width = LAW_LINES[name]
            label = name + " (fit)" * fitted
            series.append(Line(V, e, label, color=color, dash=dash, width=width))
    velocities = np.concatenate([V for _, _, V, _ in lines])
    # The mark at the highest velocity has its name on the right, other marks on the left.
    order = sorted(marks, key=marks.__getitem__)
    series += [
        Mark("x", V, name[0], name[-1], "right" if name == order[-1] else "left")
        for name, V in marks.items()
        if velocities.min() <= V <= velocities.max()
    ]
    legend_title = "smooth bodies" if law is None else "smooth bodies, and fits"
    return Figure(title, [cor_chart(IMPACT_VELOCITY.axis, series)], legend_title)


_MOST_ENTRIES = 2 * len(PALETTE)  # each colour with two kinds of lines


def mixture_figure(title: str, laws: Sequence[Law], beside: Sequence[Law] | None = None) -> Figure:
    """Plot COR: a chart for every pair of materials, with a line for every pair of sizes.

    In a chart of more than `_MOST_ENTRIES` lines, grey lines share one entry of the legend. All
    charts have the axis of COR that spans the lines `beside`, by default their own.
    """
    families = families_of(laws)
    names = [f"{first} on {second}" if len(families) > 1 else "" for first, second in families]
    axis = cor_axis(_lines(laws if beside is None else beside))
    charts = [
        Chart(IMPACT_VELOCITY.axis, axis, _lines(members), name)
        for name, members in zip(names, families.values(), strict=True)
    ]
    return Figure(title, charts)


def _lines(laws: Sequence[Law]) -> list[Line]:
    ordered = sorted(laws, key=lambda law: law.radius)
    step = math.ceil(len(ordered) / _MOST_ENTRIES)
    return [
        _line(law, number // step) if number % step == 0 else _line(law, None)
        for number, law in enumerate(ordered)
    ]


def _line(law: Law, place: int | None) -> Line:
    """A line with the `place`th style and its own entry in the legend; grey if `place` is None."""
    name = f"R* = {quantity(law.radius, 'm')}"
    V, e = law.column("velocity"), law.column("restitution")
    V, e = Points(V, e, via=onset(V, e)).line()
    if place is None:
        return Line(V, e, "R* between these", name=name, color=GREY)
    dashes, color = divmod(place, len(PALETTE))
    return Line(V, e, name, name=name, color=PALETTE[color], dash=(SOLID, DASHED)[dashes])


def families_of(laws: Sequence[Law]) -> dict[tuple[str, str], list[Law]]:
    families: dict[tuple[str, str], list[Law]] = {}
    for law in laws:
        families.setdefault((law.first.name, law.second.name), []).append(law)
    return families


def fit_figure(fit: Fit) -> Figure:
    curve, measured = fit.curve, fit.measured
    series: list[Series] = []
    if curve.velocity.size > 1:
        low, high = curve.restitution - curve.half_band, curve.restitution + curve.half_band
        band = low.clip(0.0, 1.0), high.clip(0.0, 1.0)
        series.append(Band(curve.velocity, *band, "95 % interval of the fit", color=BLUE))
    series.append(Line(curve.velocity, curve.restitution, "fitted", color=BLUE))
    series.append(
        Points(
            measured.velocity,
            measured.restitution,
            "measured",
            color=ORANGE,
            error=measured.deviation,
            error_label="" if measured.deviation is None else "standard deviation",
            open=~fit.resolved,
            open_label="measured, contact not resolved",
        )
    )
    values = ", ".join(
        f"{parameter.key} {parameter.text(factor)}"
        for parameter, factor in zip(fit.parameters, fit.factors, strict=True)
    )
    return Figure(values, [cor_chart(IMPACT_VELOCITY.axis, series)])


MOST_LINES = 60  # largest number of lines in a figure; more cannot be distinguished


def points_with(case: StoredCase, abscissa: Abscissa) -> list[Point]:
    name = abscissa.variable
    return [point for point in case.curve.points if not math.isnan(getattr(point, name))]


def study_figure(cases: Sequence[StoredCase], abscissa: Abscissa) -> Figure:
    series = []
    for number, case in enumerate(cases[:MOST_LINES]):
        points = points_with(case, abscissa)
        if not points:
            continue
        # The label shows only the last part of each swept key: "rms" for "roughness.rms".
        label = ", ".join(f"{key.rsplit('.', 1)[-1]} {value}" for key, value in case.swept.items())
        series.append(
            Points(
                abscissa.scale * array(points, abscissa.variable),
                array(points, "restitution"),
                label,
                color=PALETTE[number % len(PALETTE)],
                symbol=SYMBOLS[number % len(SYMBOLS)],
                joined=True,
                open=np.array([not point.resolved for point in points]),
            )
        )
    return Figure("", [cor_chart(abscissa.axis, series)])
