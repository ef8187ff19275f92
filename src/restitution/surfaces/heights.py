"""Rough surfaces with given wave amplitudes and given skewness and kurtosis of the heights.

`filtered` filters transformed white noise η (module `johnson`) with the impulse response θ (Watson
and Spedding 1982, Wear 83, 215–231; Manesh et al. 2010, Tribol. Int. 43, 2218–2225),

    Sk_z = Sk_η Σθ³/(Σθ²)^{3/2},   K_z − 3 = (K_η − 3) Σθ⁴/(Σθ²)²;

`adjusted` reaches larger values, by imposing heights and amplitudes alternately (Schreiber and
Schmitz 1996, Phys. Rev. Lett. 77, 635–638).
"""

from __future__ import annotations

import math

import numpy as np

from restitution.surfaces.johnson import translation
from restitution.surfaces.surface import Array

_STRONGEST = 3.0, 40.0  # largest |skewness| and kurtosis of the noise in `filtered`
_CLOSE = 0.02  # tolerance on skewness (absolute) and kurtosis (relative) in `filtered`
_CORRECTIONS = 12  # `filtered` corrects the moments of the noise at most this many times
_ADJUSTMENTS = 60  # `adjusted` adjusts heights and amplitudes at most this many times
_NEGLIGIBLE = 1e-3  # misfit of amplitudes below which the adjustment ends
_STANDSTILL = 0.05  # the adjustment ends if the misfit decreases by less than this fraction


def filtered(noise: Array, H: Array, skewness: float, kurtosis: float) -> Array | None:
    """`noise` of other moments, filtered by the amplitudes `H`; None if out of reach."""
    from scipy.fft import irfft2, rfft2

    theta = irfft2(H, s=noise.shape)
    squares = float((theta**2).sum())
    skewing = float((theta**3).sum()) / squares**1.5
    peaking = float((theta**4).sum()) / squares**2
    if skewing == 0 and skewness != 0:
        return None
    target = skewness / skewing if skewness else 0.0, 3 + (kurtosis - 3) / peaking
    for _ in range(_CORRECTIONS):
        if abs(target[0]) > _STRONGEST[0] or target[1] > _STRONGEST[1]:
            return None
        if (translate := translation(*target)) is None:
            return None
        z: Array = irfft2(H * rfft2(translate(noise)), s=noise.shape)
        skew, kurt = moments(z)
        if abs(skew - skewness) < _CLOSE and abs(kurt - kurtosis) < _CLOSE * kurtosis:
            return z
        # The skewness and kurtosis of these heights miss the given values by chance. Correct the
        # skewness and kurtosis that are requested for the noise accordingly.
        target = (
            target[0] + (skewness - skew) / skewing if skewing else 0.0,
            target[1] + (kurtosis - kurt) / peaking,
        )
    return None


def adjusted(z: Array, heights: Array) -> tuple[Array, float]:
    """Sorted `heights` in the order of nearly the Fourier amplitudes of `z`, and their misfit."""
    from scipy.fft import irfft2, rfft2

    modes = rfft2(z - z.mean())
    wanted = np.abs(modes) * math.sqrt(float(np.var(heights)) / float(np.var(z)))
    misfit = math.inf
    for _ in range(_ADJUSTMENTS):
        z = in_order(heights, z)
        modes = rfft2(z)
        size = np.abs(modes)
        last, misfit = misfit, float(np.linalg.norm(size - wanted) / np.linalg.norm(wanted))
        if misfit < _NEGLIGIBLE or misfit > last * (1 - _STANDSTILL):
            break
        modes *= wanted / np.maximum(size, np.finfo(float).tiny)
        z = irfft2(modes, s=z.shape)
    return in_order(heights, z), misfit


def in_order(heights: Array, z: Array) -> Array:
    """Arrange the sorted `heights` in the rank order of `z`, with the shape of `z`."""
    placed = np.empty(z.size)
    placed[np.argsort(z, axis=None, kind="stable")] = heights
    return placed.reshape(z.shape)


def distribution(n: int, skewness: float, kurtosis: float) -> Array | None:
    """n sorted heights with mean 0, variance 1 and nearly these moments; None if not found."""
    from scipy.special import ndtri

    if (translate := translation(skewness, kurtosis)) is None:
        return None
    heights = translate(ndtri((np.arange(n) + 0.5) / n))
    heights -= heights.mean()
    return heights / math.sqrt(float(np.mean(heights**2)))


def moments(z: Array) -> tuple[float, float]:
    """Skewness and kurtosis of `z`."""
    unit = z - z.mean()
    unit = unit / math.sqrt(float(np.mean(unit**2)))
    return float(np.mean(unit**3)), float(np.mean(unit**4))
