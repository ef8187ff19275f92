"""The page of a periodic contact."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from restitution.display import counted, quantity
from restitution.pages.methods import methods
from restitution.pages.page import Answer, Cell, Drawing, Listing, Page, PageTable, write_page
from restitution.pages.run import groups, maps_drawing, pressure_percentiles
from restitution.pages.words import share, si, table_of
from restitution.plots.periodic import (
    area_against_pressure,
    has_distribution,
    has_stiffness,
    persson,
    pressure_distribution,
    pressure_map,
    stiffness_against_pressure,
)
from restitution.results.periodic import PeriodicResults
from restitution.results.tables import has_maps

_PERCENTILES = (10, 50, 90, 99)


def write_periodic_page(out: Path) -> Path:
    """Write `report.html` from the `results.nc` and `summary.json` in `out`."""
    stored = PeriodicResults(out)
    results, summary = stored.dataset, stored.summary
    drawings: list[Drawing] = []
    if (results["nominal_pressure"].values > 0).any():
        drawings.append(_area(results))
        if has_stiffness(results):
            drawings.append(_stiffness(results))
    if has_distribution(results):
        drawings.append(_distribution(results))
    if results["pressure"].values.any():
        drawings.append(_map(results))
        if has_maps(out):
            drawings.append(maps_drawing(stored.maps, results))
    page = Page(
        title=summary["title"] or "Periodic contact",
        intro=[_in_words(summary)],
        warnings=summary["warnings"],
        answer=Answer(_line(results), [_bodies(summary)], _states(results)),
        top=drawings[:1],  # two panels
        parts=drawings[1:],
        details=[
            *groups(summary),
            _diagnostics(results, summary),
            Listing("Case file", results.attrs["case"]),
            methods(summary),
        ],
    )
    return write_page(out / "report.html", page)


def _line(results: xr.Dataset) -> str:
    """Contact area and gap in the middle of the computed pressures."""
    p, gap, area = _columns(results, "nominal_pressure", "mean_gap", "corrected_relative_area")
    pressed = np.flatnonzero(p > 0)
    if not pressed.size:
        return ""
    k = int(pressed[pressed.size // 2])
    return (
        f"{share(float(area[k]))} in contact at {si(float(p[k]), 'Pa')}, mean gap "
        f"{si(float(gap[k]), 'm')}"
    )


def _bodies(summary: Mapping[str, Any]) -> str:
    statistics, derived = summary["surface_statistics"], summary["derived"]
    return (
        f"E* {si(derived['contact_modulus_Pa'], 'Pa')}, yield pressure "
        f"{si(derived['yield_pressure_Pa'], 'Pa')}; Sq {si(statistics['Sq_m'], 'm')}, rms slope "
        f"{statistics['Sdq']:.3g}"
    )


def _in_words(summary: Mapping[str, Any]) -> str:
    nx, ny = summary["model"]["nodes"]
    hx, hy = (quantity(h, "m") for h in summary["model"]["spacing"])
    ended = "" if summary["status"] == "complete" else f"; {summary['status']}: {summary['reason']}"
    depths = f"{summary['depths_computed']} of {counted(summary['depths_asked'], 'depth')}"
    return f"Periodic contact, {depths}; {nx} × {ny} nodes of {hx} × {hy}{ended}"


def _columns(results: xr.Dataset, *names: str) -> list[np.ndarray[Any, np.dtype[np.float64]]]:
    empty = np.full(results.sizes["depth"], np.nan)
    return [results[name].values if name in results else empty for name in names]


def _states(results: xr.Dataset) -> PageTable:
    theory = persson(results)
    names = ("nominal_pressure", "mean_gap", "corrected_relative_area", "largest_pressure")
    rows: list[list[Cell]] = [
        [
            quantity(p, "Pa"),
            quantity(gap, "m"),
            share(area),
            "–" if theory is None else share(float(theory.relative_area(p))),
            quantity(most, "Pa"),
            _stiffness_cell(k),
            "yes" if resolved else "no",
        ]
        for p, gap, area, most, k, resolved in zip(
            *(values.tolist() for values in _columns(results, *names, "stiffness", "resolved")),
            strict=True,
        )
    ]
    columns = [
        "nominal pressure",
        "mean gap",
        "contact area",
        "Persson",
        "largest pressure",
        "stiffness (MPa/nm)",
        "resolved",
    ]
    return PageTable("Results", columns, rows)


def _stiffness_cell(k: float) -> str:
    return "–" if np.isnan(k) else f"{1e-15 * k:.4g}"


def _area(results: xr.Dataset) -> Drawing:
    p, gap, area, nodes = _columns(
        results, "nominal_pressure", "mean_gap", "corrected_relative_area", "relative_area"
    )
    few = int(np.count_nonzero(~results["resolved"].values.astype(bool)))
    return Drawing(
        "Contact area and mean gap",
        area_against_pressure(results),
        f"Relative contact area up to {100 * area.max():.3g} % and mean gap down to "
        f"{quantity(float(gap.min()), 'm')} against nominal pressure",
        "The area is corrected for the staircase edge of the contact. The dashed line is Persson's "
        "theory of elastic contact, with the rms slope of this surface. "
        f"Open markers ({few} of {p.size}): not resolved by the grid.",
        PageTable(
            "Area and gap",
            ["nominal pressure (MPa)", "area (%)", "area of the nodes (%)", "mean gap (nm)"],
            np.column_stack([1e-6 * p, 100 * area, 100 * nodes, 1e9 * gap]).tolist(),
        ),
    )


def _stiffness(results: xr.Dataset) -> Drawing:
    p, k = _columns(results, "nominal_pressure", "stiffness")
    known = (p > 0) & (k > 0)
    length = p[known][0] / k[known][0]
    rms = float(results["height"].std())
    return Drawing(
        "Normal stiffness",
        stiffness_against_pressure(results),
        f"Normal stiffness up to {1e-15 * k[known].max():.3g} MPa/nm against nominal pressure",
        "Increase of the nominal pressure per approach of the mean planes, at a constant contact "
        "area. The mean compression of the bodies is left out. At low pressure the stiffness is "
        "nearly proportional to the pressure (Persson 2007, Phys. Rev. Lett. 99, 125502; Akarapu, "
        "Sharp and Robbins 2011, Phys. Rev. Lett. 106, 204301): pressure over stiffness is a "
        f"length, here {quantity(float(length), 'm')} or {length / rms:.2g} times the rms height "
        "at the smallest pressure.",
        PageTable(
            "Stiffness",
            ["nominal pressure (MPa)", "stiffness (MPa/nm)", "pressure/stiffness (nm)"],
            np.column_stack([1e-6 * p, 1e-15 * k, 1e9 * p / k])[known].tolist(),
        ),
    )


def _distribution(results: xr.Dataset) -> Drawing:
    pressure, density = results["binned_pressure"].values, results["pressure_density"].values
    rows: list[list[Cell]] = []
    for nominal, local, shares in zip(
        results["nominal_pressure"].values, pressure, density, strict=True
    ):
        below = np.cumsum(shares)
        if below[-1] > 0:
            at = [np.searchsorted(below, 0.01 * share * below[-1]) for share in _PERCENTILES]
            rows.append([1e-6 * float(nominal), *(1e-6 * float(local[k]) for k in at)])
    return Drawing(
        "Distribution of the contact pressure",
        pressure_distribution(results),
        f"Fraction of the nominal area per contact pressure, up to "
        f"{quantity(float(pressure.max()), 'Pa')}",
        "The area under a curve is the relative contact area. Dashed: Persson's theory of elastic "
        "contact at the same nominal pressure.",
        PageTable(
            "Percentiles of the contact pressure (MPa)",
            ["nominal pressure (MPa)", *(f"{share} %" for share in _PERCENTILES)],
            rows,
        ),
    )


def _map(results: xr.Dataset) -> Drawing:
    most = float(results["pressure"].max())
    return Drawing(
        "Contact pressure",
        pressure_map(results),
        f"Map of the contact pressure at the last depth, up to {quantity(most, 'Pa')}",
        "At the last depth, over one period; areas without contact are blank.",
        pressure_percentiles(results),
    )


def _diagnostics(results: xr.Dataset, summary: Mapping[str, Any]) -> PageTable:
    resolved = results["resolved"].values.astype(bool)
    return table_of(
        "Diagnostics",
        {
            "largest_residual": summary["diagnostics"]["largest_residual"],
            "depths_resolved": f"{np.count_nonzero(resolved)} of {resolved.size}",
            "convolutions": summary["convolutions"],
        },
    )
