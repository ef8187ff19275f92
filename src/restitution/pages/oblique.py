"""The oblique impacts of a run, as one part of its page."""

from __future__ import annotations

import math

import xarray as xr

from restitution.pages.page import Cell, Drawing, Table
from restitution.plots.oblique import oblique_figure

_NOTE = (
    "Tangential restitution and angles refer to the velocity of the centres. Spins are positive in "
    "the direction in which friction turns a body without spin. The dotted line marks the angle "
    "from which the whole contact slides. The error of the tangential restitution e_t includes the "
    "errors of the tangential law and of the normal restitution e_n."
)


def oblique_drawing(results: xr.Dataset, rows: list[dict[str, float]]) -> Drawing:
    """Draw the oblique impacts in `results`, with a table of their `rows`."""
    known = [e_t for row in rows if not math.isnan(e_t := row["tangential_restitution"])]
    ends = f"from {min(known):.3f} to {max(known):.3f} " if known else ""
    cells: list[list[Cell]] = [
        [
            row["impact_velocity_m_per_s"],
            math.degrees(row["angle_rad"]),
            row["normal_restitution"],
            row["tangential_restitution"],
            row.get("tangential_restitution_error", math.nan),
            math.degrees(row["rebound_angle_rad"]),
            row["first_spin_rad_per_s"],
            row["second_spin_rad_per_s"],
            row["friction_loss_J"],
            row["normal_loss_J"],
            "yes" if row["slides"] else "no",
        ]
        for row in rows
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
