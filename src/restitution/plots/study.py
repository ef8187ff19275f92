"""Figures of a study, with one line for each case."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from restitution.plots.cor import Abscissa, cor_chart
from restitution.plots.figure import PALETTE, SYMBOLS, Figure, Points
from restitution.results.reader import StoredCase

MOST_LINES = 60  # largest number of lines in a figure; more cannot be distinguished


def rows_with(case: StoredCase, abscissa: Abscissa) -> list[dict[str, float]]:
    """Select the rows of the curve of `case` in which `abscissa` has a value."""
    return [row for row in case.curve.rows if not math.isnan(row[abscissa.column])]


def study_figure(cases: Sequence[StoredCase], abscissa: Abscissa) -> Figure:
    """Plot COR against `abscissa` for the first `MOST_LINES` of `cases`."""
    series = []
    for number, case in enumerate(cases[:MOST_LINES]):
        rows = rows_with(case, abscissa)
        if not rows:
            continue
        # The label shows only the last part of each swept key: "rms" for "roughness.rms".
        label = ", ".join(f"{key.rsplit('.', 1)[-1]} {value}" for key, value in case.swept.items())
        series.append(
            Points(
                abscissa.scale * np.array([row[abscissa.column] for row in rows]),
                np.array([row["restitution"] for row in rows]),
                label,
                color=PALETTE[number % len(PALETTE)],
                symbol=SYMBOLS[number % len(SYMBOLS)],
                joined=True,
                open=np.array([not row["resolved"] for row in rows]),
            )
        )
    return Figure("", [cor_chart(abscissa.axis, series)])
