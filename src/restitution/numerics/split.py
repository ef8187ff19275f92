"""Convolution with a kernel that falls as 1/r, without padding to twice the nodes.

The kernel is split into what is near and what is smooth (Ewald 1921, Ann. Phys. 369, 253–287):

    K = [K − F] + F,   F(r) = A erf(r/(√2 s))/r,   A = r K(r) far away.

The near part vanishes beyond some multiple of s, so that padding by as much is enough. The smooth
part has the spectrum 2πA erfc(qs/√2)/q, no waves much shorter than s: it is G ∗ C ∗ G with G a
normal distribution of standard deviation g. The first G is applied to the waves of p that a grid of
cells `_COARSE` times as long carries, C is a convolution on that grid, and the second G brings its
waves back: no value is spread or interpolated in space. Both F and C are sums of Gaussians,

    F(r) = 2A/√π ∫ exp(−r²t²) dt,   0 < t < 1/(√2 s),

and as G ∗ G has the variance 2g², C is what F is with all variances less by that:

    C(r) = 2A/√π ∫ exp(−r²t²) (1 + 4g²t²)^(−1/2) dt,   0 < t < 1/(√2 c),   c² = s² − 2g².

K is the mean of A/r over a cell, and what is taken for F is one, too (by Gauss's formula): without
that the near part would fall as 1/r³ only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from restitution.numerics import passes
from restitution.numerics.convolution import (
    FreeConvolution,
    Kernel,
    blocks,
    fast_size,
    threads_for,
    weigh_evenly,
)
from restitution.numerics.device import CPU, Device

Array = NDArray[np.float64]

_COARSE = 4  # cells of the fine grid along one of the coarse
_MEAN = np.polynomial.legendre.leggauss(3)  # on (−1, 1), as all of Gauss's nodes and weights
_PANEL = np.polynomial.legendre.leggauss(10)


class _Precision(NamedTuple):
    """How wide the Gaussians have to be for what lies beyond them not to matter, in q and in r."""

    real: type
    complex: type
    g: float  # in lengths of the coarse cells
    c: float
    reach: float  # standard deviations g after which nothing is left

    @property
    def s(self) -> float:
        return math.hypot(math.sqrt(2) * self.g, self.c)


# Found by trial: the errors, 1e-13 and 5e-7 of the largest value, are about those of rounding.
_DOUBLE = _Precision(np.float64, np.complex128, 2.2, 1.6, 7.0)
_SINGLE = _Precision(np.float32, np.complex64, 1.4, 1.0, 4.5)


class SplitConvolution:
    """p ↦ K ∗ p for arrays of one shape; `count` tells how often it was applied.

    For `kernel`, `shape`, `device` and batches see `FreeConvolution`, which does the same. The
    kernel's values are means over cells of the size `spacing` of one that falls as `strength` over
    the distance.
    """

    def __init__(
        self,
        kernel: Kernel,
        strength: float,
        spacing: tuple[float, float],
        shape: tuple[int, int],
        device: Device = CPU,
    ) -> None:
        self.shape = shape
        self._device = device
        self._double, self._single = (
            _Split(kernel, strength, spacing, shape, device, precision)
            for precision in (_DOUBLE, _SINGLE)
        )
        self._make_room(())

    def _make_room(self, batch: tuple[int, ...]) -> None:
        self.count = 0
        size = max(part.bytes(batch) for part in (self._double, self._single))
        room = self._device.empty((size,), np.uint8)
        self._double, self._single = (
            part.within(room, batch) for part in (self._double, self._single)
        )

    def fresh(self, batch: tuple[int, ...] = ()) -> Self:
        """The same operator with buffers and a count of its own, for another user or a batch."""
        other = copy(self)
        other._make_room(batch)
        return other

    def __call__(self, p: Array, out: Array | None = None) -> Array:
        """Return K ∗ p, same shape as `p`: in a new array, or in `out`."""
        self.count += 1
        return self._double(p, out)

    def quick(self, p: Array, out: Array | None = None) -> Array:
        """The same for work in single precision: an error of about 5e-7 of the largest value."""
        self.count += 1
        return self._single(p, out)


class _Split:
    """The convolution in one precision, in memory that it is given."""

    def __init__(
        self,
        kernel: Kernel,
        strength: float,
        spacing: tuple[float, float],
        shape: tuple[int, int],
        device: Device,
        precision: _Precision,
    ) -> None:
        cell, (hx, hy) = _COARSE * max(spacing), spacing
        # The smoothed p reaches as far over the edge as G, and the smooth part's end as far back.
        margin = precision.reach * precision.g * cell
        self._first = fx, fy = math.ceil(margin / hx), math.ceil(margin / hy)
        mx, my = (_size(n + 2 * first) for n, first in zip(shape, self._first, strict=True))
        few = mx // _COARSE, my // _COARSE
        self._shape, self._size, self._few = shape, (mx, my), few
        self._device, self._precision = device, precision

        lags = device.empty((mx // 2 + 1, my // 2 + 1), np.float64)
        lags[...] = 0.0
        i, j = device.arange(min(2 * fx, mx // 2 + 1)), device.arange(min(2 * fy, my // 2 + 1))
        lags[: i.size, : j.size] = kernel(i[:, None], j[None, :]) - _smooth_part(
            i, j, strength, spacing, precision.s * cell, device
        )
        near = device.even_spectrum(lags, threads_for(lags.size)) / (mx * my)
        self._near: Array = near.astype(precision.real)

        coarse = _COARSE * hx, _COARSE * hy
        self._far = FreeConvolution(
            lambda i, j: _sharpened(i, j, _COARSE**2 * strength, coarse, precision, device),
            few,
            device,
        )
        qx = 2 * np.pi / (mx * hx) * device.arange(few[0] // 2 + 1)[:, None]
        qy = 2 * np.pi / (my * hy) * device.arange(few[1] // 2 + 1)[None, :]
        G = np.exp(-0.5 * (precision.g * cell) ** 2 * (qx * qx + qy * qy))
        mean = _mean(lambda a: np.cos(a * hx * qx)) * _mean(lambda a: np.cos(a * hy * qy))
        self._down: Array = (G * mean / (mx * my)).astype(precision.real)
        self._up: Array = (G / (few[0] * few[1])).astype(precision.real)

    def _buffers(self, batch: tuple[int, ...]) -> list[tuple[tuple[int, ...], type]]:
        """Shapes and types of what is needed to work on a batch."""
        (mx, my), (cx, cy) = self._size, self._few
        rows = min(self._shape[0], max(1, self._device.row_buffer // (math.prod(batch) * my)))
        real, complex_ = self._precision.real, self._precision.complex
        return [
            ((*batch, mx, my // 2 + 1), complex_),
            ((*batch, cx, cy // 2 + 1), complex_),
            ((*batch, rows, my), real),
            ((*batch, cx, cy), real),
        ]

    def bytes(self, batch: tuple[int, ...]) -> int:
        """The memory that takes."""
        return sum(
            math.prod(shape) * np.dtype(kind).itemsize for shape, kind in self._buffers(batch)
        )

    def within(self, room: NDArray[np.uint8], batch: tuple[int, ...]) -> Self:
        """The same operator for another user, whose memory this is."""
        other = copy(self)
        other._far = self._far.fresh(batch)
        other._divide(room, batch)
        return other

    def _divide(self, room: NDArray[np.uint8], batch: tuple[int, ...]) -> None:
        buffers: list[NDArray[Any]] = []
        for shape, kind in self._buffers(batch):
            size = math.prod(shape) * np.dtype(kind).itemsize
            buffers.append(room[:size].view(kind).reshape(shape))
            room = room[size:]
        self._modes, self._coarse_modes, self._padded, self._coarse = buffers
        items = math.prod(batch)
        self._threads = threads_for(items * math.prod(self._size))
        self._coarse_threads = threads_for(items * math.prod(self._few))

    def __call__(self, p: Array, out: Array | None) -> Array:
        """K ∗ p, in `out` or in a new array."""
        result = np.empty_like(p, dtype=np.float64, order="C") if out is None else out
        (fx, fy), nx = self._first, self._shape[0]
        modes, device, threads = self._modes, self._device, self._threads
        here = modes[..., fx : fx + nx, :]
        for some, rows in blocks(nx, self._padded):
            rows[..., :fy] = 0.0
            passes.pad(p[..., some, :], 1.0, rows[..., fy:])
            device.forward(rows, (-1,), here[..., some, :], threads)
        modes[..., :fx, :] = 0.0
        modes[..., fx + nx :, :] = 0.0
        device.along_columns(modes, forward=True, threads=threads)
        smooth = self._smooth(modes)
        weigh_evenly(modes, self._near)
        for mine, its in _shared(modes, smooth):
            mine += its
        device.along_columns(modes, forward=False, threads=threads)
        for some, rows in blocks(nx, self._padded):
            device.backward(here[..., some, :], (-1,), rows, threads)
            passes.crop(rows[..., fy:], 1.0, result[..., some, :])
        return result

    def _smooth(self, modes: NDArray[Any]) -> NDArray[Any]:
        """The long waves of F ∗ p, of those of p."""
        coarse, waves = self._coarse, self._coarse_modes
        device, threads = self._device, self._coarse_threads
        for its, mine in _shared(modes, waves):
            mine[...] = its
        weigh_evenly(waves, self._down)
        device.along_columns(waves, forward=False, threads=threads)
        device.backward(waves, (-1,), coarse, threads)
        convolve = self._far if self._precision is _DOUBLE else self._far.quick
        convolve(coarse, out=coarse)
        device.forward(coarse, (-2, -1), waves, threads)
        weigh_evenly(waves, self._up)
        return waves


def _shared(modes: NDArray[Any], waves: NDArray[Any]) -> list[tuple[NDArray[Any], NDArray[Any]]]:
    """The parts of both that belong to the same waves; `waves` has the long ones only."""
    rows, columns = waves.shape[-2:]
    half = rows // 2
    long = modes[..., :columns]
    return [
        (long[..., :half, :], waves[..., :half, :]),
        (long[..., -half:, :], waves[..., -half:, :]),
    ]


def _size(minimum: int) -> int:
    """A fast FFT size, at least `minimum`, that holds an even number of coarse cells."""
    return 2 * _COARSE * fast_size(-(-minimum // (2 * _COARSE)))


def _mean(values: Callable[[float], Array]) -> Array:
    """The mean of `values(a)` over −1/2 < a < 1/2."""
    first, *others = (0.5 * w * values(0.5 * x) for x, w in zip(*_MEAN, strict=True))
    return sum(others, first)


def _smooth_part(
    i: NDArray[np.int64],
    j: NDArray[np.int64],
    strength: float,
    spacing: tuple[float, float],
    width: float,
    device: Device,
) -> Array:
    """The mean of F over the cells at lags `i` along x and `j` along y, `width` being s."""
    hx, hy = spacing
    t, weights = _gaussians(width, math.hypot(i.size * hx, j.size * hy), device)
    along_x = _mean(lambda a: np.exp(-(((i[:, None] + a) * hx * t) ** 2)))
    along_y = _mean(lambda a: np.exp(-(((j[:, None] + a) * hy * t) ** 2)))
    mean: Array = (along_x * (strength * weights)) @ along_y.T
    return mean


def _sharpened(
    i: NDArray[np.int64],
    j: NDArray[np.int64],
    strength: float,
    spacing: tuple[float, float],
    precision: _Precision,
    device: Device,
) -> Array:
    """C at lags `i` (a column) and `j` (a row) of coarse cells of the size `spacing`."""
    (hx, hy), cell = spacing, max(spacing)
    t, weights = _gaussians(precision.c * cell, math.hypot(i.size * hx, j.size * hy), device)
    weights = strength * weights / np.sqrt(1 + (2 * precision.g * cell * t) ** 2)
    C: Array = (np.exp(-((i * hx * t) ** 2)) * weights) @ np.exp(-((j.T * hy * t) ** 2)).T
    return C


def _gaussians(width: float, longest: float, device: Device) -> tuple[Array, Array]:
    """Values of t and weights of the sum of exp(−r²t²) that is erf(r/(√2 width))/r.

    The function is 2/√π times the integral of exp(−r²t²) from 0 to 1/(√2 width). By Gauss's formula
    on one half of what is left after the other, down to where 1/t is the longest r.
    """
    end = 1 / (math.sqrt(2) * width)
    halves = math.ceil(math.log2(max(end * longest, 1.0)))
    ends = end * np.concatenate([[0.0], 0.5 ** np.arange(halves, -1, -1)])
    nodes, weights = _PANEL
    half = 0.5 * np.diff(ends)[:, None]
    t = ends[:-1, None] + half * (nodes + 1)
    weights = 2 / math.sqrt(math.pi) * half * weights
    return device.put(t.ravel()), device.put(weights.ravel())
