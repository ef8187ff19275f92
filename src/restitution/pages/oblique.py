"""The oblique impacts of a run, as one part of its page."""

from __future__ import annotations

import math
from collections.abc import Sequence

import xarray as xr

from restitution.curve.oblique import ObliquePoint
from restitution.pages.page import Cell, Drawing, Table
from restitution.plots.oblique import oblique_figure

_NOTE = (
    "Tangential restitution and angles refer to the velocity of the centres. Spins are positive in "
    "the direction in which friction turns a body without spin. The dotted line marks the angle "
    "from which the whole contact slides. The error of the tangential restitution e_t includes the "
    "errors of the tangential law and of the normal restitution e_n."
)


def oblique_drawing(results: xr.Dataset, points: Sequence[ObliquePoint]) -> Drawing:
    """Draw the oblique impacts in `results`, with a table of `points`."""
    known = [e_t for point in points if not math.isnan(e_t := point.tangential_restitution)]
    ends = f"from {min(known):.3f} to {max(known):.3f} " if known else ""
    cells: list[list[Cell]] = [
        [
            point.velocity,
            math.degrees(point.angle),
            point.normal_restitution,
            point.tangential_restitution,
            point.tangential_restitution_error,
            math.degrees(point.rebound_angle),
            point.first_spin,
            point.second_spin,
            point.friction_loss,
            point.normal_loss,
            "yes" if point.slides else "no",
        ]
        for point in points
    ]
    return Drawing(
        "Oblique impacts",
        oblique_figure(results),
        f"Tangential restitution {ends}against the angle of impact, angle of rebound and spin",
        _NOTE,
        Table(
            "Oblique impacts",
            [
                "velocity (m/s)",
                "angle (°)",
                "e_n",
                "e_t",
                "± e_t",
                "rebound (°)",
                "first spin (rad/s)",
                "second spin (rad/s)",
                "friction loss (J)",
                "normal loss (J)",
                "slides",
            ],
            cells,
        ),
    )
