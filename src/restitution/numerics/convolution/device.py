"""Devices that store and convolve arrays: the CPU with compiled loops, or a GPU with CuPy.

The solver accepts any arrays that follow NumPy's protocols (NEP 13 and 18), such as CuPy arrays. A
`Device` covers what they leave out: how arrays are created and convolved. Solves run on `current`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache, lru_cache
from typing import Any, Literal, Protocol

import ducc0
import numpy as np
from numpy.typing import NDArray

from restitution.arguments import typed
from restitution.errors import CaseError
from restitution.numerics import kernels

Array = NDArray[Any]
DeviceName = Literal["cpu", "gpu", "auto"]


@cache
def is_fast(size: int) -> bool:
    """Whether `size` has only the prime factors 2, 3, 5 and 7; compiled transforms need this."""
    return pow(2 * 3 * 5 * 7, 64, size) == 0


class Device(Protocol):
    """A device that stores arrays and convolves them."""

    name: str

    def put(self, values: Array) -> Array:
        """Copy an array from host memory to the device."""

    def get(self, values: Array) -> Array:
        """Copy an array from the device to host memory."""

    def arange(self, n: int) -> Array:
        """Return the integers 0 … n − 1."""

    def even_spectrum(self, quadrant: Array) -> Array:
        """One quadrant of the spectrum of the even array of which `quadrant` is one.

        `quadrant` may be overwritten. The spectrum is divided by the number of values, so that the
        inverse transform needs no factor.
        """

    def workspace(self, shape: tuple[int, int], periods: tuple[int, int]) -> Array:
        """Return a work array for `convolve`, for arrays of this shape padded to `periods`."""

    def convolve(
        self,
        values: Array,
        spectrum: Array,
        periods: tuple[int, int],
        scale: float,
        workspace: Array,
        out: Array,
    ) -> None:
        """Multiply the Fourier modes of `values` by `spectrum`, transform back, write to `out`.

        `values` and `out` have shape (nx, ny); `values` is padded with zeros to the shape
        `periods`. `spectrum` is the transposed result of `even_spectrum`, and its precision is that
        of the computation. `values` is divided by `scale` before, and multiplied after the
        transforms.
        """


class _LibraryDevice:
    """Device of an array library, such as NumPy, and a module of transforms, such as scipy.fft."""

    def __init__(self, name: str, arrays: Any, fft: Any) -> None:
        self.name = name
        self._arrays, self._fft = arrays, fft

    def put(self, values: Array) -> Array:
        return self._arrays.asarray(values)  # type: ignore[no-any-return]

    def get(self, values: Array) -> Array:
        return getattr(self._arrays, "asnumpy", np.asarray)(values)

    def arange(self, n: int) -> Array:
        return self._arrays.arange(n)  # type: ignore[no-any-return]

    def even_spectrum(self, quadrant: Array) -> Array:
        # CuPy has no DCT-I, so the whole even array is transformed. The result is real.
        columns = np.concatenate([quadrant, quadrant[:, -2:0:-1]], axis=1)
        modes = self._fft.rfft(columns, axis=1, norm="forward").real
        rows = np.concatenate([modes, modes[-2:0:-1]], axis=0)
        half = quadrant.shape[0]
        waves = self._fft.rfft(rows, axis=0, norm="forward").real
        return waves[:half].copy()  # type: ignore[no-any-return]

    def workspace(self, shape: tuple[int, int], periods: tuple[int, int]) -> Array:
        return np.empty(0)  # the library allocates its own memory

    def convolve(
        self,
        values: Array,
        spectrum: Array,
        periods: tuple[int, int],
        scale: float,
        workspace: Array,
        out: Array,
    ) -> None:
        nx, ny = values.shape
        px, py = periods
        scaled = np.divide(values, scale, dtype=np.float64)
        # Each axis is transformed separately. The first transform then skips the rows of zeros that
        # padding adds.
        modes = self._fft.rfft(scaled.astype(spectrum.dtype), n=py, axis=1)
        modes = self._fft.fft(modes, n=px, axis=0)
        weights, last = spectrum.T, px // 2
        modes[: last + 1] *= weights
        # The modes after index `last` have negative wave numbers. If the period is odd, −`last` is
        # one of these wave numbers.
        modes[last + 1 :] *= weights[px - last - 1 : 0 : -1]
        modes = self._fft.ifft(modes, axis=0, norm="forward", overwrite_x=True)[:nx]
        padded = self._fft.irfft(modes, n=py, axis=1, norm="forward")
        np.multiply(padded[:, :ny], scale, out=out, dtype=out.dtype)


class _Compiled(_LibraryDevice):
    """CPU device: NumPy arrays, convolved by the compiled loops."""

    def __init__(self, loops: Any) -> None:
        super().__init__("cpu", np, _LazyFFT())
        self._loops = loops
        # Use as many threads as ducc0; the environment variable DUCC0_NUM_THREADS sets the number.
        loops.use_threads(ducc0.misc.thread_pool_size())

    def even_spectrum(self, quadrant: Array) -> Array:
        threads = self._loops.threads_for(quadrant.nbytes)
        ducc0.fft.dct(quadrant, type=1, inorm=2, out=quadrant, nthreads=threads)
        return quadrant

    def workspace(self, shape: tuple[int, int], periods: tuple[int, int]) -> Array:
        return np.empty((1, self._loops.workspace_bytes(shape[1], periods[0] // 2 + 1)), np.uint8)

    def convolve(
        self,
        values: Array,
        spectrum: Array,
        periods: tuple[int, int],
        scale: float,
        workspace: Array,
        out: Array,
    ) -> None:
        # The compiled transforms need periods that have only the prime factors 2, 3, 5 and 7.
        if not all(is_fast(period) for period in periods):
            super().convolve(values, spectrum, periods, scale, workspace, out)
            return
        if values.strides[-1] != values.itemsize:
            values = np.ascontiguousarray(values)
        self._loops.convolve(values, 1 / scale, spectrum, *periods, workspace, scale, out)


class _LazyFFT:
    """The module scipy.fft, imported on first use."""

    def __getattr__(self, name: str) -> Any:
        import scipy.fft

        return getattr(scipy.fft, name)


CPU: Device = (
    _LibraryDevice("cpu", np, _LazyFFT()) if kernels.loops is None else _Compiled(kernels.loops)
)
_current: ContextVar[Device] = ContextVar("device", default=CPU)


def current() -> Device:
    """Device on which contacts are solved in the current context."""
    return _current.get()


@typed
@contextmanager
def on_device(device: DeviceName | Device) -> Iterator[Device]:
    """Run the solves in a `with` block on a device.

    Args:
        device: Device, or its name: "cpu", "gpu", or "auto" for a GPU if one is available, else the
            CPU.

    Yields:
        The device in use.

    Raises:
        CaseError: The device is "gpu", and CuPy or a usable GPU is missing.
    """
    chosen = _named(device) if isinstance(device, str) else device
    token = _current.set(chosen)
    try:
        yield chosen
    finally:
        _current.reset(token)


def _named(name: DeviceName) -> Device:
    if name == "auto":
        with suppress(CaseError):
            return _gpu()
    return _gpu() if name == "gpu" else CPU


@lru_cache
def _gpu() -> Device:
    try:
        import cupy
        import cupyx.scipy.fft

        cupy.cuda.Device().use()  # raises without a GPU
    except ImportError as error:
        raise CaseError(
            f'device: gpu needs CuPy ({error}); install the package with its extra "gpu" '
            '(in a checkout: `pip install ".[gpu]"`), or use the device cpu'
        ) from error
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise CaseError(
            f"device: no usable GPU ({reason}); check the GPU driver, or use the device cpu"
        ) from error
    return _LibraryDevice("gpu", cupy, cupyx.scipy.fft)
