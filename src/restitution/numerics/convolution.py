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

import math
from collections.abc import Callable, Iterator
from copy import copy
from typing import Any, Protocol, Self

import ducc0
import numpy as np
from numpy.typing import NDArray

from restitution.numerics import passes
from restitution.numerics.device import CPU, Device

Array = NDArray[np.float64]
# Values at lags i (a column of integers) and j (a row of integers), of the broadcast shape.
Kernel = Callable[[NDArray[np.int64], NDArray[np.int64]], Array]

# Two threads cost more than they save on smaller transforms (measured on two cores).
_NODES_WORTH_THREADS = 600 * 600


def threads_for(nodes: int) -> int:
    """Threads for a transform of so many nodes; 0 lets ducc0 decide (`DUCC0_NUM_THREADS`)."""
    return 0 if nodes > _NODES_WORTH_THREADS else 1


def fast_size(minimum: int) -> int:
    """The smallest size of a fast FFT, at least `minimum`.

    Its factors are 2, 3 and 5, or it is 7 or 21 times a power of 2: these take 0.8 to 0.95 times as
    long as the next of the others, where other sizes with 7 or 11 take up to a third more.
    """
    sizes = [int(ducc0.fft.good_size(minimum, True))]
    for factor in (7, 21):
        sizes.append(factor << (-(-minimum // factor) - 1).bit_length())
    return min(sizes)


class Convolution(Protocol):
    """A convolution of arrays of one shape; `count` tells how often it was applied."""

    count: int

    def __call__(self, p: Array, out: Array | None = None) -> Array:
        """K ∗ p, same shape as `p`: in a new array, or in `out`."""

    def quick(self, p: Array, out: Array | None = None) -> Array:
        """The same for work in single precision: an error of about 5e-7 of the largest value."""


class FreeConvolution:
    """Convolution of arrays of one shape with one kernel; `count` tells how often it was applied.

    What is convolved may be a batch: arrays (*batch, nx, ny).
    """

    def __init__(self, kernel: Kernel, shape: tuple[int, int], device: Device = CPU) -> None:
        nx, ny = shape
        px, py = 2 * fast_size(nx), 2 * fast_size(ny)
        lags = kernel(device.arange(px // 2 + 1)[:, None], device.arange(py // 2 + 1)[None, :])
        self.shape = shape
        self._device = device
        self._padded = px, py
        # The normalisation of the inverse transform rides along with the kernel.
        spectrum = device.even_spectrum(lags, threads_for(nx * ny))
        spectrum /= px * py
        self._spectrum, self._single_spectrum = spectrum, spectrum.astype(np.float32)
        self._make_room(())

    def _make_room(self, batch: tuple[int, ...]) -> None:
        (nx, ny), (px, py) = self.shape, self._padded
        items = math.prod(batch)
        rows = min(nx, max(1, self._device.row_buffer // (items * py)))
        self.count = 0
        self._threads = threads_for(items * nx * ny)
        padded = self._device.empty((*batch, rows, py), np.float64)
        modes = self._device.empty((*batch, px, py // 2 + 1), np.complex128)
        self._buffers = padded, modes
        self._single_buffers = _as_single(padded), _as_single(modes)  # in the same memory

    def fresh(self, batch: tuple[int, ...] = ()) -> Self:
        """The same operator with buffers and a count of its own, for another user or a batch."""
        other = copy(self)
        other._make_room(batch)
        return other

    def __call__(self, p: Array, out: Array | None = None) -> Array:
        """Return K * p, same shape as `p`: in a new array, or in `out`."""
        return self._apply(p, *self._buffers, self._spectrum, out)

    def quick(self, p: Array, out: Array | None = None) -> Array:
        """The same for work in single precision: an error of about 5e-7 of the largest value."""
        return self._apply(p, *self._single_buffers, self._single_spectrum, out)

    def _apply(
        self,
        p: Array,
        padded: NDArray[Any],
        modes: NDArray[Any],
        spectrum: NDArray[Any],
        out: Array | None,
    ) -> Array:
        nx, device, threads = self.shape[0], self._device, self._threads
        result = np.empty_like(p, dtype=np.float64, order="C") if out is None else out
        self.count += 1

        for some, rows in blocks(nx, padded):
            passes.pad(p[..., some, :], 1.0, rows)
            device.forward(rows, (-1,), modes[..., some, :], threads)
        modes[..., nx:, :] = 0.0
        device.along_columns(modes, forward=True, threads=threads)
        weigh_evenly(modes, spectrum)
        device.along_columns(modes, forward=False, threads=threads)
        for some, rows in blocks(nx, padded):
            device.backward(modes[..., some, :], (-1,), rows, threads)
            passes.crop(rows, 1.0, result[..., some, :])
        return result


def weigh_evenly(modes: NDArray[Any], weights: NDArray[Any]) -> None:
    """Multiply half-complex modes by a quadrant of weights that are even along both axes."""
    last = modes.shape[-2] // 2
    passes.weigh(modes[..., : last + 1, :], weights)
    # The negative waves; of an odd number of rows the largest, too, has a negative one.
    negative = modes.shape[-2] - last - 1
    passes.weigh(modes[..., last + 1 :, :], weights[negative:0:-1])


def _as_single(buffer: NDArray[Any]) -> NDArray[Any]:
    """An array of the same shape in single precision, in the first half of the buffer."""
    single = np.float32 if buffer.dtype == np.float64 else np.complex64
    return buffer.reshape(-1).view(single)[: buffer.size].reshape(buffer.shape)


def blocks(rows: int, buffer: NDArray[Any]) -> Iterator[tuple[slice, NDArray[Any]]]:
    """Rows of an array, some at a time, with as much of the buffer for them."""
    some = buffer.shape[-2]
    for first in range(0, rows, some):
        last = min(first + some, rows)
        yield slice(first, last), buffer[..., : last - first, :]


class SpectralFilter:
    """Multiplication by a real, even symbol of the wave vector; a cheap approximate operator.

    `symbol(qx, qy)` takes the angular wave numbers (rad per cell, ≥ 0) as a column and a row. The
    array is padded only to a fast size, so the filter is periodic, and works in single precision:
    good enough for a preconditioner.
    """

    def __init__(
        self,
        symbol: Callable[[Array, Array], Array],
        shape: tuple[int, int],
        device: Device = CPU,
    ) -> None:
        mx, my = (fast_size(n) for n in shape)
        i, j = device.arange(mx // 2 + 1)[:, None], device.arange(my // 2 + 1)[None, :]
        values = symbol(2 * np.pi / mx * i, 2 * np.pi / my * j)
        self.shape = shape
        self._device = device
        self._symbol = (values / (mx * my)).astype(np.float32)
        self._size = mx, my
        self._make_room(())

    def _make_room(self, batch: tuple[int, ...]) -> None:
        mx, my = self._size
        self._threads = threads_for(math.prod((*batch, *self.shape)))
        self._padded = self._device.empty((*batch, mx, my), np.float32)
        self._modes = self._device.empty((*batch, mx, my // 2 + 1), np.complex64)

    def fresh(self, batch: tuple[int, ...] = ()) -> Self:
        """The same filter with buffers of its own, for another user or a batch."""
        other = copy(self)
        other._make_room(batch)
        return other

    def __call__(self, r: Array, out: Array | None = None) -> Array:
        """Return the filtered array, same shape as `r`: in a new array, or in `out`."""
        padded, modes, device = self._padded, self._modes, self._device
        result = np.empty_like(r, dtype=np.float64, order="C") if out is None else out
        # What is far below the largest value is lost in single precision, wherever that lies.
        scale = passes.peak(r)
        scale += scale == 0
        passes.pad(r, 1 / scale, padded)
        device.forward(padded, (-2, -1), modes, self._threads)
        weigh_evenly(modes, self._symbol)
        # One axis after the other, in place: both at once take a copy of the modes.
        device.along_columns(modes, forward=False, threads=self._threads)
        device.backward(modes, (-1,), padded, self._threads)
        passes.crop(padded, scale, result)
        return result
