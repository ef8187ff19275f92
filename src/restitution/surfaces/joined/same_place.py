"""Scans that show one place with the same pixels, so that the second adds nothing."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from scipy.fft import irfft2, rfft2

from restitution.errors import SurfaceError
from restitution.surfaces.joined.scan_spectrum import ScanSpectrum
from restitution.surfaces.surface import Array

_SAME = 1e-3  # relative difference of pixels that count as equal
_ALIKE = 0.95  # correlation of curvatures that other places do not reach by chance


def check_places(scans: Sequence[ScanSpectrum]) -> None:
    """Raise `SurfaceError` if two scans show the same place with the same pixels."""
    for first, second in combinations(scans, 2):
        if first.line != second.line or not _equal_pixels(first, second):
            continue
        large, small = _curvatures(first), _curvatures(second)
        if any(n < m for n, m in zip(large.shape, small.shape, strict=True)):
            large, small = small, large
        if any(n < m for n, m in zip(large.shape, small.shape, strict=True)):
            continue
        if (alike := correlation(large, small)) > _ALIKE:
            raise SurfaceError(
                f"{first.name} and {second.name}: show the same place (correlation of heights "
                f"{alike:.2f}), so one of them adds nothing; leave one out"
            )


def _equal_pixels(first: ScanSpectrum, second: ScanSpectrum) -> bool:
    pixels = zip(first.surface.grid.spacing, second.surface.grid.spacing, strict=True)
    along = 1 if first.line else 2
    return all(abs(a / b - 1) < _SAME for a, b in list(pixels)[:along])


def _curvatures(scan: ScanSpectrum) -> Array:
    """Differences of heights that levelling by a paraboloid does not change."""
    steps = np.diff(scan.surface.height, axis=0)
    return np.asarray(np.diff(steps, 2, axis=0) if scan.line else np.diff(steps, axis=1))


def correlation(large: Array, small: Array) -> float:
    """Largest correlation of `small` with a part of `large`."""
    small = small - small.mean()
    large = large - large.mean()
    shape = large.shape
    parts = tuple(slice(n - m + 1) for n, m in zip(shape, small.shape, strict=True))

    def with_part(values: Array, pattern: Array) -> Array:
        product = rfft2(values, shape) * np.conj(rfft2(pattern, shape))
        return np.asarray(irfft2(product, shape)[parts])

    energy = with_part(large**2, np.ones(small.shape))
    floor = 1e-9 * float((large**2).sum())
    together = with_part(large, small)
    own = float((small**2).sum())
    return float((together / np.sqrt(np.maximum(energy, floor) * own)).max()) if own > 0 else 0.0
