"""Convolution with a real, even kernel by FFT: linear (zero-padded) or periodic.

    u[i, j] = Σ_kl  K[|i − k|, |j − l|] p[k, l].

With n nodes along an axis, zero padding to any size ≥ 2n − 1 makes the circular convolution equal
to the linear one (Liu, Wang and Liu 2000, Wear 243, 101–111, "DC-FFT"). The spectrum of an even
kernel is real; only one quadrant is stored.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from itertools import count
from threading import Lock
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.convolution.device import CPU, Device, is_fast
from restitution.numerics.expressions import max_magnitude
from restitution.numerics.quadratic.grid_transfer import coarsened, prolonged

Array = NDArray[np.float64]
# Function that returns the kernel at integer lags i and j, given as two arrays that are broadcast
# against each other. The operator may overwrite the returned array.
Kernel = Callable[[NDArray[np.int64], NDArray[np.int64]], Array]

# Function that returns the spectrum of a kernel at the angular wave numbers qx and qy (rad per
# cell, ≥ 0), given as two arrays that are broadcast against each other. The operator may overwrite
# the returned array.
Symbol = Callable[[Array, Array], Array]


# Number of nodes by which the period of a `WrappedConvolution` is longer than its array. Across a
# shorter distance, the other side of the periodic array would act on single nodes.
_MARGIN = 24


def fast_size(minimum: int) -> int:
    """Smallest size ≥ `minimum` that has only the prime factors 2, 3, 5 and 7."""
    return next(filter(is_fast, count(minimum)))


def _even_fast_size(minimum: int) -> int:
    return next(size for size in count(minimum + minimum % 2, 2) if is_fast(size))


class _Spectral:
    """Multiplication of the Fourier modes of a zero-padded array by a real, even spectrum.

    `count` counts multiplications. A lock guards the workspace, which is kept.
    """

    def __init__(self, shape: tuple[int, int], periods: tuple[int, int], device: Device) -> None:
        self.shape = shape
        self._periods = periods
        self._device = device
        self.count = 0
        self._lock = Lock()
        self._workspace: NDArray[Any] | None = None

    def with_own_workspace(self) -> Self:
        """Return a copy for another solve, with its own workspace and with `count` set to 0."""
        other = copy(self)
        other._lock, other._workspace, other.count = Lock(), None, 0
        return other

    def _convolve(self, p: Array, spectrum: NDArray[Any], out: Array | None, scale: float) -> Array:
        result = np.empty_like(p, dtype=np.float64, order="C") if out is None else out
        with self._lock:
            if self._workspace is None:
                self._workspace = self._device.workspace(self.shape, self._periods)
            self._device.convolve(p, spectrum, self._periods, scale, self._workspace, result)
            self.count += 1
        return result


class Convolution(_Spectral):
    """Convolution with a kernel K; `diagonal` is the response of a node to its own value."""

    diagonal: float
    _spectrum: NDArray[Any]
    _single_spectrum: NDArray[np.float32]
    _lags: Array | None = None

    @property
    def nbytes(self) -> int:
        """Size of the spectra (bytes)."""
        return int(self._spectrum.nbytes + self._single_spectrum.nbytes)

    def __call__(self, p: Array, out: Array | None = None) -> Array:
        """Return K ∗ p, with the shape of `p`, in a new array or in `out`."""
        return self._convolve(p, self._spectrum, out, 1.0)

    def single_precision(self, p: Array, out: Array | None = None) -> Array:
        """Return K ∗ p in single precision, with errors up to 9e-7 times its largest magnitude."""
        return self._convolve(p, self._single_spectrum, out, 1.0)

    def without_mean(self, p: Array, out: Array | None = None) -> Array:
        """Return K ∗ p in single precision for a p with local means near zero."""
        return self.single_precision(p, out)

    def lags(self, rows: int, columns: int) -> Array:
        """Kernel at lags below `rows` along x and `columns` along y, transposed."""
        if self._lags is None:
            impulse = np.zeros(self.shape)
            impulse[0, 0] = 1.0
            self._lags = np.ascontiguousarray(self(self._device.put(impulse)).T)
        return self._lags[:columns, :rows]


class FreeConvolution(Convolution):
    """Linear convolution: values outside the array are zero.

    With `single`, only the spectrum of single precision is computed, and used for all products.
    """

    def __init__(
        self,
        kernel: Kernel,
        shape: tuple[int, int],
        device: Device = CPU,
        *,
        single: bool = False,
    ) -> None:
        px, py = (2 * fast_size(n) for n in shape)
        super().__init__(shape, (px, py), device)
        # The kernel is transposed, as `Device.convolve` expects.
        lags = kernel(device.arange(px // 2 + 1)[None, :], device.arange(py // 2 + 1)[:, None])
        self.diagonal, self._kernel = float(lags[0, 0]), kernel
        self._spectrum = device.even_spectrum(lags.astype(np.float32) if single else lags)
        self._single_spectrum = self._spectrum.astype(np.float32, copy=False)

    def lags(self, rows: int, columns: int) -> Array:
        arange = self._device.arange
        return self._kernel(arange(rows)[None, :], arange(columns)[:, None])


class WrappedConvolution(Convolution):
    """Approximate linear convolution with a kernel that decreases slowly, in single precision.

    The period is hardly longer than the array. It takes the kernel at the shorter of the two
    distances between nodes of the periodic array. What this adds, at distances of more than half a
    period, varies slowly, and is subtracted on cells four times as wide. Half as much work as
    `FreeConvolution`; root mean square error 7e-4, at the outermost nodes 1e-2 of the largest value
    (1/r on at least 160² nodes).
    """

    def __init__(self, kernel: Kernel, shape: tuple[int, int], device: Device = CPU) -> None:
        px, py = (_even_fast_size(n + _MARGIN) for n in shape)
        super().__init__(shape, (px, py), device)
        along_x, along_y = (device.arange(n + 4) for n in shape)
        lags = kernel(along_x[None, :], along_y[:, None])
        near = lags[: py // 2 + 1, : px // 2 + 1]
        self.diagonal = float(lags[0, 0])
        self._spectrum = device.even_spectrum(near.astype(np.float32))
        self._single_spectrum = self._spectrum

        def added(i: NDArray[np.int64], j: NDArray[np.int64]) -> Array:
            x, y = (np.minimum(4 * k.ravel(), n + 3) for k, n in zip((i, j), shape, strict=True))
            wrapped_x, wrapped_y = np.minimum(x, px - x), np.minimum(y, py - y)
            more: Array = np.subtract(lags[wrapped_y][:, wrapped_x], lags[y][:, x], order="C")
            more *= -16.0  # nodes in a cell four times as wide
            return more

        wide = (-(-shape[0] // 4), -(-shape[1] // 4))
        self._far = FreeConvolution(added, wide, device, single=True)

    @property
    def nbytes(self) -> int:
        """Size of the spectra (bytes)."""
        return int(self._spectrum.nbytes + self._far.nbytes)

    def with_own_workspace(self) -> Self:
        """Return a copy for another solve, with its own workspaces and with `count` set to 0."""
        other = super().with_own_workspace()
        other._far = self._far.with_own_workspace()
        return other

    def __call__(self, p: Array, out: Array | None = None) -> Array:
        """Return K ∗ p, with the shape of `p`, in a new array or in `out`."""
        result = self.without_mean(p, out)
        wider = coarsened(p)
        widest = coarsened(wider)
        far = self._far(widest, out=np.empty_like(widest))
        result += prolonged(prolonged(far, wider), p)
        return result

    single_precision = __call__

    def without_mean(self, p: Array, out: Array | None = None) -> Array:
        return self._convolve(p, self._spectrum, out, 1.0)


class PeriodicConvolution(Convolution):
    """Circular convolution; the array is one period, and the spectrum `symbol` gives the kernel."""

    def __init__(self, symbol: Symbol, shape: tuple[int, int], device: Device = CPU) -> None:
        super().__init__(shape, shape, device)
        self._spectrum = _modes(symbol, shape, device)
        # The kernel at lag (0, 0) is the sum over all modes. Only modes with non-negative wave
        # numbers are stored. So along each axis, a stored wave number stands for itself and its
        # negative. Zero and the Nyquist wave number (n even) have no negative and count once.
        along = [1.0 + ((k > 0) & (2 * k != n)) for n in shape for k in [device.arange(n // 2 + 1)]]
        self.diagonal = float((along[1] @ self._spectrum) @ along[0])
        self._single_spectrum = self._spectrum.astype(np.float32)


class SpectralFilter(_Spectral):
    """Multiplication by a real, even spectrum: a cheap, periodic, approximate convolution.

    Single precision is accurate enough for a preconditioner.
    """

    def __init__(
        self,
        symbol: Symbol,
        shape: tuple[int, int],
        device: Device = CPU,
    ) -> None:
        periods = fast_size(shape[0]), fast_size(shape[1])
        super().__init__(shape, periods, device)
        self._symbol = _modes(symbol, periods, device).astype(np.float32)

    @property
    def nbytes(self) -> int:
        """Size of the symbol (bytes)."""
        return int(self._symbol.nbytes)

    def __call__(self, r: Array, out: Array | None = None) -> Array:
        """Return the filtered `r`, with the shape of `r`, in a new array or in `out`."""
        # Values are divided by the largest magnitude, because single precision has a limited range.
        scale = max_magnitude(r)
        return self._convolve(r, self._symbol, out, scale if scale != 0 else 1.0)


def _modes(symbol: Symbol, periods: tuple[int, int], device: Device) -> Array:
    """One quadrant of the spectrum over the number of modes, transposed for `Device.convolve`."""
    mx, my = periods
    i, j = device.arange(mx // 2 + 1)[None, :], device.arange(my // 2 + 1)[:, None]
    values = symbol(2 * np.pi / mx * i, 2 * np.pi / my * j)
    values /= mx * my
    return values
