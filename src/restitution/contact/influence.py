"""Elastic half-space of both bodies: displacement due to uniform pressure or shear on a rectangle.

Pressure and displacement are positive into the body. In shear, traction and displacement are along
x. On a periodic half-space, the displacement due to a pressure wave with the angular wave number q
is 2/(E* |q|) times the pressure (Johnson 1985, *Contact Mechanics*, §13.2).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.convolution.cache import operator_cache
from restitution.numerics.convolution.device import CPU, Device, current
from restitution.numerics.convolution.operators import (
    Convolution,
    FreeConvolution,
    Kernel,
    PeriodicConvolution,
    SpectralFilter,
    WrappedConvolution,
)
from restitution.numerics.expressions import multipoles
from restitution.numerics.quadratic.near_filter import NearFilter

Array = NDArray[np.float64]
Operator = TypeVar("Operator", Convolution, FreeConvolution, PeriodicConvolution, SpectralFilter)
Arguments = ParamSpec("Arguments")

# Distance (in cell diagonals) beyond which the series of `far_displacement` is used. Beyond this
# distance the relative error of the series is under 2e-12. The relative error of Love's formula
# grows, due to cancellation, as the square of the distance.
_FAR = 32.0
# Shorter edge of the grid (nodes) from which wrapping saves time.
_MIN_NODES_TO_WRAP = 160
# Largest operator and largest block of coefficients that are cached, as fractions of the size of
# the cache. Larger operators are not cached, because a few of them would fill the cache. With the
# default size of the cache, operators of up to 1400² nodes are cached.
_MAX_OPERATOR, _MAX_COEFFICIENTS = 1 / 15, 2 / 3


def _cached(build: Callable[Arguments, Operator]) -> Callable[Arguments, Operator]:

    @functools.wraps(build)
    def cached(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Operator:
        key = build, args, tuple(kwargs.items()), current()
        operator: Operator | None = operator_cache.get(key)
        if operator is None:
            operator = build(*args, **kwargs)
            if operator.nbytes <= _MAX_OPERATOR * operator_cache.max_bytes:
                operator_cache.put(key, operator)
        return operator.with_own_workspace()

    return cached


def love_displacement(x: Array, y: Array, hx: float, hy: float, contact_modulus: float) -> Array:
    """Displacement (m/Pa) at (x, y) per unit pressure on a cell hx × hy at the origin.

    Source: Love (1929), Phil. Trans. R. Soc. A 228, 377, in the form of Johnson (1985), *Contact
    Mechanics*, eq. 3.25. `x` and `y` (m) broadcast together.
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
    """Displacement (m/Pa) as in `love_displacement`, by a series that holds far from the cell.

    The Taylor series of the displacement due to a point load, averaged over the cell, is
    u πE*/(p hx hy) = [1 + (hx²∂x² + hy²∂y²)/24 + hx⁴∂x⁴/1920 + hx²hy²∂x²∂y²/576 + hy⁴∂y⁴/1920] 1/r.
    `x` (m) is a column and `y` (m) a row.
    """
    xx, yy = hx * hx, hy * hy
    # Coefficients of polynomials in c, the squared direction cosine along x. They follow from
    # ∂x² 1/r = (3c − 1)/r³ and from the higher derivatives of 1/r.
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


def cerruti_displacement(
    x: Array, y: Array, hx: float, hy: float, compliances: tuple[float, float]
) -> Array:
    """Displacement (m/Pa) along x at (x, y) per unit traction along x on a cell at the origin.

    Source: Cerruti (1882); Johnson (1985), *Contact Mechanics*, eq. 3.75, integrated over the cell:
    α [[x asinh(y/|x|)]] + β [[y asinh(x/|y|)]] with the `compliances` α and β. Double brackets are
    sums over the corners with alternating signs. The relative error is below 1e-9 up to 1000 cells.
    `x` and `y` (m) broadcast together, and must not lie on the lines through the edges of the cell.
    """
    alpha, beta = compliances
    displacement: Array = np.zeros(np.broadcast_shapes(x.shape, y.shape))
    for sign_x, sign_y in ((1, 1), (-1, -1), (1, -1), (-1, 1)):
        X, Y = x + 0.5 * sign_x * hx, y + 0.5 * sign_y * hy
        corner = alpha * X * np.arcsinh(Y / np.abs(X)) + beta * Y * np.arcsinh(X / np.abs(Y))
        displacement += sign_x * sign_y * corner
    return displacement


def influence_coefficients(
    i: NDArray[np.int64],
    j: NDArray[np.int64],
    spacing: tuple[float, float],
    contact_modulus: float,
    device: Device = CPU,
) -> Array:
    """Displacement per unit pressure (m/Pa), `i` (a column) and `j` (a row) cells away."""
    # Coefficients of cells of equal shape are proportional to the cell width and to 1/E*. So they
    # are computed for E* = 1 and cells of unit width, and then scaled.
    hx, hy = spacing
    lags, aspect, scale = (i.size, j.size), hy / hx, hx / contact_modulus
    if i.size * j.size <= _most_coefficients():
        return _unit_coefficients(lags, aspect, device) * scale
    scaled = _compute_coefficients(lags, (1.0, aspect), device)
    scaled *= scale
    return scaled


@_cached
def half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> FreeConvolution:
    """Operator from pressure to displacement on a free half-space, on the current device."""
    return FreeConvolution(_kernel(spacing, contact_modulus), shape, current())


