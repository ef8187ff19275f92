"""What each scan adds to a joined spectrum: parts of the pages of a surface and of a run."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from restitution.display import quantity
from restitution.pages.page import Cell, Drawing, PageTable
from restitution.plots.joined import joined_figure
from restitution.surfaces import Surface

_KEYS = ("name", "kind", "edge_m", "pixel_m", "shortest_m", "longest_m", "ends_at", "rms_m")
_COLUMNS = ["scan", "kind", "edge", "pixel", "shortest wave", "longest wave"]


def of_scans(provenance: Mapping[str, Any]) -> Iterator[PageTable]:
    """Yield a table for each joined spectrum in the provenance of a surface."""
    starts = [key.removesuffix("scan_1_name") for key in provenance if key.endswith("scan_1_name")]
    for before in starts:
        rows: list[list[Cell]] = []
        while f"{before}scan_{len(rows) + 1}_name" in provenance:
            one = f"{before}scan_{len(rows) + 1}_"
            rows.append([_cell(key, provenance[f"{one}{key}"]) for key in (*_KEYS, "slope")])
        overlaps = [
            str(value)
            for key, value in provenance.items()
            if key.removeprefix(before).startswith("overlap_")
        ]
        yield PageTable(
            "Scans",
            [*_COLUMNS, "shorter waves end at", "Rq of these waves", "rms slope of these"],
            rows,
            ["Waves that each scan shows, in the joined power spectrum.", *overlaps],
        )


def _cell(key: str, value: Cell) -> Cell:
    if key.endswith("_m") and isinstance(value, float):
        return quantity(value, "m")
    return value


def joined_drawing(told: Mapping[str, Any], surface: Surface) -> Drawing:
    """The joined spectrum (`JoinedSpectrum.told`) with its scans."""
    q, C, error = (told[key] for key in ("wave_number", "density", "error"))
    rows: list[list[Cell]] = [
        [1e-6 * a, 2e6 * math.pi / a, 1e24 * b, c] for a, b, c in zip(q, C, error, strict=True)
    ]
    return Drawing(
        "Joined power spectrum",
        joined_figure(told, surface),
        "Joined power spectral density and that of each scan against wave number",
        "Smoothest curve through the spectra of all scans in the waves that each of them shows, "
        "after correction for levelling and tapers. Line scans are shown as isotropic spectra.",
        PageTable(
            "Joined spectrum",
            ["q (1/µm)", "wave length (µm)", "C (µm⁴)", "standard deviation of ln C"],
            rows,
        ),
    )
