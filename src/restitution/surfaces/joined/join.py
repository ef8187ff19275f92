"""Join the power spectra of several scans of one surface."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, NamedTuple, Self

import numpy as np

from restitution.display import quantity
from restitution.errors import SurfaceError
from restitution.surfaces.joined.scan_spectrum import PER_OCTAVE, ScanSpectrum
from restitution.surfaces.surface import Array

# Prior standard deviation of the change of slope of ln C from one band to the next: a straight
# line is free, and the bend of a roll-off within an octave is three of it.
_BEND = 0.15
_CALIBRATION = 0.03  # standard deviation of ln C of any scan
_ROUNDS = 8  # of the correction for the response of the scans
_ACROSS, _STEPS = 6.0, 121  # of the integral over waves across a line: up to 200 times shorter
_LIKE_UNITS = 2.0  # decades of C by which scans in another unit may differ in addition
_MARGIN = 2.0  # octave below which a smooth instrument still shows: cut longer by this factor
_DIFFERENT = math.log(1.25)  # smallest systematic difference of ln C that is acted on
_NOISE = -1.5  # d ln C/d ln q: spectra of surfaces fall faster, noise does not fall
_END = 4  # bands of the shortest waves that show this slope
_COMPARED = 3  # bands at least, to see a cut-off
_CONTRADICTION = math.log(2.0)
_EVIDENT = 3.0  # standard deviations of a contradiction
_LONGEST = 2.0  # periods in an edge of the longest wave that bridges to the next scan
_BELOW, _ABOVE = 2, 3  # octaves of the curve beyond all scans, for the response


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
        return np.exp(_interpolated(np.log(q), np.log(self.wave_number), np.log(self.density)))

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
        curve = _Curve(np.log(self.wave_number), np.log(self.density), self.error)
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


def join(scans: Sequence[ScanSpectrum], *, bridge: bool = False) -> JoinedSpectrum:
    """Join spectra of one surface.

    Args:
        scans: Spectra of its scans, in any order.
        bridge: Whether a power law may bridge waves that no scan shows.

    Returns:
        Joined spectrum.

    Raises:
        SurfaceError: Scans contradict each other by more than a factor of 2, or leave a gap.
    """
    notes: list[str] = []
    doubts = [
        f"{scan.name} is not used: its {scan.why} leaves no waves ({quantity(scan.shortest, 'm')} "
        "is above half of its edge)"
        for scan in scans
        if scan.shortest > scan.edge / _LONGEST
    ]
    spectra = sorted(
        (scan for scan in scans if scan.shortest <= scan.edge / _LONGEST),
        key=lambda scan: -scan.edge,
    )
    if not spectra:
        raise SurfaceError("; ".join(doubts))
    _check_gaps(spectra, bridge=bridge)
    curve = _fitted(spectra)
    spectra = [_compared(scan, spectra, curve, notes, doubts) for scan in spectra]
    gaps = _check_gaps(spectra, bridge=bridge)
    curve = _fitted(spectra)
    overlaps = tuple(_overlaps(spectra, curve))
    _check_agreement(overlaps)
    notes += _undecidable(spectra)
    shortest = min(scan.shortest for scan in spectra)
    longest = max(scan.edge for scan in spectra)
    spread = _differences(spectra, overlaps, curve)
    whole = JoinedSpectrum(
        np.exp(curve.log_q),
        np.exp(curve.log_density),
        np.hypot(curve.error, spread),
        shortest,
        longest,
        (),
        overlaps,
        gaps,
        tuple(notes),
        tuple(doubts),
        tuple(spectra),
    )
    return replace(whole, scans=tuple(_contributions(whole, spectra)))


class _Curve(NamedTuple):
    log_q: Array
    log_density: Array
    error: Array

    def at(self, q: Array) -> Array:
        return np.exp(_interpolated(np.log(q), self.log_q, self.log_density))

    def profile(self, q: Array) -> Array:
        """C₁ (m³) of profiles: ∫ C dq_y/2π (Jacobs et al. 2017, eq. 8)."""
        return np.asarray(self._across(q)[1].sum(axis=1))

    def sensitivity(self, scan: ScanSpectrum, used: Array) -> Array:
        """Change of ln of `expected` with ln C at the knots, shape (used bands, knots)."""
        of = self._profile_weights if scan.line else self._map_weights
        rows = of(scan.wave_number)
        if long := len(scan.weights):
            parts = scan.weights * (self.profile if scan.line else self.at)(scan.waves)
            rows[:long] = parts / parts.sum(axis=1)[:, None] @ of(scan.waves)
        return np.asarray(rows[used])

    def _map_weights(self, q: Array) -> Array:
        return _weights(np.log(q), self.log_q)

    def _profile_weights(self, q: Array) -> Array:
        """Change of ln C₁ with ln C at the knots."""
        across, parts = self._across(q)
        shares = parts / parts.sum(axis=1)[:, None]
        weights = _weights(np.log(across.ravel()), self.log_q)
        return np.asarray(np.einsum("ij,ijk->ik", shares, weights.reshape(*across.shape, -1)))

    def _across(self, q: Array) -> tuple[Array, Array]:
        """Wave numbers q' = q cosh u, and their parts of C₁."""
        u = np.linspace(0.0, _ACROSS, _STEPS)
        across = q[:, None] * np.cosh(u)
        C = self.at(across.ravel()).reshape(across.shape)
        steps = np.full(u.size, u[1] - u[0])
        steps[[0, -1]] *= 0.5
        return across, C * across * steps / math.pi

    def expected(self, scan: ScanSpectrum) -> Array:
        """What the estimate of `scan` would be on average, in its bands."""
        density = self.profile if scan.line else self.at
        here = density(scan.wave_number)
        long = len(scan.weights)
        if not long:
            return here
        ratio = np.ones(here.size)
        ratio[:long] = scan.weights @ density(scan.waves) / here[:long]
        # Leakage of shorter waves falls with the square of the wave number.
        excess = (ratio[long - 1] - 1) * scan.wave_number[long - 1] ** 2
        ratio[long:] = 1 + excess / scan.wave_number[long:] ** 2
        return here * ratio


