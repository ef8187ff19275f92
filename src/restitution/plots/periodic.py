"""Figures of a periodic contact: area and gap against nominal pressure, and a pressure map."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from restitution.plots.figure import DASHED, GREY, Axis, Chart, Figure, Line, Map, Points, Series
from restitution.theory import Persson


def periodic_figures(results: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    """Yield the name and the content of every figure of `results` (from `results.nc`)."""
    if (results["nominal_pressure"].values > 0).any():
        yield "area-pressure", area_against_pressure(results)
    if results["pressure"].values.any():
        yield "pressure", _pressure_map(results)


def area_against_pressure(results: xr.Dataset) -> Figure:
    """Plot relative contact area and mean gap against nominal pressure.

    For comparison, a dashed line shows the contact area from Persson's theory of elastic contact.
    """
    title = results.attrs.get("title", "")
    # Leave out negative nominal pressures (due to attraction), because the axis is logarithmic.
    results = results.isel(depth=results["nominal_pressure"].values > 0)
    pressure = results["nominal_pressure"].values
    p = 1e-6 * pressure
    along = Axis("nominal pressure", "MPa", "log")
    area = 100 * results["corrected_relative_area"].values
    unresolved = ~results["resolved"].values.astype(bool)
    series: list[Series] = [Points(p, area, "this contact", joined=True, open=unresolved)]
    slope = float(results.attrs["derived_rms_slope"])
    E_star = float(results.attrs["derived_contact_modulus_Pa"])
    if slope > 0:
        theory = 100 * Persson(slope, E_star).relative_area(pressure)
        series.append(Line(p, theory, "elastic, Persson (2001)", color=GREY, dash=DASHED))
    gap = Points(p, 1e9 * results["mean_gap"].values, joined=True)
    return Figure(
        title,
        [
            Chart(along, Axis("relative contact area", "%", "log"), series),
            Chart(along, Axis("mean gap", "nm"), [gap]),
        ],
    )


def _pressure_map(results: xr.Dataset) -> Figure:
    values = 1e-6 * np.where(results["pressure"].values > 0, results["pressure"].values, np.nan)
    x, y = (1e6 * results[name].values for name in ("x", "y"))
    down = results.attrs.get("surface_y_axis") == "down"
    axis = Axis("contact pressure", "MPa")
    return Figure(results.attrs.get("title", ""), [Map(x, y, values, axis, downwards=down)])
