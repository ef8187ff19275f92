"""The figure of closed forms for the smooth bodies of a case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from restitution.laws.law import Law
from restitution.plots.figure import SOLID, Array, Axis, Chart, Dash, Figure, Line, Mark, Series
from restitution.plots.law import computed_points
from restitution.plots.run import COR

# Colour, dashes and width of each line; those that often run along e = 1 lie under one another.
_LINES: dict[str, tuple[str, Dash, float]] = {
    "hertz": ("#bfbfbf", SOLID, 5.0),
    "sticking": ("#f0a830", SOLID, 3.2),
    "thornton-ning": ("#000000", SOLID, 1.4),
    "johnson": ("#d62728", SOLID, 1.4),
    "mdr": ("#000080", (5, 1, 1, 1), 1.4),
    "constant": ("#e3d5ae", SOLID, 3.2),
    "walton-braun": ("#8c564b", (4, 2), 1.2),
    "luding": ("#17becf", (3, 1, 1, 1, 1, 1), 1.4),
    "eepa": ("#808000", (2, 3), 1.4),
    "brilliantov": ("#ff5500", (7, 1, 2, 1), 1.2),
}


def theory_figure(
    title: str,
    lines: Sequence[tuple[str, bool, Array, Array]],
    marks: Mapping[str, float],
    law: Law | None = None,
) -> Figure:
    """COR against velocity: a line a theory, and the computed points of `law` as markers.

    `lines` are name, whether it is a fit, velocities (m/s) and COR; those without any COR are left
    out. `marks` are velocities (m/s) by the name of what begins there: yield and sticking.
    """
    series: list[Series] = []
    if law is not None:
        series.append(computed_points(law, "computed", "computed, not resolved"))
    for name, fitted, V, e in lines:
        if np.isfinite(e).any():
            color, dash, width = _LINES[name]
            label = name + " (fit)" * fitted
            series.append(Line(V, e, label, color=color, dash=dash, width=width))
    velocities = np.concatenate([V for _, _, V, _ in lines])
    # The lower one is named to the left of its line, the higher to the right.
    order = sorted(marks, key=marks.__getitem__)
    series += [
        Mark("x", V, name[0], name[-1], "right" if name == order[-1] else "left")
        for name, V in marks.items()
        if velocities.min() <= V <= velocities.max()
    ]
    cor = replace(COR, low=-0.02)  # a law that sticks runs along zero
    beside = "smooth bodies" if law is None else "smooth bodies, and fits"
    return Figure(title, [Chart(Axis("impact velocity", "m/s", "log"), cor, series)], beside)