def _interpolated(x: Array, at: Array, values: Array) -> Array:
    """Linear between the points, and a straight line through the first and last two beyond."""
    inner = np.interp(x, at, values)
    low, high = x < at[0], x > at[-1]
    first, last = ((values[k + 1] - values[k]) / (at[k + 1] - at[k]) for k in (0, -2))
    inner[low] = values[0] + first * (x[low] - at[0])
    inner[high] = values[-1] + last * (x[high] - at[-1])
    return inner


def _used(scan: ScanSpectrum, others: Sequence[ScanSpectrum]) -> Array:
    """Bands of `scan` that count: trusted ones, and those that no other scan trusts."""
    trusted = scan.inside(*scan.trusted)
    possible = scan.inside(scan.shortest, scan.edge)
    wave = 2 * math.pi / scan.wave_number
    known = np.zeros(wave.size, bool)
    for other in others:
        if other is not scan:
            low, high = other.trusted
            known |= (wave >= low) & (wave <= high)
    return np.asarray(trusted | (possible & ~known))


def _fitted(spectra: Sequence[ScanSpectrum]) -> _Curve:
    """The smoothest curve through the spectra, by penalised least squares of ln C."""
    first = min(float(scan.band.min()) for scan in spectra) - _BELOW * PER_OCTAVE
    last = max(float(scan.band.max()) for scan in spectra) + _ABOVE * PER_OCTAVE
    knots = np.arange(first, last + 2) * math.log(2) / PER_OCTAVE + math.log(2 * math.pi)
    bends = np.diff(np.eye(knots.size), 2, axis=0) / _BEND
    parts = [(scan, _used(scan, spectra)) for scan in spectra]
    values = [(np.log(scan.density) - scan.bias)[used] for scan, used in parts]
    modes = np.concatenate([scan.modes[used] for scan, used in parts])
    w = 1 / (1 / modes + 0.5 / modes**2 + _CALIBRATION**2)
    # To begin with, C of a line scan is that of a power law with H = 0.8: C₁·4.6/q.
    wanted = [
        value - (np.log(scan.wave_number[used] / 4.6) if scan.line else 0.0)
        for value, (scan, used) in zip(values, parts, strict=True)
    ]
    rows = [_weights(np.log(scan.wave_number[used]), knots) for scan, used in parts]
    curve = _Curve(knots, *_solved(np.concatenate(rows), w, np.concatenate(wanted), bends))
    for _ in range(_ROUNDS):
        for k, (scan, used) in enumerate(parts):
            rows[k] = curve.sensitivity(scan, used)
            here = np.log(curve.expected(scan)[used])
            wanted[k] = values[k] - here + rows[k] @ curve.log_density
        solved = _solved(np.concatenate(rows), w, np.concatenate(wanted), bends)
        curve = _Curve(knots, *solved)
    return curve


def _solved(A: Array, w: Array, wanted: Array, bends: Array) -> tuple[Array, Array]:
    """ln C at the knots, and its standard deviation."""
    covariance = np.linalg.inv(A.T @ (w[:, None] * A) + bends.T @ bends)
    return covariance @ (A.T @ (w * wanted)), np.sqrt(np.diag(covariance))


