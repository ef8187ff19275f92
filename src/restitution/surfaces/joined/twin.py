"""Statistical twin of several scans: a random surface of any size with their joined spectrum."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from restitution.display import quantity
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.describe import rms_slope
from restitution.surfaces.joined.places import scatter_between_places
from restitution.surfaces.joined.scan_spectrum import ScanSpectrum
from restitution.surfaces.joined.spectrum import JoinedSpectrum
from restitution.surfaces.level import level
from restitution.surfaces.resample import carried, crop_to, spline
from restitution.surfaces.surface import Array, Surface
from restitution.surfaces.twin import adjusted_heights
from restitution.surfaces.wave_spectrum import TwinWaves

_PERIODS = 2  # period of the twin, in edges of the grid, at most
# Longer waves are almost paraboloids on the grid. They are summed on a coarse grid of this period
# (in edges of the twin's period) and number of nodes; longer ones are left out.
_LONG, _LONG_NODES = 8, 64
_FINER = 10.0  # waves that no scan shows are named down to the shortest wave divided by this


@dataclass(frozen=True)
class IsotropicWaves(TwinWaves):
    """The waves of a twin with a joined spectrum."""

    spectrum: JoinedSpectrum

    def power(self, m: NDArray[np.int64], n: NDArray[np.int64]) -> Array:
        """Mean square height (m²) of each wave (m, n), shape (m.size, n.size)."""
        x, y = self.period
        q = 2 * math.pi * np.hypot(m[:, None] / x, n[None, :] / y)
        return np.asarray(self.spectrum.at(q.ravel()).reshape(q.shape) / (x * y))


def twin_of_scans(
    spectrum: JoinedSpectrum, grid: Grid, seed: int, *, periodic: bool = False
) -> Surface:
    """Make a twin with the waves of `spectrum` on `grid`.

    Heights are distributed as those of the scan that shows most of the mean square height. Waves
    longer than 16 times the grid are left out, and the mean plane of those longer than twice the
    grid; if `periodic`, all that are longer than the grid.

    Raises `SurfaceError` if the cells are too large for any wave.
    """
    cells = 2 * max(grid.spacing)
    if cells >= spectrum.longest:
        raise SurfaceError(
            f"grid: cells of {quantity(max(grid.spacing), 'm')} cannot resolve any wave of scans "
            f"of up to {quantity(spectrum.longest, 'm')}; use a smaller spacing"
        )
    most = 1 if periodic else _PERIODS
    times = [min(most, math.ceil(spectrum.longest / edge * (1 - 1e-9))) for edge in grid.size]
    whole = Grid((grid.nodes[0] * times[0], grid.nodes[1] * times[1]), grid.spacing)
    half = 0.5 * spectrum.shortest
    waves = IsotropicWaves((half, half), whole.size, spectrum)
    scan = _of_heights(spectrum, whole)
    height = adjusted_heights(waves, scan, whole, seed)
    made = Surface(np.ascontiguousarray(crop_to(height, grid.nodes)), grid)
    longest = min(spectrum.longest, max(whole.size))
    if not periodic and spectrum.longest > max(whole.size) * (1 + 1e-9):
        long, longest = _longer_waves(spectrum, whole, grid, seed)
        made = replace(made, height=made.height + long)
    closed = whole == grid and longest <= max(whole.size) * (1 + 1e-9)
    return replace(made, provenance=_provenance(spectrum, made, longest, seed, periodic=closed))


@dataclass(frozen=True)
class _LongerWaves(IsotropicWaves):
    """Waves longer than `beyond` (m)."""

    beyond: float

    def power(self, m: NDArray[np.int64], n: NDArray[np.int64]) -> Array:
        x, y = self.period
        q = 2 * math.pi * np.hypot(m[:, None] / x, n[None, :] / y)
        return np.where(q < 2 * math.pi / self.beyond * (1 - 1e-9), super().power(m, n), 0.0)


def _longer_waves(
    spectrum: JoinedSpectrum, whole: Grid, grid: Grid, seed: int
) -> tuple[Array, float]:
    """Heights (m) of the waves longer than `whole` on `grid` without a plane, and the longest."""
    n = _LONG_NODES
    period = tuple(_LONG * edge for edge in whole.size)
    coarse = Grid((n, n), (period[0] / n, period[1] / n))
    waves = _LongerWaves(coarse.spacing, coarse.size, spectrum, max(whole.size))
    height = adjusted_heights(waves, None, coarse, seed + 1)
    to = spline(height, (coarse.x, coarse.y), (grid.x, grid.y))
    flat = level(Surface(np.ascontiguousarray(to), grid), "tilt")
    return flat.height, min(spectrum.longest, max(coarse.size))


def carrier(spectrum: JoinedSpectrum) -> ScanSpectrum | None:
    """The scan that shows most of the mean square height; None if it is a line scan."""
    best = max(spectrum.scans, key=lambda scan: scan.rms)
    scan = next(one for one in spectrum.spectra if one.name == best.name)
    return None if scan.line else scan


def _of_heights(spectrum: JoinedSpectrum, whole: Grid) -> Surface | None:
    """The scan whose heights the twin has, without waves that are too long for it."""
    scan = carrier(spectrum)
    if scan is None:
        return None
    cell = 0.5 * max(whole.size)
    if cell >= 0.5 * scan.edge:
        return scan.surface
    return replace(scan.surface, height=scan.surface.height - carried(scan.surface, (cell, cell)))


def _between_places(spectrum: JoinedSpectrum, shortest: float, longest: float) -> Iterator[str]:
    if scatter := list(map(str, scatter_between_places(spectrum, shortest, longest))):
        yield f"between places of the surface, C scatters by {', '.join(scatter)}"


def _unmeasured(spectrum: JoinedSpectrum) -> Iterator[str]:
    low = spectrum.shortest / _FINER
    yield (
        f"waves below {quantity(spectrum.shortest, 'm')} were not measured and are absent; "
        f"continued as a power law down to {quantity(low, 'm')}, they would have an rms slope of "
        f"{spectrum.slope(low, spectrum.shortest):.3g} beside "
        f"{spectrum.slope(spectrum.shortest, spectrum.longest):.3g} of the measured ones"
    )


def _bridged(spectrum: JoinedSpectrum) -> Iterator[str]:
    for shortest, longest in spectrum.gaps:
        yield (
            f"waves from {quantity(shortest, 'm')} to {quantity(longest, 'm')} were not measured; "
            "a power law bridges them, with an rms slope of "
            f"{spectrum.slope(shortest, longest):.3g}"
        )


def _provenance(
    spectrum: JoinedSpectrum, made: Surface, longest: float, seed: int, *, periodic: bool
) -> dict[str, str | float]:
    cells = 2 * max(made.grid.spacing)
    shortest = max(cells, spectrum.shortest)
    slope = spectrum.slope(spectrum.shortest, longest)
    gone_rms, gone = (
        (spectrum.rms(spectrum.shortest, cells), spectrum.slope(spectrum.shortest, cells))
        if cells > spectrum.shortest
        else (0.0, 0.0)
    )
    files = ", ".join(scan.name for scan in spectrum.scans)
    of_heights = carrier(spectrum)
    told = [
        f"a statistical twin (seed {seed}) of {len(spectrum.scans)} scans with waves from "
        f"{quantity(spectrum.shortest, 'm')} to {quantity(spectrum.longest, 'm')}",
        *spectrum.notes,
        *_between_places(spectrum, shortest, longest),
        *_unmeasured(spectrum),
    ]
    if spectrum.longest > longest * (1 + 1e-9):
        lost = spectrum.slope(longest, spectrum.longest)
        told.append(
            f"waves longer than {quantity(longest, 'm')} are left out (rms slope {lost:.2g})"
        )
    doubts = [*spectrum.doubts, *_bridged(spectrum)]
    if of_heights is None:
        doubts.append("heights are normally distributed, because a line scan shows most of them")
    return {
        "source": "twin",
        "kind": f"twin of {len(spectrum.scans)} scans",
        "file": files,
        "information": "; ".join(told),
        **({"notice": f"{files}: {'; '.join(doubts)}"} if doubts else {}),
        "extension": "statistical twin",
        "seed": seed,
        "longest_wave_m": longest,
        "shortest_wave_m": shortest,
        "heights_of": "normal distribution" if of_heights is None else of_heights.name,
        "twin_Sdq": rms_slope(made),
        "spectrum_error": _error(spectrum, shortest, longest),
        **({"periodicity": "periodic over the domain"} if periodic else {}),
        "placement": "made on the grid, with the waves that it carries",
        "pixel_x_m": 0.5 * spectrum.shortest,
        "pixel_y_m": 0.5 * spectrum.shortest,
        "shortest_carried_m": shortest,
        "removed_rms_m": gone_rms,
        "removed_slope": min(gone / slope, 1.0),
        **_contributions(spectrum),
    }


def _contributions(spectrum: JoinedSpectrum) -> dict[str, str | float]:
    """Entries of the provenance on each scan, and on each overlap of two."""
    told: dict[str, str | float] = {}
    for number, scan in enumerate(spectrum.scans, 1):
        told |= {
            f"scan_{number}_name": scan.name,
            f"scan_{number}_kind": "line scan" if scan.line else "height map",
            f"scan_{number}_edge_m": scan.edge,
            f"scan_{number}_pixel_m": scan.pixel,
            f"scan_{number}_shortest_m": scan.shortest,
            f"scan_{number}_longest_m": scan.longest,
            f"scan_{number}_ends_at": scan.why,
            f"scan_{number}_rms_m": scan.rms,
            f"scan_{number}_slope": scan.slope,
        }
    for number, one in enumerate(spectrum.overlaps, 1):
        told[f"overlap_{number}"] = (
            f"C of {one.first} is {one.ratio:.3g} times that of {one.second} from "
            f"{quantity(one.shortest, 'm')} to {quantity(one.longest, 'm')}, expected within "
            f"{math.expm1(2 * one.error):.0%}"
        )
    return told


def _error(spectrum: JoinedSpectrum, shortest: float, longest: float) -> float:
    """Relative standard deviation of the rms slope, if ln C is off by its error everywhere."""
    high = spectrum.raised(1.0).slope(shortest, longest)
    return high / spectrum.slope(shortest, longest) - 1
