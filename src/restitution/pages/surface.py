"""The page of one surface, from the files of `restitution surface`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np

from restitution.display import quantity
from restitution.numerics.grid import Grid
from restitution.pages.page import Cell, Drawing, Page, PageTable, write_page
from restitution.pages.scans import joined_drawing, of_scans
from restitution.pages.words import table_of
from restitution.plots.figure import Map
from restitution.plots.interactive import shown_step
from restitution.plots.surface import (
    autocorrelation_figure,
    height_distribution,
    spectrum_figure,
    surface_map,
)
from restitution.results.stored_files import read_json, read_netcdf
from restitution.surfaces import Surface
from restitution.surfaces.psd import directed_spectra
from restitution.surfaces.surface import is_periodic
from restitution.surfaces.texture import autocorrelation, height_density, material_ratio

_LAY = 0.5  # texture aspect ratio below which a surface has a lay

# For each parameter: name, clause of ISO 25178-2:2012, unit in the table, factor from SI to this
# unit, and the key under which the provenance of the surface holds the requested value.
PARAMETERS: dict[str, tuple[str, str, str, float, str]] = {
    "Sq_m": ("root mean square height Sq", "4.1.1", "nm", 1e9, "rms_m"),
    "Ssk": ("skewness Ssk", "4.1.2", "", 1, "skewness"),
    "Sku": ("kurtosis Sku", "4.1.3", "", 1, "kurtosis"),
    "Sp_m": ("maximum peak height Sp", "4.1.4", "nm", 1e9, ""),
    "Sv_m": ("maximum pit height Sv", "4.1.5", "nm", 1e9, ""),
    "Sz_m": ("maximum height Sz", "4.1.6", "nm", 1e9, ""),
    "Sa_m": ("arithmetical mean height Sa", "4.1.7", "nm", 1e9, ""),
    "Sal_m": ("autocorrelation length Sal", "4.2.1", "µm", 1e6, ""),
    "Str": ("texture aspect ratio Str", "4.2.2", "", 1, ""),
    "lay_deg": ("direction of slowest decay, from x", "–", "°", 1, "lay_rad"),
    "Sdq": ("root mean square gradient Sdq", "4.3.1", "", 1, ""),
    "Sdr": ("developed interfacial area ratio Sdr", "4.3.2", "%", 100, ""),
    "Sk_m": ("core height Sk", "5.2", "nm", 1e9, ""),
    "Spk_m": ("reduced peak height Spk", "5.3", "nm", 1e9, ""),
    "Svk_m": ("reduced dale height Svk", "5.4", "nm", 1e9, ""),
    "Smr1": ("peak material ratio Smr1", "5.5", "%", 100, ""),
    "Smr2": ("dale material ratio Smr2", "5.5", "%", 100, ""),
    "rms_curvature_per_m": ("rms curvature", "–", "1/µm", 1e-6, ""),
    "correlation_length_x_m": (
        "lag of 10 % autocorrelation along x",
        "–",
        "µm",
        1e6,
        "correlation_length_x_m",
    ),
    "correlation_length_y_m": (
        "lag of 10 % autocorrelation along y",
        "–",
        "µm",
        1e6,
        "correlation_length_y_m",
    ),
}


def write_surface_page(out: Path) -> Path:
    """Write `surface.html` from the `surface.nc` and `statistics.json` in `out`."""
    dataset, statistics = read_netcdf(out / "surface.nc"), read_json(out / "statistics.json")
    provenance = statistics["provenance"]
    nodes = dataset.sizes["x"], dataset.sizes["y"]
    hx, hy = (float(provenance[f"spacing_{axis}_m"]) for axis in ("x", "y"))
    surface = Surface(dataset["height"].values, Grid(nodes, (hx, hy)), provenance)
    size = " × ".join(quantity(edge, "m") for edge in surface.grid.size)
    page = Page(
        title=dataset.attrs.get("title") or "Surface",
        intro=[
            f"{nodes[0]} × {nodes[1]} nodes, spacing {quantity(hx, 'm')} × {quantity(hy, 'm')}, "
            f"edge lengths {size}; "
            f"{provenance.get('kind') or provenance.get('source', 'surface')}"
        ],
        warnings=list(statistics.get("warnings", [])),
        parts=[
            _map(surface),
            _parameters(statistics, provenance),
            _heights(surface, statistics),
            _autocorrelation(surface),
            _spectrum(surface),
            *map(joined_drawing, statistics.get("joined_spectra", []), repeat(surface)),
        ],
        details=[
            *of_scans(provenance),
            table_of("Origin", {k: value for k, value in provenance.items() if k != "notice"}),
            _methods(surface),
        ],
    )
    return write_page(out / "surface.html", page)


def _map(surface: Surface) -> Drawing:
    figure = surface_map(surface)
    (drawn,) = (panel for panel in figure.panels if isinstance(panel, Map))
    step = shown_step(drawn)
    x, y, z = drawn.x[::step], drawn.y[::step], drawn.values[::step, ::step]
    every = "" if step == 1 else f" One node in {step} along x and y is drawn."
    low, high = z.min(), z.max()
    across = [0, x.size // 4, x.size // 2, 3 * x.size // 4, x.size - 1]
    return Drawing(
        "Height map",
        figure,
        f"Map of heights from {low:.4g} to {high:.4g} nm about their mean",
        f"Heights above their mean.{every} The table has a few profiles along y; all heights are "
        "in surface.nc.",
        PageTable(
            "Profiles along y",
            ["y (µm)", *(f"x = {x[i]:.4g} µm" for i in across)],
            [[float(y[j]), *(float(z[i, j]) for i in across)] for j in range(0, y.size, 8)],
        ),
    )


def scaled_parameter(key: str, statistics: Mapping[str, Any]) -> float | None:
    """The parameter `key` of `statistics` in its unit of `PARAMETERS`; None if it is undefined."""
    if key == "lay_deg" and (statistics.get("Str") or 1.0) >= _LAY:
        return None  # the direction of a surface without a lay is arbitrary
    return _scaled(statistics.get(key), PARAMETERS[key][3])


def _parameters(statistics: Mapping[str, Any], provenance: Mapping[str, Any]) -> PageTable:
    rows: list[list[Cell]] = []
    for key, (name, clause, unit, factor, requested) in PARAMETERS.items():
        value, wanted = scaled_parameter(key, statistics), provenance.get(requested)
        if key == "lay_deg":
            wanted = None if value is None or wanted is None else math.degrees(float(wanted))
        rows.append(
            [
                name,
                value,
                unit,
                clause,
                _scaled(wanted, factor),
                _scaled(provenance.get(f"scan_{key}"), factor),
            ]
        )
    of_scan = any(row[-1] is not None for row in rows)
    columns = ["parameter", "value", "unit", "ISO 25178-2", "requested", "of the scan"]
    return PageTable(
        "Parameters",
        columns if of_scan else columns[:-1],
        rows if of_scan else [row[:-1] for row in rows],
        [
            "These parameters describe the surface that the contact uses, after the steps under "
            "“Origin” and without further filters."
        ],
    )


def _scaled(value: object, factor: float) -> float | None:
    return factor * float(value) if isinstance(value, (int, float)) else None


def _heights(surface: Surface, statistics: Mapping[str, Any]) -> Drawing:
    density = height_density(surface)
    columns = [1e9 * density.height, 1e-9 * density.density, 1e-9 * density.normal]
    return Drawing(
        "Distribution of heights",
        height_distribution(density, material_ratio(surface, 201)),
        f"Histogram of heights with a skewness of {_number(statistics['Ssk'])} and a kurtosis of "
        f"{_number(statistics['Sku'])} beside the normal distribution, and the material ratio",
        "Heights beside the normal distribution of the same Sq, and (right axis) the material "
        "ratio (Abbott curve): the fraction of the surface that is higher.",
        PageTable(
            "Heights",
            ["height (nm)", "density (1/nm)", "normal (1/nm)"],
            np.column_stack(columns).tolist(),
        ),
    )


def _autocorrelation(surface: Surface) -> Drawing:
    R = autocorrelation(surface)
    i, j = (n // 2 for n in surface.grid.nodes)
    rows: list[list[Cell]] = []
    for name, lag, values in (("x", R.x[i:], R.values[i:, j]), ("y", R.y[j:], R.values[i, j:])):
        points = zip(1e6 * lag[:100], values[:100], strict=True)
        rows += [[name, float(t), float(v)] for t, v in points]
    return Drawing(
        "Autocorrelation",
        autocorrelation_figure(R),
        "Autocorrelation of the heights against the lag along x and y",
        "Along both axes, with the levels that define the autocorrelation length Sal and the "
        "correlation length of the generators; "
        + (
            "averaged over the period."
            if is_periodic(surface)
            else "averaged over all pairs of pixels."
        ),
        PageTable("Autocorrelation", ["along", "lag (µm)", "autocorrelation"], rows),
    )


def _spectrum(surface: Surface) -> Drawing:
    spectra = directed_spectra(surface)
    rows: list[list[Cell]] = [
        [directed.directions, 1e-6 * float(q), 2e6 * math.pi / float(q), 1e24 * float(C)]
        for directed in spectra
        for q, C in zip(*directed.spectrum, strict=True)
    ]
    return Drawing(
        "Power spectral density",
        spectrum_figure(spectra),
        "Power spectral density against wave number, averaged over all directions and near x and y",
        "C(q) = |∫ z exp(−iq·r) d²r|²/A, so that Sq² = (2π)⁻²∫C d²q; averaged over bands of a "
        "quarter of an octave. "
        + (
            "Exact for this periodic surface."
            if is_periodic(surface)
            else "An estimate with nine sine tapers, because the surface is not periodic."
        ),
        PageTable("Spectrum", ["directions", "q (1/µm)", "wave length (µm)", "C (µm⁴)"], rows),
    )


def _methods(surface: Surface) -> PageTable:
    spectrum = "" if is_periodic(surface) else ", sine tapers of Riedel and Sidorenko (1995)"
    return PageTable(
        "Methods",
        ["quantity", "method", "source"],
        [
            [
                "height, hybrid parameters",
                "over all nodes, slopes from node to node",
                "ISO 25178-2:2012, 4.1, 4.3",
            ],
            [
                "Sal, Str",
                "first lag with an autocorrelation of 0.2, in 180 directions",
                "ISO 25178-2:2012, 4.2",
            ],
            [
                "Sk, Spk, Svk, Smr1, Smr2",
                "flattest secant over 40 % of the material ratio curve",
                "ISO 25178-2:2012, 5.2–5.5; ISO 13565-2",
            ],
            [
                "correlation length",
                "autocorrelation of 10 %",
                "Hu and Tonder (1992), Int. J. Mach. Tools Manufact. 32, 83–90",
            ],
            [
                "power spectral density",
                "convention and radial average" + spectrum,
                "Jacobs, Junge and Pastewka (2017), Surf. Topogr. 5, 013001",
            ],
        ],
    )


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"
