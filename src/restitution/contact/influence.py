"""Elastic half-space: displacement under a rectangle of uniform pressure.

Conventions: pressure > 0 pushes into the body, displacement > 0 is into the body, both bodies are
lumped into one half-space of contact modulus E*: 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.convolution.device import CPU, Device, current
from restitution.numerics.convolution.operators import FreeConvolution, SpectralFilter
from restitution.numerics.multipoles import multipoles

if TYPE_CHECKING:
    from functools import _lru_cache_wrapper

Array = NDArray[np.float64]
Operator = TypeVar("Operator", FreeConvolution, SpectralFilter)

# Beyond this distance (in cell diagonals) the series below differs from Love's formula by less than
# 2e-12 of the value, while the formula itself loses digits to cancellation as (r/h)².
_FAR = 32.0


def love_displacement(x: Array, y: Array, hx: float, hy: float, contact_modulus: float) -> Array:
    """Displacement at (x, y) per unit pressure on the cell hx × hy at the origin, m/Pa.

    Love (1929), Phil. Trans. R. Soc. A 228, 377; the form of Johnson (1985), *Contact Mechanics*,
    eq. 3.25. `x` and `y` (m) broadcast together.
    """
    a, b = 0.5 * hx, 0.5 * hy
    pp, pm = np.hypot(x + a, y + b), np.hypot(x + a, y - b)
    mp, mm = np.hypot(x - a, y + b), np.hypot(x - a, y - b)
    displacement: Array = (
        (x + a) * np.log(((y + b) + pp) / ((y - b) + pm))
        + (y + b) * np.log(((x + a) + pp) / ((x - a) + mp))
        + (x - a) * np.log(((y - b) + mm) / ((y + b) + mp))
        + (y - b) * np.log(((x - a) + mm) / ((x + a) + pm))
    )
    displacement /= np.pi * contact_modulus
    return displacement


def far_displacement(x: Array, y: Array, hx: float, hy: float, contact_modulus: float) -> Array:
    """The same far from the cell: Taylor series of the point load averaged over the cell.

    u πE*/(p hx hy) = [1 + (hx²∂x² + hy²∂y²)/24 + hx⁴∂x⁴/1920 + hx²hy²∂x²∂y²/576 + hy⁴∂y⁴/1920] 1/r;
    the next term is of relative order (h/r)⁶. `x` and `y` (m) are a column and a row.
    """
    xx, yy = hx * hx, hy * hy
    # ∂x² 1/r = (3c − 1)/r³ and so on, with c the squared direction cosine along x.
    second = np.array([2 * yy - xx, 3 * (xx - yy), 0.0]) / 24
    fourth = (
        np.array([9 * xx * xx + 24 * yy * yy, -90 * xx * xx - 120 * yy * yy, 105 * (xx**2 + yy**2)])
        / 1920
        + xx * yy * np.array([-12, 105, -105]) / 576
    )
    moments = np.array([[1.0, 0.0, 0.0], second, fourth]) * (hx * hy / (np.pi * contact_modulus))
    far: Array = np.empty_like(x, shape=np.broadcast_shapes(x.shape, y.shape), dtype=np.float64)
    multipoles(x, y, moments, far)
    return far


def influence_coefficients(
    i: NDArray[np.int64],
    j: NDArray[np.int64],
    spacing: tuple[float, float],
    contact_modulus: float,
    device: Device = CPU,
) -> Array:
    """Displacement at lag (i, j) cells, i as a column (from 0) and j as a row (from 0), m/Pa."""
    # Lengths scale: u/h depends on the shape of the cells and on the lag alone.
    hx, hy = spacing
    lags, aspect, scale = (i.size, j.size), hy / hx, hx / contact_modulus
    if i.size * j.size <= _MOST_KNOWN:
        scaled: Array = _unit_coefficients(lags, aspect, device) * scale
    else:
        scaled = _compute_coefficients(lags, (1.0, aspect), device)
        scaled *= scale
    return scaled


def half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> FreeConvolution:
    """The operator p ↦ u on a block of nodes of the free (non-periodic) half-space.

    Arrays are of that shape, on the current device.
    """
    return _kept(_half_space, shape)(
        shape, spacing, contact_modulus, current()
    ).with_own_workspace()


def inverse_half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> SpectralFilter:
    """An approximate inverse, u ↦ |q| E*/2 u: exact on a periodic half-space (Johnson 1985)."""
    build = _kept(_inverse_half_space, shape)
    return build(shape, spacing, contact_modulus, current()).with_own_workspace()


def _kept(build: _lru_cache_wrapper[Operator], shape: tuple[int, int]) -> Callable[..., Operator]:
    """`build` with its cache, or without it where what it keeps would fill the memory."""
    return build if shape[0] * shape[1] <= _MOST_KEPT else build.__wrapped__


# Boxes follow the contact, so that most solves want coefficients of a block larger or smaller than
# the last: the largest block so far is kept, by the aspect ratio of the cells and the device.
_known: dict[tuple[float, Device], Array] = {}
_MOST_KNOWN = 2**25  # coefficients: 256 MiB, for 4096² nodes half of that
_MOST_KEPT = 2**21  # nodes of an operator that is kept: 16 MiB


def _unit_coefficients(lags: tuple[int, int], aspect: float, device: Device) -> Array:
    """Coefficients for cells 1 × `aspect` and E* = 1."""
    known = _known.get((aspect, device), np.empty((0, 0)))
    if known.shape[0] < lags[0] or known.shape[1] < lags[1]:
        rows, columns = (max(*pair) for pair in zip(known.shape, lags, strict=True))
        both = (rows, columns) if rows * columns <= _MOST_KNOWN else lags
        known = _compute_coefficients(both, (1.0, aspect), device)
        _known.clear()
        _known[aspect, device] = known
    return known[: lags[0], : lags[1]]


def _compute_coefficients(
    lags: tuple[int, int], spacing: tuple[float, float], device: Device
) -> Array:
    hx, hy = spacing
    x: Array = hx * device.arange(lags[0])[:, None]
    y: Array = hy * device.arange(lags[1])[None, :]
    near_i, near_j = (math.ceil(_FAR * math.hypot(hx, hy) / h) for h in spacing)
    # The origin is always in the near block, which Love's formula overwrites.
    with np.errstate(divide="ignore", invalid="ignore"):
        u = far_displacement(x, y, hx, hy, 1.0)
    u[:near_i, :near_j] = love_displacement(x[:near_i], y[:, :near_j], hx, hy, 1.0)
    return u


@lru_cache(maxsize=8)
def _half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float, device: Device
) -> FreeConvolution:
    def kernel(i: NDArray[np.int64], j: NDArray[np.int64]) -> Array:
        # It comes as a row of i and a column of j.
        return influence_coefficients(j, i, spacing[::-1], contact_modulus, device)

    return FreeConvolution(kernel, shape, device)


@lru_cache(maxsize=8)
def _inverse_half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float, device: Device
) -> SpectralFilter:

    def symbol(qx: Array, qy: Array) -> Array:
        q: Array = np.sqrt((qx / spacing[0]) ** 2 + (qy / spacing[1]) ** 2)
        # The mean mode has no inverse on a periodic half-space; half of the longest wave serves.
        longest = [2 * np.pi / min(spacing)]
        longest += [float(q[1, 0])] if q.shape[0] > 1 else []
        longest += [float(q[0, 1])] if q.shape[1] > 1 else []
        q[0, 0] = 0.5 * min(longest)
        q *= 0.5 * contact_modulus
        return q

    return SpectralFilter(symbol, shape, device)