def _weights(x: Array, knots: Array) -> Array:
    """Weights of the knots in the curve at `x`, shape (x.size, knots.size)."""
    at = np.clip(np.searchsorted(knots, x) - 1, 0, knots.size - 2)
    share = (x - knots[at]) / (knots[at + 1] - knots[at])
    weights = np.zeros((x.size, knots.size))
    rows = np.arange(x.size)
    weights[rows, at] = 1 - share
    weights[rows, at + 1] = share
    return weights


def _compared(
    scan: ScanSpectrum,
    spectra: Sequence[ScanSpectrum],
    curve: _Curve,
    notes: list[str],
    doubts: list[str],
) -> ScanSpectrum:
    """`scan` without the short waves in which a finer scan shows that it is wrong."""
    for finer in spectra:
        if finer is scan or not finer.trusted[0] < scan.trusted[0]:
            continue
        low = max(scan.shortest, finer.shortest)
        high = min(scan.edge, finer.edge) / _LONGEST
        waves, ratio, error = _ratio(scan, finer, curve, (low, high))
        if waves.size < _COMPARED:
            continue
        mean, error = _running(ratio, error)
        limit = np.maximum(_DIFFERENT, 2 * error)
        off = np.abs(mean) > limit
        # From the shortest wave to the longest one that still differs in the same direction.
        alike = off & (np.sign(mean) == np.sign(mean[-1]))
        right = np.flatnonzero(~alike)
        begin = int(right[-1]) + 1 if right.size else 0
        if begin == waves.size:
            continue
        if begin == 0:
            if abs(mean[-1] - mean[0]) > limit.max():
                doubts.append(
                    f"whether {scan.name} is smoothed or wrongly calibrated beside {finer.name} "
                    f"cannot be decided: they differ in all waves that both show"
                )
            continue
        if mean[-1] > 0 and _end_slope(scan) < _NOISE:
            doubts.append(
                f"below {quantity(float(waves[begin]), 'm')}, {scan.name} has up to "
                f"{math.exp(float(mean[-1])):.2g} times the density of {finer.name}: whether the "
                "tip or optics smooth the latter cannot be decided; state its tip radius or "
                "resolution"
            )
            continue
        what = "is smoothed" if mean[-1] < 0 else "has noise"
        cut = min(float(waves[begin]) * _MARGIN, finer.edge / _LONGEST)
        notes.append(
            f"{scan.name} {what} below {quantity(float(waves[begin]), 'm')} "
            f"({math.exp(float(mean[-1])):.2g} times the density of {finer.name} at "
            f"{quantity(float(waves[-1]), 'm')}): its waves below {quantity(cut, 'm')} are left out"
        )
        if cut > scan.shortest:
            scan = scan.cut(cut, f"{what.split()[1]} beside {finer.name}")
    return scan


def _end_slope(scan: ScanSpectrum) -> float:
    """d ln C/d ln q of the shortest waves; that of C₁ is one higher."""
    at = np.flatnonzero(scan.inside(scan.shortest, scan.trusted[1]))[-_END:]
    slope = np.polyfit(np.log(scan.wave_number[at]), np.log(scan.density[at]), 1)[0]
    return float(slope) - float(scan.line)


def _ratio(
    first: ScanSpectrum, second: ScanSpectrum, curve: _Curve, within: tuple[float, float]
) -> tuple[Array, Array, Array]:
    """Common waves (m, from long to short) in a range, and ln of the ratio of C with its error."""
    low, high = within
    _, i, j = np.intersect1d(first.band, second.band, return_indices=True)
    kept = np.logical_and(first.inside(low, high)[i], second.inside(low, high)[j])
    i, j = i[kept], j[kept]
    levels = [
        (np.log(scan.density) - scan.bias - np.log(curve.expected(scan)))[at]
        for scan, at in ((first, i), (second, j))
    ]
    error = np.sqrt(1 / first.modes[i] + 1 / second.modes[j])
    return 2 * math.pi / first.wave_number[i], levels[0] - levels[1], error


def _running(ratio: Array, error: Array) -> tuple[Array, Array]:
    """Mean over three bands, weighted, and its error."""
    weight = 1 / error**2
    window = np.ones(3)
    total = np.convolve(weight, window, "same")
    return np.convolve(ratio * weight, window, "same") / total, 1 / np.sqrt(total)


