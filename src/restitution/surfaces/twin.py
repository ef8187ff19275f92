"""A statistical twin of a scan: another surface, of any size, alike in all that is counted.

1. The scan's power spectrum (`psd`) is interpolated to the wave vectors of the larger surface.
   Waves longer than the scan have not been measured and are left out.
2. It is multiplied by a + b/q² such that height and slope have the scan's mean squares: tapers see
   less of the scan's rim than of its middle.
3. These amplitudes are given the phases of white noise, then heights and amplitudes are adjusted
   in turns until the distribution of heights is the scan's (`heights.adjusted`).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.grid import Grid
from restitution.surfaces.describe import describe, rms_slope
from restitution.surfaces.heights import adjusted
from restitution.surfaces.noise import white_noise
from restitution.surfaces.psd import power_spectral_density, radial_spectrum
from restitution.surfaces.surface import Surface

Array = NDArray[np.float64]

_PARTS = 16  # of the twin, as large as the scan, that its spectrum is compared on
_UNLIKE = 0.5  # misfit of the spectrum from which on the twin is said not to be one


def twin(scan: Surface, nodes: tuple[int, int], seed: int) -> Surface:
    """A periodic surface of `nodes` or some more with the spacing of `scan`, and its statistics.

    Rq, skewness and kurtosis are the scan's; how far the slope and the spectrum are off is in the
    provenance (`twin_Sdq`, `spectrum_misfit`: root mean square of the relative difference, on parts
    as large as the scan, over bands of a quarter octave, each by its share of the mean squares of
    height and slope), beside the scan's own (`scan_…`).
    """
    from scipy.fft import irfft2, next_fast_len, rfft2

    nodes = next_fast_len(nodes[0], real=True), next_fast_len(nodes[1], real=True)
    grid = Grid(nodes, scan.grid.spacing)
    z = scan.height - scan.height.mean()
    H = np.sqrt(_spectrum(scan, grid))[:, : nodes[1] // 2 + 1]
    phases = np.exp(1j * np.angle(rfft2(white_noise(nodes, seed))))
    height = irfft2(H * phases, s=nodes)
    height, _ = adjusted(height, _quantiles(z, height.size))
    made = Surface(height, grid)
    misfit = _misfit(made, scan)
    statistics = {
        f"scan_{key}": value for key, value in describe(scan).items() if value is not None
    }
    edges = f"{1e6 * scan.grid.size[0]:.4g} x {1e6 * scan.grid.size[1]:.4g} um"
    slope = rms_slope(made)
    notice = (
        f"{scan.provenance.get('file', 'the scan')}: the surface is a statistical twin (seed "
        f"{seed}) of the scan of {edges}, not the scan itself: Rq is the same, rms slope "
        f"{slope:.3g} instead of {rms_slope(scan):.3g}, spectrum within {misfit:.0%} of the scan's"
    )
    if misfit > _UNLIKE:
        notice += (
            "; one spectrum does not describe this scan (steps, scratches, single particles, or "
            "a form that is left in it?): crop it, take out outliers or level it"
        )
    return Surface(
        height,
        grid,
        {
            **scan.provenance,
            "source": "twin",
            "extension": "statistical twin",
            "seed": seed,
            "longest_wave_m": max(scan.grid.size),
            "spectrum_misfit": misfit,
            "twin_Sdq": slope,
            **statistics,
            "periodicity": "periodic over the domain",
            "notice": notice,
        },
    )


def _spectrum(scan: Surface, grid: Grid) -> Array:
    """Power of the modes of `fft2` on `grid`, to any scale, shape `grid.nodes`."""
    from scipy.ndimage import map_coordinates

    C = np.fft.fftshift(power_spectral_density(scan))
    # Wave vectors in units of the scan's: its modes are at whole numbers.
    number = [np.fft.fftfreq(n) * m for n, m in zip(grid.nodes, C.shape, strict=True)]
    at = np.meshgrid(*(k + m // 2 for k, m in zip(number, C.shape, strict=True)), indexing="ij")
    S: Array = map_coordinates(C, at, order=1, mode="grid-wrap")
    waves2 = number[0][:, None] ** 2 + number[1][None, :] ** 2
    S[waves2 < 1 - 1e-9] = 0.0
    # Mean squares of height and of slope between neighbours, as `rms_slope` takes it.
    slope2 = sum(
        (4 * np.sin(np.pi * k / m) ** 2 / h**2).reshape(shape)
        for k, m, h, shape in zip(number, C.shape, grid.spacing, ((-1, 1), (1, -1)), strict=True)
    )
    long = S / np.maximum(waves2, 1.0)
    moments = [[S.sum(), long.sum()], [(S * slope2).sum(), (long * slope2).sum()]]
    wanted = float(np.var(scan.height)), rms_slope(scan) ** 2
    a, b = np.linalg.solve(moments, wanted)
    power: Array = np.maximum(a * S + b * long, 0.0)
    return power


def _quantiles(z: Array, n: int) -> Array:
    """n heights, ascending, with the distribution and the mean square of z."""
    of_z = (np.arange(z.size) + 0.5) / z.size
    heights = np.interp((np.arange(n) + 0.5) / n, of_z, np.sort(z, axis=None))
    heights -= heights.mean()
    heights *= math.sqrt(float(np.mean(z**2)) / float(np.mean(heights**2)))
    return heights


def _misfit(made: Surface, scan: Surface) -> float:
    """How far the radial spectrum of parts of `made` is from that of `scan`, relatively."""
    (nx, ny), (mx, my) = made.grid.nodes, scan.grid.nodes
    nx, ny = min(nx, mx), min(ny, my)
    corners = [
        (i, j)
        for i in range(0, made.grid.nodes[0] - nx + 1, nx)
        for j in range(0, made.grid.nodes[1] - ny + 1, ny)
    ]
    part = Grid((nx, ny), scan.grid.spacing)
    density = np.mean(
        [
            power_spectral_density(Surface(made.height[i : i + nx, j : j + ny], part))
            for i, j in corners[:_PARTS]
        ],
        axis=0,
    )
    of_scan = radial_spectrum(Surface(scan.height[:nx, :ny], part))
    of_twin = radial_spectrum(Surface(made.height[:nx, :ny], part), density)
    # Bands count by their share of the mean squares of height and slope, ∫ C q^(2 or 4) d(ln q).
    share = sum(
        power / power.sum() for power in (of_scan.density * of_scan.wave_number**k for k in (2, 4))
    )
    off = (of_twin.density / of_scan.density - 1) ** 2
    return float(np.sqrt(np.average(off, weights=share)))
