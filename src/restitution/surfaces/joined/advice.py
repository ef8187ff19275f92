"""Which further measurement would reduce the uncertainty of a joined spectrum most."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from restitution.display import quantity
from restitution.surfaces.joined.spectrum import JoinedSpectrum

# Wavelengths (m) that instruments usually show, from their makers' usual edges and pixels.
_INSTRUMENTS = (
    ("transmission electron microscope, or an AFM with a sharp tip", 5e-10, 1e-8),
    ("atomic force microscope", 1e-8, 1e-5),
    ("confocal or interference microscope", 1e-6, 1e-3),
    ("stylus profilometer", 1e-5, 1.0),
)
_FINER = 10.0  # shorter waves than measured that count, down to the shortest one divided by this
_ROUNDING = 1e-9
_MOST = 3.0  # largest error of ln C that counts
_WIDTH = 4  # octaves of one further measurement
_PIXELS, _PERIODS = 4.0, 3.0  # in the shortest wave, and in the edge, of a good scan


@dataclass(frozen=True)
class Measurement:
    """A further scan with waves (m) that hold a `share` of the uncertainty of height and slope."""

    shortest: float
    longest: float
    share: float

    @property
    def instrument(self) -> str:
        """The instrument that usually shows these waves."""
        middle = math.sqrt(self.shortest * self.longest)
        names = [name for name, low, high in _INSTRUMENTS if low <= middle <= high]
        return names[0] if names else _INSTRUMENTS[0 if middle < _INSTRUMENTS[0][1] else -1][0]

    def __str__(self) -> str:
        return (
            f"a scan with waves from {quantity(self.shortest, 'm')} to "
            f"{quantity(self.longest, 'm')} ({self.instrument}; edge of "
            f"{quantity(_PERIODS * self.longest, 'm')}, pixels of "
            f"{quantity(self.shortest / _PIXELS, 'm')}) would reduce the error most: these waves "
            f"hold {self.share:.0%} of the uncertainty of height and slope"
        )


def next_measurement(spectrum: JoinedSpectrum, shortest: float, longest: float) -> Measurement:
    """The further scan that would reduce the uncertainty most.

    Uncertain are the mean square height and slope, each relative to its measured value: measured
    waves by their error, waves that no scan shows by all that a power law continues. Only waves
    from `shortest` to `longest` (m), which the contact uses, count; waves shorter than measured
    count if the contact uses the shortest ones.
    """
    parts = list(_parts(spectrum, shortest, longest))
    total = sum(share for _, _, share in parts)
    low, high, best = max(parts, key=lambda part: part[2])
    return Measurement(low, high, best / total if total > 0 else 0.0)


def _parts(
    spectrum: JoinedSpectrum, shortest: float, longest: float
) -> Iterator[tuple[float, float, float]]:
    """Yield the shortest and longest wave (m) of ranges, and the uncertainty in them."""
    least, most = max(shortest, spectrum.shortest), min(longest, spectrum.longest)
    height = spectrum.rms(least, most) ** 2
    slope = spectrum.slope(least, most) ** 2

    def share(low: float, high: float) -> float:
        return spectrum.rms(low, high) ** 2 / height + spectrum.slope(low, high) ** 2 / slope

    def uncertain(low: float, high: float) -> float:
        q = np.geomspace(2 * math.pi / high, 2 * math.pi / low, 64)
        error = float(np.mean(np.interp(np.log(q), np.log(spectrum.wave_number), spectrum.error)))
        return share(low, high) * math.expm1(min(error, _MOST))

    if shortest <= spectrum.shortest * (1 + _ROUNDING):
        fine = spectrum.shortest / _FINER
        yield fine, spectrum.shortest, share(fine, spectrum.shortest)
    if longest > spectrum.longest * (1 + _ROUNDING):
        yield spectrum.longest, longest, share(spectrum.longest, longest)
    ends = {least, most, *(end for gap in spectrum.gaps for end in gap if least < end < most)}
    for low, high in pairwise(sorted(ends)):
        count = max(1, round(math.log2(high / low) / _WIDTH))
        for a, b in pairwise(np.geomspace(low, high, count + 1).tolist()):
            yield a, b, uncertain(a, b)
