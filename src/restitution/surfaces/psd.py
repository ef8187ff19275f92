"""Power spectral density of a surface: C(q) = |∫ z exp(−iq·r) d²r|²/A, Sq² = (2π)⁻² ∫ C d²q.

Jacobs, Junge and Pastewka (2017), Surf. Topogr. 5, 013001, eqs 2 and 6. C is in m⁴, q is the wave
vector (rad/m). A scan is not periodic, so it is multiplied by each of nine sine tapers, and the
spectra are averaged (Riedel and Sidorenko 1995, IEEE Trans. Signal Process. 43, 188–195). The
leakage from long to short waves then falls with the fourth power of the wave number. The resolution
in spatial frequency (1/m) is ±1.5 divided by the size of the scan.
"""

from __future__ import annotations

import math
from itertools import product
from typing import NamedTuple

import numpy as np

from restitution.surfaces.surface import Array, Surface, is_periodic

_TAPERS = 3  # number of sine tapers along each axis
_BANDS_PER_OCTAVE = 4  # number of bands per factor of two in wave number (radial spectrum)
_SECTOR = 15  # half the width of the sectors around the x and y axes (°)


class RadialSpectrum(NamedTuple):
    """Mean wave number (rad/m) and mean power spectral density (m⁴) of bands of the wave number."""

    wave_number: Array
    density: Array


class DirectedSpectrum(NamedTuple):
    """A radial spectrum, and a description in words of the directions over which it is averaged."""

    directions: str
    spectrum: RadialSpectrum


def power_spectral_density(surface: Surface) -> Array:
    """Power spectral density C (m⁴) at the wave vectors 2π·`numpy.fft.fftfreq(n, spacing)`.

    Exact for a periodic surface, otherwise estimated with tapers; the shape is `grid.nodes`.
    """
    from scipy.fft import fft2

    z = surface.height - surface.height.mean()
    power: Array = np.zeros(z.shape)
    if is_periodic(surface):
        power += np.abs(fft2(z)) ** 2
    else:
        for a, b in product(*(tapers(n) for n in z.shape)):
            power += np.abs(fft2(z * a[:, None] * b[None, :])) ** 2 / _TAPERS**2
    power *= surface.grid.cell_area / z.size
    return power


def radial_spectrum(surface: Surface, density: Array | None = None) -> RadialSpectrum:
    """Power spectral density in bands of a quarter of an octave, averaged over directions.

    `density` is the `power_spectral_density` of `surface`, if already known, without its NaN. The
    highest band ends at the shortest wave that the grid resolves along both axes.
    """
    C = power_spectral_density(surface) if density is None else density
    q = wave_numbers(C.shape, surface.grid.spacing)
    least, most = 2 * math.pi / min(surface.grid.size), math.pi / max(surface.grid.spacing)
    count = max(1, round(_BANDS_PER_OCTAVE * math.log2(max(most / least, 1.0))))
    edges = np.geomspace(0.999 * least, 1.001 * most, count + 1)
    # Index 0 marks waves that are too long for the lowest band, and waves whose density is NaN.
    # These waves are left out, as are waves that are too short for the highest band.
    band = np.where(np.isfinite(C), np.digitize(q, edges), 0).ravel()
    size = np.bincount(band, minlength=count + 2)[1:-1]
    sums = (np.bincount(band, values.ravel(), count + 2)[1:-1] for values in (q, C))
    return RadialSpectrum(*(total[size > 0] / size[size > 0] for total in sums))


def directed_spectra(surface: Surface) -> list[DirectedSpectrum]:
    """Radial spectra over all directions, near the x axis (±15°) and near the y axis (±15°)."""
    C = power_spectral_density(surface)
    qx, qy = (
        2 * math.pi * np.fft.fftfreq(n, h)
        for n, h in zip(surface.grid.nodes, surface.grid.spacing, strict=True)
    )
    q = wave_numbers(C.shape, surface.grid.spacing)
    near = math.cos(math.radians(_SECTOR))
    sectors = {
        "all directions": np.ones(C.shape, bool),
        f"within {_SECTOR}° of x": np.abs(qx)[:, None] >= near * q,
        f"within {_SECTOR}° of y": np.abs(qy)[None, :] >= near * q,
    }
    return [
        DirectedSpectrum(name, radial_spectrum(surface, np.where(inside, C, np.nan)))
        for name, inside in sectors.items()
    ]


def wave_numbers(nodes: tuple[int, ...], spacing: tuple[float, float]) -> Array:
    """Wave numbers (rad/m) of the modes of `fft2`, shape `nodes`."""
    qx, qy = (2 * math.pi * np.fft.fftfreq(n, h) for n, h in zip(nodes, spacing, strict=True))
    return np.asarray(np.hypot(qx[:, None], qy[None, :]))


def tapers(n: int) -> list[Array]:
    """The sine tapers of `n` points, with a mean square of 1."""
    at = (np.arange(n) + 1) * math.pi / (n + 1)
    return [math.sqrt(2 * n / (n + 1)) * np.sin(k * at) for k in range(1, _TAPERS + 1)]
