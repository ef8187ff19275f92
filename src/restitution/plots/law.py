"""The figure of a restitution law."""

from __future__ import annotations

import math

import numpy as np

from restitution.laws.law import Law
from restitution.plots.figure import (
    BLUE,
    DASHED,
    PALETTE,
    Axis,
    Chart,
    Figure,
    Line,
    Points,
    Series,
)
from restitution.plots.run import COR

_FINE = 400  # points of a fitted line


def law_figure(law: Law) -> Figure:
    """Plot the computed COR with its error, and the fits over the velocities they are fitted to."""
    V = law.column("velocity")
    series: list[Series] = [computed_points(law, "computed", "not resolved")]
    if law.fit is not None:
        fine = np.geomspace(law.fit.lowest, law.fit.highest, _FINE)
        label = f"compact fit (within {law.fit.worst:.1g})"
        series.append(Line(fine, law.fit.restitution(fine), label, color=BLUE))
    for k, other in enumerate(law.laws, 1):
        values = np.array([math.nan if value is None else value for value in other.restitution])
        label = f"{other.name} ({other.worst:.2g})"
        series.append(Line(V, values, label, color=PALETTE[k % len(PALETTE)], dash=DASHED))
    chart = Chart(Axis("impact velocity", "m/s", "log"), COR, series)
    return Figure(law.title, [chart], "largest difference in brackets")


def computed_points(law: Law, label: str, open_label: str) -> Points:
    """The points of `law` with their error, open where they are not resolved."""
    return Points(
        law.column("velocity"),
        law.column("restitution"),
        label,
        error=law.column("error"),
        error_label="total error",
        open=~law.column("resolved").astype(bool),
        open_label=open_label,
    )