@_cached
def approximate_half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> Convolution:
    """`half_space` in single precision and, on large grids, with the errors of wrapping."""
    kernel = _kernel(spacing, contact_modulus)
    if min(shape) < _MIN_NODES_TO_WRAP:
        return FreeConvolution(kernel, shape, current(), single=True)
    return WrappedConvolution(kernel, shape, current())


@_cached
def inverse_half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> SpectralFilter:
    """Approximate inverse of `half_space`, exact for a periodic half-space."""

    def symbol(qx: Array, qy: Array) -> Array:
        q = _wave_numbers(qx, qy, spacing)
        # The displacement due to a mean pressure is not defined on a periodic half-space. For the
        # mean, half the wave number of the longest wave is used.
        longest = [2 * np.pi / min(spacing), *map(float, q[1:2, 0]), *map(float, q[0, 1:2])]
        q[0, 0] = 0.5 * min(longest)
        q *= 0.5 * contact_modulus
        return q

    return SpectralFilter(symbol, shape, current())


def short_inverse_half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> NearFilter:
    """Approximate inverse of `half_space` for short waves, on arrays of any `shape`."""
    hx, hy = spacing
    return NearFilter(hy / hx, 0.5 * contact_modulus / hx)


@_cached
def shear_half_space(
    shape: tuple[int, int], spacing: tuple[float, float], compliances: tuple[float, float]
) -> FreeConvolution:
    """Operator from traction to displacement, both along x; `compliances` are those of `Pair`."""
    hx, hy = spacing

    def kernel(i: NDArray[np.int64], j: NDArray[np.int64]) -> Array:
        x, y = (np.asarray(h * lag, dtype=np.float64) for h, lag in ((hx, i), (hy, j)))
        return cerruti_displacement(x, y, hx, hy, compliances)

    return FreeConvolution(kernel, shape, current())


@_cached
def periodic_half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> PeriodicConvolution:
    """Operator from pressure to displacement on one period; the mean displacement is zero."""
    return _with_mean(0.0, shape, spacing, contact_modulus)


@_cached
def sprung_half_space(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> PeriodicConvolution:
    """Operator of a periodic half-space on an elastic foundation, which is positive definite."""
    compliance = foundation_compliance(shape, spacing, contact_modulus)
    return _with_mean(compliance, shape, spacing, contact_modulus)


def foundation_compliance(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> float:
    """Compliance (m/Pa) of the foundation: that of a wave twice as long as the longer edge."""
    q = math.pi / max(n * h for n, h in zip(shape, spacing, strict=True))
    return 2 / (contact_modulus * q)


def _kernel(spacing: tuple[float, float], contact_modulus: float) -> Kernel:
    device = current()

    def kernel(i: NDArray[np.int64], j: NDArray[np.int64]) -> Array:
        # FreeConvolution works with transposed arrays: the lags i along x are a row, and the lags j
        # along y are a column. Therefore i and j are exchanged here, and so are the spacings.
        return influence_coefficients(j, i, spacing[::-1], contact_modulus, device)

    return kernel


def _unit_coefficients(lags: tuple[int, int], aspect: float, device: Device) -> Array:
    """Influence coefficients for cells 1 × `aspect` and E* = 1; callers must not modify them.

    The cache keeps the largest block of coefficients so far, and smaller blocks are views of it.
    """
    key = _compute_coefficients, aspect, device
    known: Array | None = operator_cache.get(key)
    if known is not None and known.shape[0] >= lags[0] and known.shape[1] >= lags[1]:
        return known[: lags[0], : lags[1]]
    block = lags
    if known is not None:
        rows, columns = (max(*pair) for pair in zip(known.shape, lags, strict=True))
        block = (rows, columns) if rows * columns <= _most_coefficients() else lags
    computed = _compute_coefficients(block, (1.0, aspect), device)
    operator_cache.put(key, computed)
    return computed[: lags[0], : lags[1]]


def _most_coefficients() -> int:
    return int(_MAX_COEFFICIENTS * operator_cache.max_bytes) // np.dtype(np.float64).itemsize


def _compute_coefficients(
    lags: tuple[int, int], spacing: tuple[float, float], device: Device
) -> Array:
    hx, hy = spacing
    x: Array = hx * device.arange(lags[0])[:, None]
    y: Array = hy * device.arange(lags[1])[None, :]
    near_i, near_j = (math.ceil(_FAR * math.hypot(hx, hy) / h) for h in spacing)
    # The series divides by zero at the origin. The origin is in the near block, which Love's
    # formula overwrites.
    with np.errstate(divide="ignore", invalid="ignore"):
        u = far_displacement(x, y, hx, hy, 1.0)
    u[:near_i, :near_j] = love_displacement(x[:near_i], y[:, :near_j], hx, hy, 1.0)
    return u


def _with_mean(
    compliance: float,
    shape: tuple[int, int],
    spacing: tuple[float, float],
    contact_modulus: float,
) -> PeriodicConvolution:

    def symbol(qx: Array, qy: Array) -> Array:
        q = _wave_numbers(qx, qy, spacing)
        q[0, 0] = 1.0  # avoids a division by zero
        displacement: Array = 2 / contact_modulus / q
        displacement[0, 0] = compliance
        return displacement

    return PeriodicConvolution(symbol, shape, current())


def _wave_numbers(qx: Array, qy: Array, spacing: tuple[float, float]) -> Array:
    return np.sqrt((qx / spacing[0]) ** 2 + (qy / spacing[1]) ** 2)
