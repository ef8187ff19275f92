"""How much a joined spectrum depends on the place, and how many places would be enough."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from restitution.display import quantity
from restitution.surfaces.joined.curve import SpectrumCurve, scatter_of_places, used_bands
from restitution.surfaces.joined.spectrum import JoinedSpectrum

_WANTED = 0.1  # scatter of ln C that is small enough
_OCTAVES = 2.0  # width of a range
_PLACES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 100)


@dataclass(frozen=True)
class Scatter:
    """Waves (m) whose C differs between places by a relative standard deviation of `scatter`.

    In the mean of `places` scans like that named `scan`, it would be 10 %; None if more than 100
    are needed.
    """

    shortest: float
    longest: float
    scatter: float
    scan: str
    places: int | None

    def __str__(self) -> str:
        waves = f"{quantity(self.shortest, 'm')} to {quantity(self.longest, 'm')}"
        most = f"more than {_PLACES[-1]}" if self.places is None else self.places
        return f"{self.scatter:.0%} from {waves} (10% with {most} places like {self.scan})"


def ranges(spectrum: JoinedSpectrum, shortest: float, longest: float) -> list[tuple[float, float]]:
    """Ranges of measured waves (m) from `shortest` to `longest` (m), two octaves wide or less."""
    low, high = max(shortest, spectrum.shortest), min(longest, spectrum.longest)
    if not low < high:
        return []
    count = math.ceil(math.log2(high / low) / _OCTAVES)
    ends = [max(high * 2 ** (-_OCTAVES * k), low) for k in range(count + 1)]
    return [(short, long) for long, short in pairwise(ends)]


def scatter_in(spectrum: JoinedSpectrum, waves: tuple[float, float], places: int = 1) -> float:
    """Rms over `waves` (m) of the scatter of ln C, if the scan that shows them has `places`."""
    known = np.log(spectrum.wave_number)
    at = np.geomspace(2 * math.pi / waves[1], 2 * math.pi / waves[0], 33)
    curve = SpectrumCurve(known, np.log(spectrum.density), spectrum.error)
    showing = _showing(spectrum, waves)
    counts = [places if k == showing else 1 for k in range(len(spectrum.spectra))]
    scatter = scatter_of_places(curve, spectrum.spectra, counts)
    return float(np.sqrt(np.mean(np.interp(np.log(at), known, scatter) ** 2)))


def scatter_between_places(
    spectrum: JoinedSpectrum, shortest: float, longest: float
) -> Iterator[Scatter]:
    """Yield the waves from `shortest` to `longest` (m) whose C scatters by more than 10 %."""
    for waves in ranges(spectrum, shortest, longest):
        scatter = scatter_in(spectrum, waves)
        if scatter > _WANTED:
            enough = (n for n in _PLACES[1:] if scatter_in(spectrum, waves, n) <= _WANTED)
            name = spectrum.spectra[_showing(spectrum, waves)].name
            yield Scatter(*waves, math.expm1(scatter), name, next(enough, None))


def _showing(spectrum: JoinedSpectrum, waves: tuple[float, float]) -> int:
    """Index of the scan with most of these waves, the larger one if none has any."""

    def count(k: int) -> tuple[float, float]:
        scan = spectrum.spectra[k]
        used = np.logical_and(used_bands(scan, spectrum.spectra), scan.inside(*waves))
        return float(scan.modes[used].sum()), scan.edge

    return max(range(len(spectrum.spectra)), key=count)
