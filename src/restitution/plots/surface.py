"""Figures of one surface."""

from __future__ import annotations

import numpy as np

from restitution.plots.figure import (
    DASH_DOTTED,
    DASHED,
    DOTTED,
    PALETTE,
    SOLID,
    Axis,
    Chart,
    Figure,
    Line,
    Map,
    Mark,
    Series,
)
from restitution.surfaces import Surface
from restitution.surfaces.psd import DirectedSpectrum
from restitution.surfaces.texture import Autocorrelation, HeightDensity, MaterialRatio

_ROUNDING = 1e-15  # spectral densities below this fraction of the largest one are rounding errors


def surface_map(surface: Surface, title: str = "") -> Figure:
    height = 1e9 * (surface.height - surface.height.mean())
    down = surface.provenance.get("y_axis") == "down"
    x, y = 1e6 * surface.grid.x, 1e6 * surface.grid.y
    return Figure(title, [Map(x, y, height, Axis("height", "nm"), "cividis", downwards=down)])


def height_distribution(density: HeightDensity, curve: MaterialRatio) -> Figure:
    x = 1e9 * density.height
    return Figure(
        "",
        [
            Chart(
                Axis("height above the mean", "nm"),
                Axis("probability density", "1/nm", low=0.0),
                [
                    Line(x, 1e-9 * density.density, "heights", step=True),
                    Line(
                        x, 1e-9 * density.normal, "normal, same Sq", color=PALETTE[1], dash=DASHED
                    ),
                    Line(
                        1e9 * curve.height,
                        100 * curve.ratio,
                        "material ratio (right)",
                        color=PALETTE[2],
                        dash=DASH_DOTTED,
                        right=True,
                    ),
                ],
                right=Axis("material ratio", "%", low=0.0, high=100.0),
            )
        ],
    )


def autocorrelation_figure(R: Autocorrelation) -> Figure:
    """Plot the autocorrelation along x and y, and the levels that define correlation lengths."""
    i, j = (n // 2 for n in R.values.shape)
    series: list[Series] = [
        Line(1e6 * R.x[i:], R.values[i:, j], "along x", color=PALETTE[0]),
        Line(1e6 * R.y[j:], R.values[i, j:], "along y", color=PALETTE[1], dash=DASHED),
        Mark("y", 0.2, "0.2 (Sal)"),
        Mark("y", 0.1, "0.1 (Hu and Tonder)"),
    ]
    return Figure("", [Chart(Axis("lag", "µm"), Axis("autocorrelation"), series)])


def spectrum_figure(spectra: list[DirectedSpectrum]) -> Figure:
    series: list[Line] = []
    largest = 0.0
    for spectrum, color, dash in zip(spectra, PALETTE, (SOLID, DOTTED, DASHED), strict=False):
        q, C = 1e-6 * spectrum.spectrum.wave_number, 1e24 * spectrum.spectrum.density
        largest = max(largest, C.max(initial=0.0))
        # A logarithmic axis cannot show zero.
        series.append(
            Line(q, np.where(C > 0, C, np.nan), spectrum.directions, color=color, dash=dash)
        )
    drawn = np.concatenate([spectrum.y[spectrum.y > _ROUNDING * largest] for spectrum in series])
    low, high = (0.3 * drawn.min(), 3 * drawn.max()) if drawn.size else (None, None)
    return Figure(
        "",
        [
            Chart(
                Axis("wave number q", "1/µm", "log"),
                Axis("power spectral density C", "µm⁴", "log", low, high),
                series,
            )
        ],
    )
