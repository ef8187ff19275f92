"""Compare scans of one surface where they show the same waves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from restitution.display import quantity
from restitution.errors import SurfaceError
from restitution.surfaces.joined.curve import CALIBRATION, SpectrumCurve
from restitution.surfaces.joined.scan_spectrum import ScanSpectrum
from restitution.surfaces.joined.spectrum import Overlap
from restitution.surfaces.surface import Array

_LIKE_UNITS = 2.0  # decades of C by which scans in another unit may differ in addition
_MARGIN = 2.0  # octave below which a smooth instrument still shows: cut longer by this factor
_DIFFERENT = math.log(1.25)  # smallest systematic difference of ln C that is acted on
_NOISE = -1.5  # d ln C/d ln q: spectra of surfaces fall faster, noise does not fall
_END = 4  # bands of the shortest waves that show this slope
_COMPARED = 3  # bands at least, to see a cut-off
_CONTRADICTION = math.log(2.0)
_EVIDENT = 3.0  # standard deviations of a contradiction
_FILLED = 0.02  # fraction of interpolated pixels that is told
LONGEST = 2.0  # periods in an edge of the longest wave that bridges to the next scan


def compared(
    scan: ScanSpectrum,
    spectra: Sequence[ScanSpectrum],
    curve: SpectrumCurve,
    notes: list[str],
    doubts: list[str],
) -> ScanSpectrum:
    """`scan` without the short waves in which a finer scan shows that it is wrong."""
    for finer in spectra:
        if finer is scan or not finer.trusted[0] < scan.trusted[0]:
            continue
        low = max(scan.shortest, finer.shortest)
        high = min(scan.edge, finer.edge) / LONGEST
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
        cut = min(float(waves[begin]) * _MARGIN, finer.edge / LONGEST)
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
    first: ScanSpectrum, second: ScanSpectrum, curve: SpectrumCurve, within: tuple[float, float]
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


def overlaps_of(spectra: Sequence[ScanSpectrum], curve: SpectrumCurve) -> Iterator[Overlap]:
    for first, second in combinations(spectra, 2):
        low = max(first.trusted[0], second.trusted[0])
        high = min(first.trusted[1], second.trusted[1])
        waves, ratio, error = _ratio(first, second, curve, (low, high))
        if waves.size:
            weight = 1 / (error**2 + CALIBRATION**2)
            mean = float((ratio * weight).sum() / weight.sum())
            yield Overlap(
                first.name,
                second.name,
                float(waves.min()),
                float(waves.max()),
                math.exp(mean),
                1 / math.sqrt(float(weight.sum())),
            )


def check_agreement(overlaps: Sequence[Overlap]) -> None:
    for one in overlaps:
        off = abs(math.log(one.ratio))
        if off > _CONTRADICTION and off - _CONTRADICTION > _EVIDENT * one.error:
            factor = round(math.log10(one.ratio) / 6)  # C has the square of heights
            unit = (
                f", as if heights were in units that differ by 10^{3 * abs(factor)};"
                if factor and abs(math.log10(one.ratio) - 6 * factor) < _LIKE_UNITS
                else ";"
            )
            raise SurfaceError(
                f"{one.first} and {one.second}: contradict each other: from "
                f"{quantity(one.shortest, 'm')} to {quantity(one.longest, 'm')} the power spectrum "
                f"of the first is {one.ratio:.3g} times that of the second{unit} correct the unit "
                "of the heights or the size of one of them, state its tip radius or resolution, or "
                "leave it out"
            )


def check_gaps(spectra: Sequence[ScanSpectrum], *, bridge: bool) -> tuple[tuple[float, float], ...]:
    gaps = []
    ranges = sorted(
        ((scan.edge / LONGEST, scan.shortest, scan.name) for scan in spectra), reverse=True
    )
    _, reached, before = ranges[0]
    for longest, shortest, name in ranges[1:]:
        if longest < reached:
            gaps.append((longest, reached))
            if not bridge:
                raise SurfaceError(
                    f"{before} and {name}: do not overlap: no scan has waves from "
                    f"{quantity(longest, 'm')} to {quantity(reached, 'm')}; add a scan with an "
                    f"edge of {quantity(LONGEST * 1.5 * reached, 'm')} or more and pixels of "
                    f"{quantity(0.25 * longest, 'm')} or less",
                    argument="bridge",
                )
        if shortest < reached:
            reached, before = shortest, name
    return tuple(gaps)


def undecidable(spectra: Sequence[ScanSpectrum]) -> Iterator[str]:
    finest = min(spectra, key=lambda scan: scan.shortest)
    if finest.why == "two pixels":
        yield (
            f"whether {finest.name} is smoothed by its tip or optics cannot be decided, because "
            "no finer scan shows the same waves and its resolution is not stated"
        )


def filled(spectra: Sequence[ScanSpectrum]) -> Iterator[str]:
    for scan in spectra:
        if scan.filled > _FILLED:
            yield (
                f"{scan.filled:.0%} of {scan.name} is interpolated, which lowers its C of short "
                "waves by about as much"
            )


def differences(
    spectra: Sequence[ScanSpectrum], overlaps: Sequence[Overlap], curve: SpectrumCurve
) -> Array:
    """Error of ln C at the knots of `curve`: filled pixels, and differences beyond chance."""
    off = {scan.name: scan.filled for scan in spectra}
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
