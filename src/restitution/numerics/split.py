"""Convolution with a kernel that falls as 1/r, in single precision, without twice the nodes.

The kernel is split into what is near and what is smooth (Ewald 1921, Ann. Phys. 369, 253–287):

    K = [K − F] + F,   F(r) = A erf(r/(√2 s))/r,   A = r K(r) far away.

The near part vanishes beyond some 4.5 s, so that padding by as much is enough. The smooth part has
the spectrum 2πA erfc(qs/√2)/q, no waves much shorter than s: it is G ∗ C ∗ G with G a normal
distribution of standard deviation g. The first G is applied to the waves of p that a grid of cells
`_COARSE` times as long carries, C is a convolution on that grid, and the second G brings its waves
back: no value is spread or interpolated in space. What the two G take away C has to bring back: its
spectrum is that of the smooth part times exp(q²g²), so that

    C(r) = A ∫ J₀(qr) erfcx(qs/√2) exp(−q²c²/2) dq,   c² = s² − 2g².

K is the mean of A/r over a cell, to fourth order that by Simpson's rule, and so is what is taken
for F: without that the near part would fall as 1/r³ only.
"""

from __future__ import annotations

import math
from copy import copy
from functools import cache
from typing import Any, Self

import ducc0
import numpy as np
from numpy.typing import NDArray
from scipy.special import erf, erfcx, j0

from restitution.numerics import passes
from restitution.numerics.convolution import FreeConvolution, Kernel, threads_for
from restitution.numerics.device import CPU

Array = NDArray[np.float64]

_COARSE = 4  # cells of the fine grid along one of the coarse
# In lengths of the coarse cells:
_G, _C = 1.4, 1.0  # g and c
_S = math.sqrt(2 * _G**2 + _C**2)  # s
_NEAR = 16.0  # beyond it C is a series
_REACH = 4.5  # standard deviations after which nothing is left
_SIMPSON = ((-0.5, 1 / 6), (0.0, 4 / 6), (0.5, 1 / 6))


