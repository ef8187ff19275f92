"""Figures of a study, with one line for each case."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from restitution.curve.columns import array
from restitution.curve.point import Point
from restitution.plots.cor import Abscissa, cor_chart
from restitution.plots.figure import PALETTE, SYMBOLS, Figure, Points
from restitution.results.reader import StoredCase

MOST_LINES = 60  # largest number of lines in a figure; more cannot be distinguished


def points_with(case: StoredCase, abscissa: Abscissa) -> list[Point]:
    """Select the points of the curve of `case` at which `abscissa` has a value."""
    name = abscissa.variable
    return [point for point in case.curve.points if not math.isnan(getattr(point, name))]


def study_figure(cases: Sequence[StoredCase], abscissa: Abscissa) -> Figure:
    """Plot COR against `abscissa` for the first `MOST_LINES` of `cases`."""
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
