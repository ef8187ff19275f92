"""The figure that compares theories for the smooth bodies of a case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from restitution.laws.law import Law
from restitution.plots.cor import IMPACT_VELOCITY, cor_chart
from restitution.plots.figure import Array, Figure, Line, Mark, Series
from restitution.plots.law import LAW_LINES, computed_points


def theory_figure(
    title: str,
    lines: Sequence[tuple[str, bool, Array, Array]],
    marks: Mapping[str, float],
    law: Law | None = None,
) -> Figure:
    """Plot COR against velocity: one line for each theory, and the computed points of `law`.

    Each of `lines` is a tuple: the name, whether the line is a fit, the velocities (m/s), and COR.
    Lines without a finite COR are left out. `marks` maps the symbols "V_y" and "V_s" to the
    velocities (m/s) of first yield and of sticking.
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
    beside = "smooth bodies" if law is None else "smooth bodies, and fits"
    return Figure(title, [cor_chart(IMPACT_VELOCITY.axis, series)], beside)
