"""Where arrays live and who transforms them: this machine and ducc0, or a GPU and CuPy.

The solver is written for any arrays that follow NumPy's protocols (`__array_ufunc__`, NEP 13, and
`__array_function__`, NEP 18), as CuPy's do; what has no such protocol, making arrays and
transforming them, is a method of a `Device`. Solves run on the `current` one:

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

Array = NDArray[Any]
DeviceName = Literal["cpu", "gpu", "auto"]


class Device(Protocol):
    """Makes arrays, and transforms them without normalisation; `threads` is a hint.

    Of rows that are half padding no more than `row_buffer` numbers are transformed at once.
    """

    name: str
    row_buffer: int

    def put(self, values: Array) -> Array:
        """An array of this machine's memory, on the device."""

    def get(self, values: Array) -> Array:
        """An array of the device, in this machine's memory."""

    def empty(self, shape: tuple[int, ...], dtype: Any) -> Array:
        """An array whose values do not matter yet."""

    def arange(self, n: int) -> Array:
        """0 … n − 1."""

    def even_spectrum(self, quadrant: Array, threads: int) -> Array:
        """Spectrum of a real array that is even along both axes, of which this is one quadrant."""

    def forward(self, values: Array, axes: tuple[int, ...], out: Array, threads: int) -> None:
        """Real to half-complex, the last of `axes` halved."""

    def along_columns(self, modes: Array, *, forward: bool, threads: int) -> None:
        """Complex to complex along the last axis but one, in place."""

    def backward(self, modes: Array, axes: tuple[int, ...], out: Array, threads: int) -> None:
        """Half-complex to real, the inverse of `forward` but for its scale."""


class _Host:
    """NumPy arrays, transformed by ducc0."""

    name = "cpu"
    row_buffer = 2**22  # 32 MiB

    def put(self, values: Array) -> Array:
        return values

    def get(self, values: Array) -> Array:
        return values

    def empty(self, shape: tuple[int, ...], dtype: Any) -> Array:
        return np.empty(shape, dtype)

    def arange(self, n: int) -> Array:
        return np.arange(n)

    def even_spectrum(self, quadrant: Array, threads: int) -> Array:
        spectrum: Array = ducc0.fft.dct(quadrant, type=1, nthreads=threads)
        return spectrum

    def forward(self, values: Array, axes: tuple[int, ...], out: Array, threads: int) -> None:
        ducc0.fft.r2c(values, axes=axes, out=out, nthreads=threads)

    def along_columns(self, modes: Array, *, forward: bool, threads: int) -> None:
        ducc0.fft.c2c(modes, axes=[-2], forward=forward, out=modes, nthreads=threads)

    def backward(self, modes: Array, axes: tuple[int, ...], out: Array, threads: int) -> None:
        ducc0.fft.c2r(modes, axes=axes, lastsize=out.shape[-1], forward=False, out=out,
                      nthreads=threads)  # fmt: skip


class _Accelerator:
    """Arrays of a library like NumPy, `arrays`, transformed by one like scipy.fft, `fft`."""

    row_buffer = 2**30  # calls cost more than memory there

    def __init__(self, name: str, arrays: Any, fft: Any) -> None:
        self.name = name
        self._arrays, self._fft = arrays, fft

    def put(self, values: Array) -> Array:
        return self._arrays.asarray(values)  # type: ignore[no-any-return]

    def get(self, values: Array) -> Array:
        return self._arrays.asnumpy(values)  # type: ignore[no-any-return]

    def empty(self, shape: tuple[int, ...], dtype: Any) -> Array:
        return self._arrays.empty(shape, dtype)  # type: ignore[no-any-return]

    def arange(self, n: int) -> Array:
        return self._arrays.arange(n)  # type: ignore[no-any-return]

    def even_spectrum(self, quadrant: Array, threads: int) -> Array:
        # CuPy has no DCT-I: the transform of the whole even array, which is real.
        columns = np.concatenate([quadrant, quadrant[:, -2:0:-1]], axis=1)
        modes = self._fft.rfft(columns, axis=1).real
        rows = np.concatenate([modes, modes[-2:0:-1]], axis=0)
        half = quadrant.shape[0]
        return self._fft.rfft(rows, axis=0).real[:half].copy()  # type: ignore[no-any-return]

    def forward(self, values: Array, axes: tuple[int, ...], out: Array, threads: int) -> None:
        out[...] = self._fft.rfftn(values, axes=axes)

    def along_columns(self, modes: Array, *, forward: bool, threads: int) -> None:
        if forward:
            modes[...] = self._fft.fft(modes, axis=-2)
        else:
            modes[...] = self._fft.ifft(modes, axis=-2, norm="forward")

    def backward(self, modes: Array, axes: tuple[int, ...], out: Array, threads: int) -> None:
        sizes = [out.shape[axis] for axis in axes]
        out[...] = self._fft.irfftn(modes, s=sizes, axes=axes, norm="forward")


def accelerator(name: str, arrays: Any, fft: Any) -> Device:
    """A device whose arrays are those of a library like CuPy (`arrays`) and of its scipy.fft."""
    return _Accelerator(name, arrays, fft)


CPU: Device = _Host()
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
            f"device: gpu needs CuPy ({error}); install restitution[gpu], or use --device cpu"
        ) from error
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise CaseError(
            f"device: no GPU answers ({reason}); check its driver, or use --device cpu"
        ) from error
    return accelerator("gpu", cupy, cupyx.scipy.fft)
