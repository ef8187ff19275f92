"""The figure of the oblique impacts of a run."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import xarray as xr

from restitution.case.case_file import parse_case
from restitution.impacts.oblique import full_slip_angle, full_slip_restitution
from restitution.plots.figure import (
    DASHED,
    GREY,
    PALETTE,
    SYMBOLS,
    Axis,
    Chart,
    Figure,
    Line,
    Mark,
    Points,
    Series,
)

_CURVE = 100  # number of points of a curve that is drawn from a closed form
_ROUNDS = 50  # number of fixed-point iterations for the angle of full slip


def has_oblique(results: xr.Dataset) -> bool:
    return "oblique_tangential_restitution" in results


def oblique_figure(results: xr.Dataset) -> Figure:
    """Plot tangential restitution, rebound and spin of the first body against the angle of impact.

    Lines for full slip are those of the largest impact velocity.
    """
    degrees = np.degrees(results["oblique_angle"].values)
    axis = Axis("angle of impact", "°", low=0.0, high=min(90.0, 1.05 * degrees.max() + 1))
    slip = _full_slip(results)
    charts = []
    for title, unit, variable, scale in (
        ("tangential restitution", "", "oblique_tangential_restitution", 1.0),
        ("angle of rebound", "°", "oblique_rebound_angle", math.degrees(1)),
        ("spin of the first body", "rad/s", "oblique_first_spin", 1.0),
    ):
        shown = slip if variable == "oblique_tangential_restitution" else slip[:1]
        series = [*_points(results, variable, scale), *shown]
        charts.append(Chart(axis, Axis(title, unit), series))
    return Figure(results.attrs.get("title", ""), charts)


def _points(results: xr.Dataset, variable: str, scale: float) -> Iterator[Points]:
    """Yield a series for each impact velocity; markers are open if part of the contact sticks."""
    degrees = np.degrees(results["oblique_angle"].values)
    for k, velocity in enumerate(results["oblique_velocity"].values):
        values = scale * results[variable][k].values
        error = scale * results[f"{variable}_error"][k].values
        known = np.isfinite(values)
        yield Points(
            degrees[known],
            values[known],
            f"{velocity:.4g} m/s",
            color=PALETTE[k % len(PALETTE)],
            symbol=SYMBOLS[k % len(SYMBOLS)],
            joined=True,
            error=error[known] if np.isfinite(error[known]).all() else None,
            error_label="bars: error" if k == 0 else "",
            open=results["oblique_slides"][k].values[known] == 0,
            open_label="open: sticks in part",
        )


def _full_slip(results: xr.Dataset) -> list[Series]:
    """Mark the smallest angle of full slip; beyond it, draw the closed form of e_t.

    The closed form does not include a spin before the impact.
    """
    if results["oblique_first_spin_before"].any() or results["oblique_second_spin_before"].any():
        return []
    pair = parse_case(results.attrs["case"]).pair()
    friction = float(results["oblique_friction"].max())
    e = results["oblique_normal_restitution"][-1].values
    angles = results["oblique_angle"].values[np.isfinite(e)]
    e = e[np.isfinite(e)]
    if not e.size or friction == 0:
        return []
    begins, ratio = float(angles[0]), pair.tangential_modulus / pair.contact_modulus
    for _ in range(_ROUNDS):
        begins = full_slip_angle(friction, float(np.interp(begins, angles, e)), ratio)
    slip: list[Series] = [Mark("x", math.degrees(begins), "full slip")]
    if (last := float(angles[-1])) > begins:
        beyond = np.linspace(begins, last, _CURVE)
        along = [
            full_slip_restitution(friction, float(np.interp(angle, angles, e)), float(angle))
            for angle in beyond
        ]
        label = "full slip, closed form"
        slip.append(Line(np.degrees(beyond), np.array(along), label, color=GREY, dash=DASHED))
    return slip
