"""Linear (non-periodic) convolution with a real, even kernel by zero-padded FFT.

Conventions: for nodes (i, j) of a grid of shape (nx, ny),

    u[i, j] = Σ_kl  K[|i − k|, |j − l|] p[k, l].

Zero padding to any size ≥ 2n − 1 makes the circular convolution equal to the linear one (Liu, Wang
and Liu 2000, Wear 243, 101–111, "DC-FFT"); lags beyond n − 1 never meet, whatever the kernel says
there. The kernel is even along both axes, so its spectrum is a DCT-I of one quadrant and real: a
quarter of the storage. Half of the padded rows are zero on the way in and unwanted on the way out,
so their row transforms are skipped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import copy
from typing import Any, Self

import ducc0
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Two threads cost more than they save on smaller transforms (measured on two cores).
_NODES_WORTH_THREADS = 350 * 350
_ROW_BUFFER = 2**22  # numbers in the padded rows that are transformed at once: 32 MiB


def threads_for(nodes: int) -> int:
    """Threads for a transform of so many nodes; 0 lets ducc0 decide (`DUCC0_NUM_THREADS`)."""
    return 0 if nodes > _NODES_WORTH_THREADS else 1


def _even_fast_size(minimum: int) -> int:
    """The smallest even FFT size with factors 2, 3, 5, 7, 11 only, at least `minimum`."""
    return 2 * int(ducc0.fft.good_size((minimum + 1) // 2))


class FreeConvolution:
    """Convolution of arrays of one shape with one kernel; `count` tells how often it was applied.

    `kernel(i, j)` returns the kernel at lags i (column of integers) and j (row of integers), as an
    array of the broadcast shape.
    """

    def __init__(
        self,
        kernel: Callable[[NDArray[np.int64], NDArray[np.int64]], Array],
        shape: tuple[int, int],
    ) -> None:
        nx, ny = shape
        px, py = _even_fast_size(2 * nx - 1), _even_fast_size(2 * ny - 1)
        lags = kernel(np.arange(px // 2 + 1)[:, None], np.arange(py // 2 + 1)[None, :])
        self.shape = shape
        self.count = 0
        self._threads = threads_for(nx * ny)
        # The normalisation of the inverse transform rides along with the kernel.
        self._spectrum = ducc0.fft.dct(lags, type=1, nthreads=self._threads) / (px * py)
        self._single_spectrum = self._spectrum.astype(np.float32)
        self._rows = np.empty((min(nx, max(1, _ROW_BUFFER // py)), py))
        self._modes = np.empty((px, py // 2 + 1), dtype=np.complex128)

    def fresh(self) -> Self:
        """The same operator with buffers and a count of its own, for another user or thread."""
        other = copy(self)
        other.count = 0
        other._rows, other._modes = np.empty_like(self._rows), np.empty_like(self._modes)
        return other

    def __call__(self, p: Array, out: Array | None = None) -> Array:
        """Return K * p, same shape as `p`: in a new array, or in `out`."""
        return self._apply(p, self._rows, self._modes, self._spectrum, out)

    def quick(self, p: Array, out: Array | None = None) -> Array:
        """The same in single precision: an error of about 5e-7 of the largest value."""
        # The buffers of double precision serve.
        rows = self._rows.view(np.float32)[:, : self._rows.shape[1]]
        modes = self._modes.view(np.complex64)[:, : self._modes.shape[1]]
        return self._apply(p, rows, modes, self._single_spectrum, out)

    def _apply(
        self,
        p: Array,
        padded: NDArray[Any],
        modes: NDArray[Any],
        spectrum: NDArray[Any],
        out: Array | None,
    ) -> Array:
        nx, ny = self.shape
        px, py, threads = modes.shape[0], padded.shape[1], self._threads
        result = np.empty(self.shape) if out is None else out
        self.count += 1

        for some, rows in _blocks(nx, padded):
            rows[:, :ny] = p[some]
            rows[:, ny:] = 0.0
            ducc0.fft.r2c(rows, axes=[1], out=modes[some], nthreads=threads)
        modes[nx:] = 0.0
        ducc0.fft.c2c(modes, axes=[0], out=modes, nthreads=threads)
        half = px // 2 + 1
        modes[:half] *= spectrum
        modes[half:] *= spectrum[px // 2 - 1 : 0 : -1]
        ducc0.fft.c2c(modes, axes=[0], forward=False, out=modes, nthreads=threads)
        for some, rows in _blocks(nx, padded):
            ducc0.fft.c2r(
                modes[some], axes=[1], lastsize=py, forward=False, out=rows, nthreads=threads
            )
            result[some] = rows[:, :ny]
        return result


def _blocks(rows: int, buffer: NDArray[Any]) -> Iterator[tuple[slice, NDArray[Any]]]:
    """Rows of an array, some at a time, with as much of the buffer for them."""
    some = buffer.shape[0]
    for first in range(0, rows, some):
        last = min(first + some, rows)
        yield slice(first, last), buffer[: last - first]


class SpectralFilter:
    """Multiplication by a real, even symbol of the wave vector; a cheap approximate operator.

    `symbol(qx, qy)` takes the angular wave numbers (rad per cell) as a column and a row. The array
    is padded only to a fast size, so the filter is periodic, and works in single precision: good
    enough for a preconditioner.
    """

    def __init__(self, symbol: Callable[[Array, Array], Array], shape: tuple[int, int]) -> None:
        mx, my = (int(ducc0.fft.good_size(n, True)) for n in shape)
        qx = np.asarray(2 * np.pi * np.fft.fftfreq(mx)[:, None], dtype=np.float64)
        qy = np.asarray(2 * np.pi * np.fft.rfftfreq(my)[None, :], dtype=np.float64)
        self.shape = shape
        self._symbol = (symbol(qx, qy) / (mx * my)).astype(np.float32)
        self._padded = np.empty((mx, my), dtype=np.float32)
        self._modes = np.empty((mx, my // 2 + 1), dtype=np.complex64)
        self._threads = threads_for(shape[0] * shape[1])

    def fresh(self) -> Self:
        """The same filter with buffers of its own, for another user or thread."""
        other = copy(self)
        other._padded, other._modes = np.empty_like(self._padded), np.empty_like(self._modes)
        return other

    def __call__(self, r: Array, out: Array | None = None) -> Array:
        """Return the filtered array, same shape as `r`: in a new array, or in `out`."""
        nx, ny = self.shape
        padded, modes, threads = self._padded, self._modes, self._threads
        # What is far below the largest value is lost in single precision, wherever that lies.
        scale = max(float(r.max()), -float(r.min())) or 1.0
        np.divide(r, scale, out=padded[:nx, :ny], casting="same_kind")
        padded[nx:] = 0.0
        padded[:nx, ny:] = 0.0
        ducc0.fft.r2c(padded, axes=[0, 1], out=modes, nthreads=threads)
        modes *= self._symbol
        ducc0.fft.c2r(
            modes, axes=[0, 1], lastsize=padded.shape[1], forward=False, out=padded,
            nthreads=threads,
        )  # fmt: skip
        return np.multiply(padded[:nx, :ny], scale, out=out, dtype=np.float64)