def _overlaps(spectra: Sequence[ScanSpectrum], curve: _Curve) -> Iterator[Overlap]:
    for first, second in combinations(spectra, 2):
        low = max(first.trusted[0], second.trusted[0])
        high = min(first.trusted[1], second.trusted[1])
        waves, ratio, error = _ratio(first, second, curve, (low, high))
        if waves.size:
            weight = 1 / (error**2 + _CALIBRATION**2)
            mean = float((ratio * weight).sum() / weight.sum())
            yield Overlap(
                first.name,
                second.name,
                float(waves.min()),
                float(waves.max()),
                math.exp(mean),
                1 / math.sqrt(float(weight.sum())),
            )


def _check_agreement(overlaps: Sequence[Overlap]) -> None:
    for one in overlaps:
        off = abs(math.log(one.ratio))
        if off > _CONTRADICTION and off - _CONTRADICTION > _EVIDENT * one.error:
            factor = round(math.log10(one.ratio) / 6)  # C has the square of heights
            unit = (
                f" as if heights were in units that differ by 10^{3 * abs(factor)};"
                if factor and abs(math.log10(one.ratio) - 6 * factor) < _LIKE_UNITS
                else ""
            )
            raise SurfaceError(
                f"{one.first} and {one.second}: contradict each other: from "
                f"{quantity(one.shortest, 'm')} to {quantity(one.longest, 'm')} the power spectrum "
                f"of the first is {one.ratio:.3g} times that of the second,{unit} correct the unit "
                "of the heights or the size of one of them, state its tip radius or resolution, or "
                "leave it out".replace("second, correct", "second; correct")
            )


def _check_gaps(
    spectra: Sequence[ScanSpectrum], *, bridge: bool
) -> tuple[tuple[float, float], ...]:
    gaps = []
    ranges = sorted(
        ((scan.edge / _LONGEST, scan.shortest, scan.name) for scan in spectra), reverse=True
    )
    _, reached, before = ranges[0]
    for longest, shortest, name in ranges[1:]:
        if longest < reached:
            gaps.append((longest, reached))
            if not bridge:
                raise SurfaceError(
                    f"{before} and {name}: do not overlap: no scan has waves from "
                    f"{quantity(longest, 'm')} to {quantity(reached, 'm')}; add a scan with an "
                    f"edge of {quantity(_LONGEST * 1.5 * reached, 'm')} or more and pixels of "
                    f"{quantity(0.25 * longest, 'm')} or less",
                    argument="bridge",
                )
        if shortest < reached:
            reached, before = shortest, name
    return tuple(gaps)


def _undecidable(spectra: Sequence[ScanSpectrum]) -> Iterator[str]:
    finest = min(spectra, key=lambda scan: scan.shortest)
    if finest.why == "two pixels":
        yield (
            f"whether {finest.name} is smoothed by its tip or optics cannot be decided, because "
            "no finer scan shows the same waves and its resolution is not stated"
        )


def _differences(
    spectra: Sequence[ScanSpectrum], overlaps: Sequence[Overlap], curve: _Curve
) -> Array:
    """Error of ln C from differences between scans beyond chance, at the knots of `curve`."""
    off = dict.fromkeys((scan.name for scan in spectra), 0.0)
    for one in overlaps:
        beyond = 0.5 * math.sqrt(max(math.log(one.ratio) ** 2 - one.error**2, 0.0))
        for name in (one.first, one.second):
            off[name] = max(off[name], beyond)
    wave = 2 * math.pi * np.exp(-curve.log_q)
    total, weight = np.zeros(wave.size), np.zeros(wave.size)
    for scan in spectra:
        low, high = scan.trusted
        inside = (wave >= low) & (wave <= high)
        near = 0.01 * ((wave >= scan.shortest) & (wave <= scan.edge))
        share = np.maximum(inside, near)
        total += share * off[scan.name] ** 2
        weight += share
    return np.sqrt(total / np.maximum(weight, 1e-300))


def _contributions(
    whole: JoinedSpectrum, spectra: Sequence[ScanSpectrum]
) -> Iterator[Contribution]:
    for scan in spectra:
        used = _used(scan, spectra)
        if used.any():
            waves = 2 * math.pi / scan.wave_number[used]
            half = 2 ** (0.5 / PER_OCTAVE)
            low = max(float(waves.min()) / half, scan.shortest)
            high = min(float(waves.max()) * half, scan.edge)
        else:
            low = high = scan.shortest
        yield Contribution(
            scan.name,
            scan.line,
            scan.edge,
            scan.pixel,
            low,
            high,
            scan.why if low <= scan.shortest * 1.01 else "finer scans",
            whole.rms(low, high),
            whole.slope(low, high),
        )
