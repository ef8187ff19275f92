"""Wave amplitudes of a twin, which depend on the scan and the period of the twin, not on the grid.

The scan's power spectrum C (`psd`) is interpolated linearly to the wave vectors of the twin; waves
longer than the scan are left out. It is then multiplied by a + b/k², where k is the size of the
scan divided by the wavelength, so that height and slope have the mean squares of the scan. C alone
does not give these values, because the tapers give the rim of the scan less weight than the middle.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from restitution.surfaces.describe import rms_slope
from restitution.surfaces.noise import wave_phases
from restitution.surfaces.psd import power_spectral_density
from restitution.surfaces.surface import Array, Surface

Modes = NDArray[np.complex128]

_SUMMED = 2**20  # `_moments` sums at most about this many waves one by one
_LEAST = 2  # waves with at most this many periods per scan edge are always summed one by one
_ROWS = 2**20  # number of waves computed at a time, to limit the memory
_ROUNDING = 1e-9


@dataclass(frozen=True)
class TwinWaves(ABC):
    """The waves of a twin with the edges `period` = (Px, Py), in metres.

    The wave (m, n) has the wave vector 2π(m/Px, n/Py); `pixel` (m) is half of the shortest wave.
    """

    pixel: tuple[float, float]
    period: tuple[float, float]

    @abstractmethod
    def power(self, m: NDArray[np.int64], n: NDArray[np.int64]) -> Array:
        """Mean square height (m²) of each wave (m, n), shape (m.size, n.size)."""

    def numbers(self, spacing: tuple[float, float]) -> tuple[int, int]:
        """Largest m and n of the waves that the scan and cells of size `spacing` resolve."""
        most = [
            max(math.ceil(0.5 * edge / max(h, pixel) * (1 - _ROUNDING)) - 1, 0)
            for edge, h, pixel in zip(self.period, spacing, self.pixel, strict=True)
        ]
        return most[0], most[1]

    def modes(self, most: tuple[int, int], nodes: tuple[int, int], seed: int) -> Modes:
        """Waves up to `most` with random phases, in the order of `rfft2` (norm "forward")."""
        M, N = most
        full: Modes = np.zeros((nodes[0], nodes[1] // 2 + 1), dtype=np.complex128)
        n = np.arange(N + 1)
        rows = max(1, _ROWS // (N + 1))
        for first in range(-M, M + 1, rows):
            m = np.arange(first, min(first + rows, M + 1))
            phases = wave_phases(seed, m, N + 1)
            full[m, : N + 1] = np.sqrt(self.power(m, n)) * np.exp(1j * phases)
        return full


@dataclass(frozen=True)
class WaveSpectrum(TwinWaves):
    """Mean square heights of the waves of a twin of one scan.

    `density` is the mean square height (m²) of single waves before the factor a + b/k²; the zero
    wave vector is in the middle.
    """

    density: Array
    waves: tuple[float, float]  # period of the twin divided by the size of the scan, along x and y
    flat: float = 1.0  # a in the factor a + b/k² (see the top of this file)
    steep: float = 0.0  # b in the factor a + b/k²

    def power(self, m: NDArray[np.int64], n: NDArray[np.int64]) -> Array:
        """Mean square height (m²) of each wave (m, n), shape (m.size, n.size)."""
        C, k2 = self._raw(m, n)
        return np.maximum(C * (self.flat + self.steep / np.maximum(k2, 1.0)), 0.0)

    def _raw(self, m: NDArray[np.int64], n: NDArray[np.int64]) -> tuple[Array, Array]:
        """`density` at the waves (m, n), without the factor a + b/k², and k²."""
        from scipy.ndimage import map_coordinates

        kx, ky = m / self.waves[0], n / self.waves[1]
        middle = [size // 2 for size in self.density.shape]
        at = np.meshgrid(kx + middle[0], ky + middle[1], indexing="ij")
        C: Array = map_coordinates(self.density, at, order=1, mode="grid-wrap")
        k2 = kx[:, None] ** 2 + ky[None, :] ** 2
        C[k2 < 1 - _ROUNDING] = 0.0
        return C, k2


def spectrum_of(scan: Surface, period: tuple[float, float]) -> WaveSpectrum:
    """Spectrum of a twin of `scan`; `period` contains the edges (m) of the twin."""
    C = np.fft.fftshift(power_spectral_density(scan))
    waves = tuple(p / s for p, s in zip(period, scan.grid.size, strict=True))
    C *= 1 / (scan.grid.size[0] * scan.grid.size[1] * waves[0] * waves[1])
    raw = WaveSpectrum(scan.grid.spacing, period, C, (waves[0], waves[1]))
    wanted = float(np.var(scan.height)), rms_slope(scan) ** 2
    moments = _moments(raw)  # here a = 1 and b = 0, so the factor a + b/k² is 1
    a, b = wanted[0] / moments[0, 0], 0.0
    if abs(np.linalg.det(moments)) > 1e-9 * abs(moments[0, 0] * moments[1, 1]):
        a, b = (float(value) for value in np.linalg.solve(moments, wanted))
    spectrum = replace(raw, flat=a, steep=b)
    # `power` sets negative values to zero, which changes the mean square height. The coefficients a
    # and b are rescaled to restore the mean square height.
    excess = _moments(spectrum)[0, 0] / wanted[0]
    return replace(raw, flat=a / excess, steep=b / excess)


def _moments(spectrum: WaveSpectrum) -> Array:
    """Mean square height (row 1) and slope (row 2), with the factors 1 and 1/k² (columns).

    Slopes are differences between neighbouring pixels. Long waves are summed over the wave vectors
    of the twin, short waves over those of the scan, which are fewer.
    """
    wx, wy = spectrum.waves
    (mx, my), (hx, hy) = spectrum.density.shape, spectrum.pixel
    K = max(_LEAST, min(int(0.5 * math.sqrt(_SUMMED / (wx * wy))), (min(mx, my) - 1) // 2))
    m, n = (np.arange(-int((K + 0.5) * w), int((K + 0.5) * w) + 1) for w in (wx, wy))
    k, l = np.arange(mx) - mx // 2, np.arange(my) - my // 2  # noqa: E741
    beyond = np.maximum(np.abs(k)[:, None], np.abs(l)[None, :]) > K
    k2 = np.add.outer((k * 1.0) ** 2, (l * 1.0) ** 2)
    moments = np.zeros((2, 2))
    near, far = spectrum._raw(m, n), (np.where(beyond, wx * wy * spectrum.density, 0.0), k2)
    for (C, squares), x, y in ((near, m / (mx * wx), n / (my * wy)), (far, k / mx, l / my)):
        slope2 = np.add.outer(
            4 * np.sin(np.pi * x) ** 2 / hx**2, 4 * np.sin(np.pi * y) ** 2 / hy**2
        )
        squares = np.maximum(squares, 1.0)
        C = np.maximum(C * (spectrum.flat + spectrum.steep / squares), 0.0)
        moments += [
            [C.sum(), (C / squares).sum()],
            [(C * slope2).sum(), (C / squares * slope2).sum()],
        ]
    return moments
