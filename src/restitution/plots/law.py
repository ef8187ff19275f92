"""The figure of a restitution law."""

from __future__ import annotations

import numpy as np

from restitution.laws.law import Law
from restitution.plots.cor import IMPACT_VELOCITY, bars, cor_chart
from restitution.plots.figure import (
    BLUE,
    DASHED,
    SOLID,
    Dash,
    Figure,
    Line,
    Points,
    Series,
)

# Colour, dashes and width of the line of each law. Lines that often coincide at COR = 1 differ in
# width.
LAW_LINES: dict[str, tuple[str, Dash, float]] = {
    "hertz": ("#bfbfbf", SOLID, 5.0),
    "sticking": ("#e69f00", SOLID, 3.2),
    "thornton-ning": ("#000000", SOLID, 1.4),
    "thornton-ning-force": ("#009e73", (8, 2), 1.4),
    "johnson": ("#cc79a7", (10, 1.5), 1.6),
    "mdr": ("#000080", (5, 1, 1, 1), 1.4),
    "lammps-mdr": ("#000080", (5, 1, 1, 1), 1.4),
    "constant": ("#e3d5ae", SOLID, 3.2),
    "walton-braun": ("#8c564b", DASHED, 1.2),
    "luding": ("#56b4e9", (3, 1, 1, 1, 1, 1), 1.6),
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
    """Make a marker with an error bar for each point of `law`.

    The marker is open if the grid does not resolve the contact at this point.
    """
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
