"""Figure of the joined power spectrum of several scans."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from restitution.plots.figure import PALETTE, Axis, Band, Chart, Figure, Line, Mark, Series
from restitution.surfaces import Surface

_Q, _C = 1e-6, 1e24  # from SI to 1/µm and µm⁴


def joined_figure(told: Mapping[str, Any], surface: Surface) -> Figure:
    """Draw a joined spectrum (`JoinedSpectrum.told`), its scans, and which waves are used where.

    Marks show the longest and the shortest wave on the grid of `surface`, and the shortest one in
    its patches.
    """
    q, C = _Q * np.array(told["wave_number"]), _C * np.array(told["density"])
    spread = np.exp(2 * np.array(told["error"]))
    series: list[Series] = [Band(q, C / spread, C * spread, "joined, two standard deviations")]
    series.append(Line(q, C, "joined", width=2.0))
    for (name, scan), color in zip(told["scans"].items(), _colours(), strict=False):
        x, y = _Q * np.array(scan["wave_number"]), _C * np.array(scan["density"])
        series.append(Line(x, np.where(y > 0, y, np.nan), name, color=color))
    series += [
        Mark("x", _Q * 2 * math.pi / wave, words, side=side)
        for wave, words, side in _limits(surface)
        if q.min() <= _Q * 2 * math.pi / wave <= q.max()
    ]
    return Figure(
        "",
        [
            Chart(
                Axis("wave number q", "1/µm", "log"),
                Axis("power spectral density C", "µm⁴", "log", 0.1 * C.min(), 10 * C.max()),
                series,
            )
        ],
    )


def _colours() -> list[str]:
    return [*PALETTE[1:], *PALETTE] * 12


def _limits(surface: Surface) -> list[tuple[float, str, Any]]:
    told = surface.provenance
    split = float(told.get("split_m", 0.0))
    ends = [(float(told.get("longest_wave_m", max(surface.grid.size))), "longest", "left")]
    if split:
        return [*ends, (split, "grid | patches", "right")]
    return [*ends, (2 * max(surface.grid.spacing), "shortest on the grid", "right")]
