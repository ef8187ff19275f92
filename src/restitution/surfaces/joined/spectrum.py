"""Power spectral density of a surface from several scans."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Self

import numpy as np

from restitution.surfaces.joined.curve import SpectrumCurve, interpolated
from restitution.surfaces.joined.scan_spectrum import ScanSpectrum
from restitution.surfaces.surface import Array


class Overlap(NamedTuple):
    """Two scans in the waves (m) that both trust: C of the first divided by that of the second."""

    first: str
    second: str
    shortest: float
    longest: float
    ratio: float
    error: float  # relative standard deviation of `ratio`


@dataclass(frozen=True)
class Contribution:
    """What one scan adds to a joined spectrum: waves (m) that it shows alone or with others.

    `rms` (m) and `slope` are those of the joined spectrum in these waves. `why` says what sets
    `shortest`.
    """

    name: str
    line: bool
    edge: float
    pixel: float
    shortest: float
    longest: float
    why: str
    rms: float
    slope: float


@dataclass(frozen=True, eq=False)
class JoinedSpectrum:
    """Power spectral density of an isotropic surface from several scans.

    Attributes:
        wave_number: Wave numbers (rad/m), evenly spaced in their logarithm.
        density: C (m⁴) at these.
        error: Standard deviation of ln C.
        shortest: Shortest measured wave (m).
        longest: Longest measured wave (m).
        scans: What each scan contributes.
        overlaps: Comparisons of scans.
        gaps: Shortest and longest wave (m) of each range that no scan shows.
        notes: Clauses on cut-offs, and on what the finest scan cannot show.
        doubts: Clauses on scans that are not used, and on differences that cannot be explained.
        spectra: The spectra of the scans.
    """

    wave_number: Array
    density: Array
    error: Array
    shortest: float
    longest: float
    scans: tuple[Contribution, ...] = ()
    overlaps: tuple[Overlap, ...] = ()
    gaps: tuple[tuple[float, float], ...] = ()
    notes: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    spectra: tuple[ScanSpectrum, ...] = ()

    def at(self, q: Array) -> Array:
        """C (m⁴) at the wave numbers `q` (rad/m), zero for waves that were not measured."""
        low, high = 2 * math.pi / self.longest, 2 * math.pi / self.shortest
        inside = (q >= low * (1 - 1e-9)) & (q <= high * (1 + 1e-9))
        C = np.zeros(q.shape)
        C[inside] = self.continued(q[inside])
        return C

    def continued(self, q: Array) -> Array:
        """C (m⁴) at the wave numbers `q` (rad/m), continued as a power law beyond the scans."""
        return np.exp(interpolated(np.log(q), np.log(self.wave_number), np.log(self.density)))

    def raised(self, deviations: float) -> Self:
        """This spectrum with ln C changed by a number of its standard deviations."""
        return replace(self, density=self.density * np.exp(deviations * self.error))

    def rms(self, shortest: float, longest: float) -> float:
        """Rms height (m) of the waves from `shortest` to `longest` (m)."""
        return math.sqrt(self._moment(1, shortest, longest))

    def slope(self, shortest: float, longest: float) -> float:
        """Rms slope of the waves from `shortest` to `longest` (m)."""
        return math.sqrt(self._moment(3, shortest, longest))

    def _moment(self, power: int, shortest: float, longest: float) -> float:
        """(2π)⁻¹ ∫ C q^power dq."""
        from scipy.integrate import trapezoid

        if not shortest < longest:
            return 0.0
        q = np.geomspace(2 * math.pi / longest, 2 * math.pi / shortest, 512)
        return float(trapezoid(self.continued(q) * q ** (power + 1), np.log(q))) / (2 * math.pi)

    def told(self) -> dict[str, Any]:
        """The spectrum and its scans as lists of numbers (SI), of measured waves."""
        inside = self.at(self.wave_number) > 0
        curve = SpectrumCurve(np.log(self.wave_number), np.log(self.density), self.error)
        scans = {}
        for scan in self.spectra:
            kept = scan.inside(scan.shortest, scan.edge)
            # Without the response of the scan; C of a profile from C₁ by the ratio of the curve's.
            C = scan.density / curve.expected(scan) * curve.at(scan.wave_number)
            scans[scan.name] = {
                "wave_number": scan.wave_number[kept].tolist(),
                "density": C[kept].tolist(),
            }
        return {
            "wave_number": self.wave_number[inside].tolist(),
            "density": self.density[inside].tolist(),
            "error": self.error[inside].tolist(),
            "shortest_m": self.shortest,
            "longest_m": self.longest,
            "scans": scans,
            "overlaps": [one._asdict() for one in self.overlaps],
            "gaps_m": [list(gap) for gap in self.gaps],
            "notes": [*self.notes, *self.doubts],
        }
