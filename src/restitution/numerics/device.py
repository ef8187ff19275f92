"""Where arrays live and who convolves them: this machine's compiled loops, or a GPU and CuPy.

The solver is written for any arrays that follow NumPy's protocols (`__array_ufunc__`, NEP 13, and
`__array_function__`, NEP 18), as CuPy's do; what has no such protocol, making arrays and
convolving them, is a method of a `Device`. Solves run on the `current` one:

    with on_device("gpu"):
        state = solve(contact, 1e-6)
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from typing import Any, Literal, Protocol

import ducc0
import numpy as np
from numpy.typing import NDArray

from restitution.errors import CaseError
from restitution.numerics.kernels import loops

Array = NDArray[Any]
DeviceName = Literal["cpu", "gpu", "auto"]


class Device(Protocol):
    """Makes arrays, and convolves them."""

    name: str

    def put(self, values: Array) -> Array:
        """An array of this machine's memory, on the device."""

    def get(self, values: Array) -> Array:
        """An array of the device, in this machine's memory."""

    def arange(self, n: int) -> Array:
        """0 … n − 1."""

    def even_spectrum(self, quadrant: Array) -> Array:
        """Spectrum of a real array that is even along both axes, of which this is one quadrant.

        It is over the number of values, so that transforming back takes no factor. The quadrant may
        be overwritten.
        """

    def room(self, shape: tuple[int, int], periods: tuple[int, int]) -> Array:
        """The memory that `convolve` needs for arrays of that shape."""

    def convolve(
        self, values: Array, spectrum: Array, periods: tuple[int, int], scale: Any, room: Array,
        out: Array,
    ) -> None:  # fmt: skip
        """Multiply the waves of values, (*batch, nx, ny), by a real and even spectrum, in `out`.

        The values are filled up with zeros to `periods`. `spectrum` is a quadrant as
        `even_spectrum` makes it but transposed; its precision is that of the work. Values are
        divided by `scale`, one for each item, and what comes out is multiplied by it.
        """


class _Compiled:
    """NumPy arrays, convolved by the compiled `loops`."""

    name = "cpu"

    def __init__(self, loops: Any) -> None:
        self._loops = loops
        # As many as ducc0's, which `DUCC0_NUM_THREADS` sets.
        loops.use_threads(ducc0.misc.thread_pool_size())

    def put(self, values: Array) -> Array:
        return values

    def get(self, values: Array) -> Array:
        return values

    def arange(self, n: int) -> Array:
        return np.arange(n)

    def even_spectrum(self, quadrant: Array) -> Array:
        threads = self._loops.threads_for(quadrant.nbytes)
        ducc0.fft.dct(quadrant, type=1, inorm=2, out=quadrant, nthreads=threads)
        return quadrant

    def room(self, shape: tuple[int, int], periods: tuple[int, int]) -> Array:
        return np.empty((1, self._loops.bytes_of_room(shape[1], periods[0] // 2 + 1)), np.uint8)

    def convolve(
        self, values: Array, spectrum: Array, periods: tuple[int, int], scale: Any, room: Array,
        out: Array,
    ) -> None:  # fmt: skip
        if values.ndim > 2:
            for item, its_values in enumerate(values):
                its_scale = scale[item] if np.ndim(scale) else scale
                self.convolve(its_values, spectrum, periods, its_scale, room, out[item])
            return
        if values.strides[-1] != values.itemsize:
            values = np.ascontiguousarray(values)
        factor = float(scale.item() if isinstance(scale, np.ndarray) else scale)
        self._loops.convolve(values, 1 / factor, spectrum, *periods, room, factor, out)


class _Arrays:
    """Arrays of a library like NumPy, `arrays`, transformed by one like scipy.fft, `fft`."""

    def __init__(self, name: str, arrays: Any, fft: Any) -> None:
        self.name = name
        self._arrays, self._fft = arrays, fft

    def put(self, values: Array) -> Array:
        return self._arrays.asarray(values)  # type: ignore[no-any-return]

    def get(self, values: Array) -> Array:
        here: Array = getattr(self._arrays, "asnumpy", np.asarray)(values)
        return here

    def arange(self, n: int) -> Array:
        return self._arrays.arange(n)  # type: ignore[no-any-return]

    def even_spectrum(self, quadrant: Array) -> Array:
        # CuPy has no DCT-I: the transform of the whole even array, which is real.
        columns = np.concatenate([quadrant, quadrant[:, -2:0:-1]], axis=1)
        modes = self._fft.rfft(columns, axis=1, norm="forward").real
        rows = np.concatenate([modes, modes[-2:0:-1]], axis=0)
        half = quadrant.shape[0]
        waves = self._fft.rfft(rows, axis=0, norm="forward").real
        return waves[:half].copy()  # type: ignore[no-any-return]

    def room(self, shape: tuple[int, int], periods: tuple[int, int]) -> Array:
        return np.empty(0)  # transforms find their own

    def convolve(
        self, values: Array, spectrum: Array, periods: tuple[int, int], scale: Any, room: Array,
        out: Array,
    ) -> None:  # fmt: skip
        nx, ny = values.shape[-2:]
        px, py = periods
        # One axis after the other: the rows that are padding are not transformed.
        modes = self._fft.rfft((values / scale).astype(spectrum.dtype), n=py, axis=-1)
        modes = self._fft.fft(modes, n=px, axis=-2)
        weights, last = spectrum.T, px // 2
        modes[..., : last + 1, :] *= weights
        # The negative waves; of an odd period the largest, too, has a negative one.
        modes[..., last + 1 :, :] *= weights[px - last - 1 : 0 : -1]
        modes = self._fft.ifft(modes, axis=-2, norm="forward", overwrite_x=True)[..., :nx, :]
        padded = self._fft.irfft(modes, n=py, axis=-1, norm="forward")
        np.multiply(padded[..., :ny], scale, out=out, dtype=out.dtype)


def accelerator(name: str, arrays: Any, fft: Any) -> Device:
    """A device whose arrays are those of a library like CuPy (`arrays`) and of its scipy.fft."""
    return _Arrays(name, arrays, fft)


def _host() -> Device:
    if loops is not None:
        return _Compiled(loops)
    import scipy.fft

    return _Arrays("cpu", np, scipy.fft)


CPU = _host()
_current: ContextVar[Device] = ContextVar("device", default=CPU)


def current() -> Device:
    """The device that solves run on here and now."""
    return _current.get()


@contextmanager
def on_device(device: DeviceName | Device) -> Iterator[Device]:
    """Let solves run on a device: "cpu", "gpu", or "auto", which is a GPU where there is one.

    Raises `CaseError` for "gpu" where CuPy or a device is missing.
    """
    chosen = _named(device) if isinstance(device, str) else device
    token = _current.set(chosen)
    try:
        yield chosen
    finally:
        _current.reset(token)


def _named(name: str) -> Device:
    if name == "cpu":
        return CPU
    try:
        return _gpu()
    except CaseError:
        if name == "auto":
            return CPU
        raise


@lru_cache
def _gpu() -> Device:
    try:
        import cupy
        import cupyx.scipy.fft

        cupy.cuda.Device().use()  # raises where there is none
    except ImportError as error:
        raise CaseError(
            f"device: gpu needs CuPy ({error}); install the extra gpu, from a checkout with "
            '`pip install ".[gpu]"`, or use --device cpu'
        ) from error
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise CaseError(
            f"device: no GPU answers ({reason}); check its driver, or use --device cpu"
        ) from error
    return accelerator("gpu", cupy, cupyx.scipy.fft)