class SplitConvolution:
    """p ↦ K ∗ p in single precision: an error of about 5e-7 of the largest value.

    `kernel` is that of `FreeConvolution` for arrays of `shape`: means over cells of the size
    `spacing` of a kernel that falls as `strength` over the distance. For arrays on this machine.
    """

    def __init__(
        self,
        kernel: Kernel,
        strength: float,
        spacing: tuple[float, float],
        shape: tuple[int, int],
    ) -> None:
        cell = _COARSE * max(spacing)
        # The smoothed p reaches as far over the edge as G, and the smooth part's end as far back.
        self._first = fx, fy = _cells(_REACH * _G * cell, spacing)
        mx, my = (_size(n + 2 * margin) for n, margin in zip(shape, self._first, strict=True))
        few = mx // _COARSE, my // _COARSE
        self.shape = shape
        self._size, self._few = (mx, my), few
        self._threads, self._coarse_threads = threads_for(mx * my), threads_for(few[0] * few[1])
        lags = np.zeros((mx // 2 + 1, my // 2 + 1))
        i, j = (np.arange(min(2 * n, lags.shape[axis])) for axis, n in enumerate((fx, fy)))
        lags[: i.size, : j.size] = kernel(i[:, None], j[None, :]) - _smooth_part(
            i[:, None], j[None, :], strength, spacing, _S * cell
        )
        self._near = (CPU.even_spectrum(lags, self._threads) / (mx * my)).astype(np.float32)
        hx, hy = spacing

        def far(i: NDArray[np.int64], j: NDArray[np.int64]) -> Array:
            r = _COARSE / cell * np.hypot(i * hx, j * hy)
            return _COARSE**2 * strength / cell * _sharpened(r)

        self._far = FreeConvolution(far, few)
        qx = 2 * np.pi / (mx * hx) * np.fft.fftfreq(few[0], 1 / few[0])[:, None]
        qy = 2 * np.pi / (my * hy) * np.arange(few[1] // 2 + 1)[None, :]
        G = np.exp(-0.5 * (_G * cell) ** 2 * (qx * qx + qy * qy))
        mean = (2 + np.cos(0.5 * hx * qx)) / 3 * (2 + np.cos(0.5 * hy * qy)) / 3
        self._down = (G * mean / (mx * my)).astype(np.float32)
        self._up = (G / (few[0] * few[1])).astype(np.float32)
        self._make_room(np.empty(0, np.float32))

    def _make_room(self, room: NDArray[Any]) -> None:
        (mx, my), (cx, cy) = self._size, self._few
        waves, few = (mx, my // 2 + 1), (cx, cy // 2 + 1)
        shapes = [(*waves, 2), (*few, 2), (self.shape[0], my), (cx, cy)]
        ends = np.cumsum([math.prod(shape) for shape in shapes])
        floats = room.reshape(-1).view(np.float32)
        if floats.size < ends[-1]:  # long and narrow ones are padded to more than twice
            floats = np.empty(ends[-1], np.float32)
        buffers = [
            part.reshape(shape) for part, shape in zip(np.split(floats, ends), shapes, strict=False)
        ]
        self._modes, self._coarse_modes = (part.view(np.complex64)[..., 0] for part in buffers[:2])
        self._padded: NDArray[Any] = buffers[2]
        self._coarse: NDArray[Any] = buffers[3]

    def within(self, room: NDArray[Any]) -> Self:
        """The same operator for another user, in this memory as far as that is large enough."""
        other = copy(self)
        other._far = self._far.fresh()
        other._make_room(room)
        return other

    def __call__(self, p: Array, out: Array) -> Array:
        """K ∗ p, in `out`."""
        fx, fy = self._first
        padded, modes, threads = self._padded, self._modes, self._threads
        here, middle = modes[fx : fx + self.shape[0]], self._size[0] // 2 + 1
        padded[:, :fy] = 0.0
        passes.pad(p, 1.0, padded[:, fy:])
        CPU.forward(padded, (-1,), here, threads)
        modes[:fx] = 0.0
        modes[fx + self.shape[0] :] = 0.0
        CPU.along_columns(modes, forward=True, threads=threads)
        smooth = self._smooth(modes)
        passes.weigh(modes[:middle], self._near)
        passes.weigh(modes[middle:], self._near[middle - 2 : 0 : -1])
        for mine, its in _shared(modes, smooth):
            mine += its
        CPU.along_columns(modes, forward=False, threads=threads)
        CPU.backward(here, (-1,), padded, threads)
        passes.crop(padded[:, fy:], 1.0, out)
        return out

    def _smooth(self, modes: NDArray[Any]) -> NDArray[Any]:
        """The long waves of F ∗ p, of those of p."""
        coarse, waves, threads = self._coarse, self._coarse_modes, self._coarse_threads
        for its, mine in _shared(modes, waves):
            mine[...] = its
        passes.weigh(waves, self._down)
        CPU.along_columns(waves, forward=False, threads=threads)
        CPU.backward(waves, (-1,), coarse, threads)
        self._far.quick(coarse, out=coarse)
        CPU.forward(coarse, (-2, -1), waves, threads)
        passes.weigh(waves, self._up)
        return waves


def _shared(modes: NDArray[Any], waves: NDArray[Any]) -> list[tuple[NDArray[Any], NDArray[Any]]]:
    """The parts of both that belong to the same waves; `waves` has the long ones only."""
    rows, columns = waves.shape
    half = rows // 2
    return [(modes[:half, :columns], waves[:half]), (modes[-half:, :columns], waves[half:])]


def _cells(length: float, spacing: tuple[float, float]) -> tuple[int, int]:
    """Cells along x and y that make up a length."""
    return math.ceil(length / spacing[0]), math.ceil(length / spacing[1])


def _size(minimum: int) -> int:
    """A fast FFT size, at least `minimum`, that holds an even number of coarse cells."""
    return 2 * _COARSE * int(ducc0.fft.good_size(-(-minimum // (2 * _COARSE)), True))


def _smooth_part(
    i: NDArray[np.int64],
    j: NDArray[np.int64],
    strength: float,
    spacing: tuple[float, float],
    width: float,
) -> Array:
    """The mean of F over the cell at lag (i, j)."""
    total = np.zeros(np.broadcast_shapes(i.shape, j.shape))
    for a, share in _SIMPSON:
        for b, its in _SIMPSON:
            r = np.hypot((i + a) * spacing[0], (j + b) * spacing[1])
            at_zero = strength * math.sqrt(2 / math.pi) / width
            wave = strength * erf(r / (math.sqrt(2) * width))
            total += share * its * np.divide(wave, r, out=np.full(r.shape, at_zero), where=r > 0)
    return total


def _sharpened(r: Array) -> Array:
    """C/A at distances in lengths of the coarse cells."""
    near = r < _NEAR
    far = np.where(near, _NEAR, r)
    x = (_G / far) ** 2
    # exp(−g²∇²) of 1/r, which is smooth there; ∇² r⁻ⁿ = n² r⁻ⁿ⁻².
    series = 1 - x * (1 - x * 9 / 2 * (1 - x * 25 / 3 * (1 - x * 49 / 4 * (1 - x * 81 / 5))))
    values: Array = series / far
    values[near] = _integral()(r[near])
    return values


@cache
def _integral() -> np.polynomial.Chebyshev:
    """C/A near the origin, by quadrature; to 3e-8 of the value."""
    nodes, weights = np.polynomial.legendre.leggauss(80)
    most = 7 / _C  # where the integrand is exp(−7²/2) = 2e-11
    q, dq = 0.5 * most * (nodes + 1), 0.5 * most * weights
    integrand = dq * erfcx(q * _S / math.sqrt(2)) * np.exp(-0.5 * (_C * q) ** 2)
    return np.polynomial.Chebyshev.interpolate(
        lambda r: j0(r[:, None] * q) @ integrand, 60, domain=[0, _NEAR]
    )
