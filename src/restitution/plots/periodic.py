"""Figures of a periodic contact: area, gap, stiffness and local pressures at nominal pressures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from restitution.compare.area_theory import AreaTheory
from restitution.display import quantity
from restitution.plots.figure import (
    DASHED,
    GREY,
    PALETTE,
    Array,
    Axis,
    Chart,
    Figure,
    Line,
    Map,
    Points,
    Series,
)
from restitution.theory import Persson

_NOMINAL = Axis("nominal pressure", "MPa", "log")
_MERGED = 2  # number of stored bins that are drawn as one
_SHOWN = 4  # number of depths whose distributions of pressure are drawn


def periodic_figures(results: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    """Yield the name and the content of every figure of `results` (from `results.nc`)."""
    if _pressed(results).sizes["depth"]:
        yield "area-pressure", area_against_pressure(results)
        if has_stiffness(results):
            yield "stiffness-pressure", stiffness_against_pressure(results)
    if has_distribution(results):
        yield "pressure-distribution", pressure_distribution(results)
    if results["pressure"].values.any():
        yield "pressure", pressure_map(results)


def has_stiffness(results: xr.Dataset) -> bool:
    """Whether `results` contain a stiffness that can be drawn on logarithmic axes."""
    return "stiffness" in results and bool((_pressed(results)["stiffness"].values > 0).any())


def has_distribution(results: xr.Dataset) -> bool:
    return "pressure_density" in results and bool(results["pressure_density"].values.any())


def persson(results: xr.Dataset) -> Persson | None:
    """Persson's theory for the roughness and the bodies of `results`; None without roughness."""
    slope, E_star = (
        float(results.attrs[f"derived_{name}"]) for name in ("rms_slope", "contact_modulus_Pa")
    )
    return Persson(slope, E_star) if slope > 0 else None


def _pressed(results: xr.Dataset) -> xr.Dataset:
    """The depths with a positive nominal pressure; attraction can make it negative."""
    return results.isel(depth=results["nominal_pressure"].values > 0)


def area_against_pressure(results: xr.Dataset) -> Figure:
    pressed = _pressed(results)
    p = 1e-6 * pressed["nominal_pressure"].values
    area = 100 * pressed["corrected_relative_area"].values
    unresolved = ~pressed["resolved"].values.astype(bool)
    series: list[Series] = [
        Points(p, area, "this contact", joined=True, open=unresolved, open_label="not resolved")
    ]
    if theory := persson(results):
        line = 100 * theory.relative_area(pressed["nominal_pressure"].values)
        series.append(Line(p, line, "elastic, Persson (2001)", color=GREY, dash=DASHED))
    gap = Points(p, 1e9 * pressed["mean_gap"].values, joined=True)
    return Figure(
        results.attrs.get("title", ""),
        [
            Chart(_NOMINAL, Axis("relative contact area", "%", "log"), series),
            Chart(_NOMINAL, Axis("mean gap", "nm"), [gap]),
        ],
    )


def area_theory_figure(areas: AreaTheory) -> Figure:
    p = areas.pressure
    fine = np.geomspace(p.min(), p.max(), 200) if p.size > 1 else p
    line = 100 * areas.theory.relative_area(fine)
    series: list[Series] = [
        Line(1e-6 * fine, line, "elastic, Persson (2001)", color=GREY, dash=DASHED)
    ]
    if (areas.computed >= 0).any():
        series.insert(0, Points(1e-6 * p, 100 * areas.computed, "this contact", joined=True))
    axis = Axis("relative contact area", "%", "log")
    return Figure(areas.title, [Chart(_NOMINAL, axis, series)])


def stiffness_against_pressure(results: xr.Dataset) -> Figure:
    pressed = _pressed(results)
    pressed = pressed.isel(depth=pressed["stiffness"].values > 0)
    p, k = 1e-6 * pressed["nominal_pressure"].values, 1e-15 * pressed["stiffness"].values
    guide = Line(p, k[0] * p / p[0], "proportional to pressure", color=GREY, dash=DASHED)
    points = Points(p, k, "this contact", joined=True)
    axis = Axis("normal stiffness", "MPa/nm", "log")
    return Figure(results.attrs.get("title", ""), [Chart(_NOMINAL, axis, [points, guide])])


def pressure_distribution(results: xr.Dataset) -> Figure:
    title, theory = results.attrs.get("title", ""), persson(results)
    carrying = np.flatnonzero(results["pressure_density"].values.any(axis=1))
    shown = carrying[np.unique(np.linspace(0, carrying.size - 1, _SHOWN).round().astype(int))]
    series: list[Series] = []
    lines: list[Series] = []
    for number, colour in zip(shown, PALETTE, strict=False):
        depth = results.isel(depth=int(number))
        local, density = (
            depth[name].values.reshape(-1, _MERGED).mean(axis=1)
            for name in ("binned_pressure", "pressure_density")
        )
        nominal = float(depth["nominal_pressure"])
        label = f"at {quantity(nominal, 'Pa')}"
        # A logarithmic axis has no zero.
        shares = 1e9 * np.where(density > 0, density, np.nan)
        series.append(Line(1e-9 * local, shares, label, label, color=colour, step=True))
        if theory is not None and nominal > 0:
            fine: Array = np.linspace(0.1 * local.max(), local.max(), 200)
            line = 1e9 * theory.pressure_density(fine, nominal)
            name = "elastic, Persson (2001)"
            lines.append(Line(1e-9 * fine, line, name, label, colour, DASHED))
    axes = Axis("contact pressure", "GPa"), Axis("fraction of nominal area", "1/GPa", "log")
    return Figure(title, [Chart(*axes, series + lines)])


def pressure_map(results: xr.Dataset) -> Figure:
    """Draw a map of the contact pressure at the deepest state; tension and gaps are left blank."""
    values = 1e-6 * np.where(results["pressure"].values > 0, results["pressure"].values, np.nan)
    x, y = (1e6 * results[name].values for name in ("x", "y"))
    down = results.attrs.get("surface_y_axis") == "down"
    axis = Axis("contact pressure", "MPa")
    return Figure(results.attrs.get("title", ""), [Map(x, y, values, axis, downwards=down)])
