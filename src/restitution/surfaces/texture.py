"""Texture and material ratio parameters after ISO 25178-2:2012, whose clause numbers are cited."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from restitution.surfaces.surface import Array, Surface, is_periodic

_BINS = 80  # number of bins of the density of heights
_DECAY = 0.2  # value of the autocorrelation that defines Sal and Str (clause 4.2)
_DIRECTIONS = 180  # number of directions over a half turn
_CORE = 0.4  # difference of material ratio between the ends of the secant (clause 5.2)


class Autocorrelation(NamedTuple):
    """Autocorrelation `values` (1 at lag zero) at the lags `x` and `y` (m), both increasing."""

    x: Array
    y: Array
    values: Array


class MaterialRatio(NamedTuple):
    """Abbott curve: material ratios from 0 to 1, and their heights (m, from the mean height)."""

    ratio: Array
    height: Array


class HeightDensity(NamedTuple):
    """Heights (m, from the mean height), their density (1/m), and that of a normal distribution."""

    height: Array
    density: Array
    normal: Array


def texture(surface: Surface) -> dict[str, float | None]:
    """Texture and material ratio parameters of `surface`, in SI units; None where undefined.

    The decay lag of a direction is the lag at which the autocorrelation first falls to 0.2.

    - `Sal_m`: autocorrelation length, the shortest decay lag (4.2.1)
    - `Str`: texture aspect ratio, the shortest decay lag divided by the longest (4.2.2)
    - `lay_deg`: direction (°) of the longest decay lag from the x axis, 0 to 180
    - `Sdr`: developed interfacial area ratio, of triangles between nodes (4.3.2)
    - `Sk_m`, `Spk_m`, `Svk_m`: core height, reduced peak height and reduced dale height (5.2 to
      5.4, after ISO 13565-2)
    - `Smr1`, `Smr2`: material ratios at the limits of the core towards peaks and dales (5.2 to 5.4)
    """
    decays = _decay_lags(autocorrelation(surface))
    defined = np.isfinite(decays)
    return {
        "Sal_m": float(np.nanmin(decays)) if defined.any() else None,
        "Str": float(decays.min() / decays.max()) if defined.all() else None,
        "lay_deg": 180 * int(decays.argmax()) / _DIRECTIONS if defined.all() else None,
        "Sdr": _developed_area(surface),
        **_core(material_ratio(surface)),
    }


def height_density(surface: Surface) -> HeightDensity:
    """Probability density of the heights, and that of a normal distribution with the same Sq."""
    z = surface.height - surface.height.mean()
    density, edges = np.histogram(1e9 * z, bins=_BINS, density=True)
    height = 0.5 * (edges[1:] + edges[:-1])
    Sq = 1e9 * math.sqrt(np.mean(z**2))
    normal = np.zeros(_BINS)
    if Sq > 0:
        normal = np.exp(-0.5 * (height / Sq) ** 2) / (Sq * math.sqrt(2 * math.pi))
    return HeightDensity(1e-9 * height, 1e9 * density, 1e9 * normal)


def autocorrelation(surface: Surface) -> Autocorrelation:
    """Autocorrelation of the heights minus their mean, shape (nx, ny), lag zero at (nx//2, ny//2).

    It is periodic for a periodic surface, else the mean over the pairs of pixels at each lag, so
    that the finite size of a scan does not bias it.
    """
    from scipy.fft import irfft2, next_fast_len, rfft2

    z = surface.height - surface.height.mean()
    (nx, ny), (hx, hy) = z.shape, surface.grid.spacing
    lag_x, lag_y = np.arange(nx) - nx // 2, np.arange(ny) - ny // 2
    if is_periodic(surface):
        padded, pairs = z.shape, z.size
    else:
        padded = next_fast_len(2 * nx, real=True), next_fast_len(2 * ny, real=True)
        pairs = (nx - np.abs(lag_x))[:, None] * (ny - np.abs(lag_y))[None, :]
    R = irfft2(np.abs(rfft2(z, s=padded)) ** 2, s=padded)[np.ix_(lag_x, lag_y)] / pairs
    whole = R[nx // 2, ny // 2]
    return Autocorrelation(lag_x * hx, lag_y * hy, R / whole if whole > 0 else np.zeros_like(R))


def material_ratio(surface: Surface, points: int = 1001) -> MaterialRatio:
    """Abbott curve with `points` points: the fraction of the surface above each height."""
    ratio = np.linspace(0.0, 1.0, points)
    z = surface.height - surface.height.mean()
    return MaterialRatio(ratio, np.quantile(z, 1 - ratio))


def _decay_lags(R: Autocorrelation) -> Array:
    """Lag (m) of the first fall of the autocorrelation to 0.2 in each direction; NaN if never."""
    from scipy.ndimage import map_coordinates

    if min(R.values.shape) < 2:
        return np.full(_DIRECTIONS, np.nan)
    hx, hy = R.x[1] - R.x[0], R.y[1] - R.y[0]
    lag = np.arange(0.0, min(-R.x[0], -R.y[0]), 0.5 * min(hx, hy))
    angle = np.arange(_DIRECTIONS) * math.pi / _DIRECTIONS
    at = (
        R.values.shape[0] // 2 + np.cos(angle)[:, None] * lag / hx,
        R.values.shape[1] // 2 + np.sin(angle)[:, None] * lag / hy,
    )
    along = map_coordinates(R.values, at, order=1, mode="nearest")
    fallen = along <= _DECAY
    first = np.where(fallen.any(axis=1), fallen.argmax(axis=1), 0)
    rows = np.arange(_DIRECTIONS)
    above = along[rows, first - 1]
    drop = np.where(first > 0, above - along[rows, first], 1.0)
    lags = lag[first - 1] + (above - _DECAY) / drop * lag[1]
    return np.where(first > 0, lags, np.nan)


def _developed_area(surface: Surface) -> float:
    z, (hx, hy) = surface.height, surface.grid.spacing
    if min(z.shape) < 2:
        return 0.0
    x_low, x_high = np.diff(z[:, :-1], axis=0) / hx, np.diff(z[:, 1:], axis=0) / hx
    y_low, y_high = np.diff(z[:-1, :], axis=1) / hy, np.diff(z[1:, :], axis=1) / hy
    lower, upper = np.sqrt(1 + x_low**2 + y_low**2), np.sqrt(1 + x_high**2 + y_high**2)
    return float(0.5 * (lower + upper).mean() - 1)


def _core(curve: MaterialRatio) -> dict[str, float | None]:
    from scipy.integrate import trapezoid

    ratio, height = curve
    span = round(_CORE * (ratio.size - 1))
    start = int(np.argmin(height[:-span] - height[span:]))
    slope = (height[start + span] - height[start]) / _CORE
    top = float(height[start] - slope * ratio[start])
    bottom = top + float(slope)
    above, below = np.maximum(height - top, 0.0), np.maximum(bottom - height, 0.0)
    # Spk is the height of a triangle with the base Smr1 and the same area as the curve above the
    # core. Svk is the height of a triangle with the base 1 − Smr2 and the same area as the curve
    # below the core.
    Smr1, Smr2 = float(np.mean(height > top)), float(np.mean(height >= bottom))
    peaks, dales = (float(trapezoid(part, ratio)) for part in (above, below))
    return {
        "Sk_m": top - bottom,
        "Spk_m": 2 * peaks / Smr1 if Smr1 > 0 else 0.0,
        "Svk_m": 2 * dales / (1 - Smr2) if Smr2 < 1 else 0.0,
        "Smr1": Smr1,
        "Smr2": Smr2,
    }
