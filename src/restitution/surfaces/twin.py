"""Statistical twin of a scan: a random surface of any size with the statistics of the scan.

Waves with the amplitudes of `wave_spectrum` first get random phases; then heights and amplitudes
are adjusted alternately (Schreiber and Schmitz 1996, Phys. Rev. Lett. 77, 635–638), band by band
from long to short waves, so that a finer grid only adds waves. The target of a band is the
distribution of heights that the scan has without shorter waves. In the first band all waves are
adjusted; each further band halves the shortest wavelength, and only its phases are adjusted. The
last waves, with 1 % of the mean square height, keep random phases.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from restitution.numerics.grid import Grid
from restitution.surfaces.describe import describe, rms_slope
from restitution.surfaces.psd import power_spectral_density, radial_spectrum
from restitution.surfaces.refused import RefusedSurfaceError
from restitution.surfaces.resample import carried, crop_to, left_out, place_on_grid
from restitution.surfaces.surface import Array, Surface, noted
from restitution.surfaces.wave_spectrum import Modes, TwinWaves, spectrum_of

LEAST_PIXELS = 16  # smallest number of pixels of a scan along each axis
# The shortest waves are not adjusted. They hold less than this share of the mean square height.
_UNADJUSTED = 0.01
_FIRST_BAND = 2**20  # largest number of nodes of the grid for the first band (the longest waves)
_LEAST_FIRST = 8  # smallest number of cells along each edge of the scan in the first band's grid
_LEAST_WAVES = 3  # waves along each edge of a band; those of a twin as large as the scan have more

# A band is adjusted at most _WORK/n times, where n is the number of nodes of its grid. If _WORK/n
# is outside the range _ADJUSTMENTS, the nearest limit of this range applies instead.
_WORK = 2**24
_ADJUSTMENTS = 3, 60

_NEGLIGIBLE = 1e-3  # misfit of heights at which the adjustment ends
_STANDSTILL = 0.05  # the adjustment ends if the misfit decreases by less than this fraction

# To compare spectra, the twin is divided into parts of the size of the scan. The mean spectrum of
# at most this many parts is used. A twin smaller than the scan is compared as a whole.
_PARTS = 16
_COMPARED = 2**23  # largest total number of nodes of these parts; a single part may have more
_UNLIKE = 0.5  # above this misfit of the spectrum, the provenance's `notice` contains a warning

# Probabilities of the quantiles that represent a distribution of heights, denser in the tails.
_PROBABILITIES = 0.5 * (1 - np.cos(np.linspace(0, np.pi, 4097)))
_TABLE = 2**14  # number of steps of the table that maps heights (see `_with_heights`)


def twin(scan: Surface, grid: Grid, seed: int) -> Surface:
    """Make a twin of `scan` on `grid`, periodic over a multiple of `grid` as large as the scan.

    All waves together have the Rq of the scan, and nearly its skewness and kurtosis; those too
    short for the cells are then left out. `spectrum_misfit` in the provenance is the rms relative
    difference of the spectra in bands of a quarter octave, weighted by their shares of mean square
    height and slope.

    Raises `SurfaceError` for a scan that is flat or has fewer than 16 pixels along an axis, and for
    cells that are too large for any wave of the scan.
    """
    _check(scan, grid)
    nx, ny = (
        n * math.ceil(s / g * (1 - 1e-9))
        for n, s, g in zip(grid.nodes, scan.grid.size, grid.size, strict=True)
    )
    whole = Grid((nx, ny), grid.spacing)
    height = adjusted_heights(spectrum_of(scan, whole.size), scan, whole, seed)
    made = Surface(crop_to(height, grid.nodes), grid)
    return replace(made, provenance=_provenance(scan, made, seed, periodic=whole == grid))


def _check(scan: Surface, grid: Grid) -> None:
    name = scan.provenance.get("file", "the scan")
    if min(scan.grid.nodes) < LEAST_PIXELS:
        raise RefusedSurfaceError(
            "too-few-pixels",
            f"{name}: {scan.grid.nodes[0]} x {scan.grid.nodes[1]} pixels are too few for the "
            "spectrum of a twin",
            f'give a scan of at least {LEAST_PIXELS} x {LEAST_PIXELS}, or how="mirror"',
        )
    if np.ptp(scan.height) <= 8 * np.finfo(np.float64).eps * float(np.abs(scan.height).max()):
        raise RefusedSurfaceError(
            "flat-scan",
            f"{name}: is flat, so it has no twin",
            'give another scan, or how="mirror"',
        )
    if any(2 * h >= s for h, s in zip(grid.spacing, scan.grid.size, strict=True)):
        raise RefusedSurfaceError(
            "cells-above-scan",
            f"grid: cells of {1e6 * max(grid.spacing):g} um cannot resolve any wave of a scan of "
            f"{1e6 * scan.grid.size[0]:.4g} x {1e6 * scan.grid.size[1]:.4g} um",
            "use a smaller spacing",
        )


def adjusted_heights(spectrum: TwinWaves, scan: Surface | None, grid: Grid, seed: int) -> Array:
    """Heights (m) of the waves of `spectrum` on `grid`, which is as large as their period.

    They are distributed as those of `scan`; without it, phases stay random.
    """
    return _heights(_adjusted(spectrum, scan, grid, seed), grid.nodes)


def _adjusted(spectrum: TwinWaves, scan: Surface | None, grid: Grid, seed: int) -> Modes:
    modes: Modes = np.zeros((1, 1), dtype=np.complex128)
    most = 0, 0
    for cell in [] if scan is None else _bands(spectrum, scan):
        if min(spectrum.numbers(cell)) < _LEAST_WAVES:
            continue
        assert scan is not None
        modes, most = _band(spectrum, scan, cell, seed, modes, most)
        if all(c <= h for c, h in zip(cell, grid.spacing, strict=True)):
            break
    wanted = spectrum.numbers(grid.spacing)
    full = spectrum.modes(wanted, grid.nodes, seed)
    _copy(modes, full, (min(wanted[0], most[0]), min(wanted[1], most[1])))
    return full


def _bands(spectrum: TwinWaves, scan: Surface) -> list[tuple[float, float]]:
    """The largest cell (m) that resolves the waves of each band, from long to short waves."""
    most = (1 - _UNADJUSTED) * float(np.var(scan.height))

    def cell(level: int) -> tuple[float, float]:
        return scan.grid.spacing[0] * 2.0**level, scan.grid.spacing[1] * 2.0**level

    # The largest level at which each edge of the scan has at least _LEAST_FIRST cells.
    coarsest = (min(scan.grid.nodes) // _LEAST_FIRST).bit_length() - 1
    last = 0
    while last < coarsest and float(np.var(carried(scan, cell(last + 1)))) > most:
        last += 1
    first = last
    while first < coarsest and math.prod(_nodes(spectrum.numbers(cell(first)))) > _FIRST_BAND:
        first += 1
    return [cell(level) for level in range(first, last - 1, -1)]


def _band(
    spectrum: TwinWaves,
    scan: Surface,
    cell: tuple[float, float],
    seed: int,
    known: Modes,
    kept: tuple[int, int],
) -> tuple[Modes, tuple[int, int]]:
    """Adjust the phases of the waves that cells of size `cell` (m) resolve, except those `known`.

    Return all waves, and the largest numbers of their periods; `kept` are these of the known waves.
    """
    from scipy.fft import irfft2, rfft2

    most = spectrum.numbers(cell)
    nodes = _nodes(most)
    modes = spectrum.modes(most, nodes, seed)
    size = np.abs(modes)
    power = 2 * float((size**2).sum()) - float((size[:, 0] ** 2).sum())
    wanted = np.sort(carried(scan, cell), axis=None)
    wanted -= wanted.mean()
    wanted *= math.sqrt(power / float(np.mean(wanted**2)))
    misfit, fewest = math.inf, _ADJUSTMENTS[0]
    for _ in range(max(fewest, min(_WORK // math.prod(nodes), _ADJUSTMENTS[1]))):
        _copy(known, modes, kept)
        z = irfft2(modes, s=nodes, norm="forward")
        adjusted = _with_heights(z, wanted)
        z -= adjusted
        last, misfit = misfit, math.sqrt(float(np.mean(z**2)) / power)
        if misfit < _NEGLIGIBLE or misfit > last * (1 - _STANDSTILL):
            break
        modes = rfft2(adjusted, norm="forward")
        modes *= size / np.maximum(np.abs(modes), np.finfo(float).tiny)
    _copy(known, modes, kept)
    return modes, most


def _with_heights(z: Array, heights: Array) -> Array:
    """Give `z` the distribution of the sorted `heights`, without changing its rank order."""
    have = np.sort(z, axis=None)
    low, high = float(have[0]), float(have[-1])
    if not low < high:
        return z
    # A table with equal steps is fast, because the interval of a value is found without a search.
    table = np.interp(np.linspace(low, high, _TABLE + 1), _quantiles(have), _quantiles(heights))
    return _between(table, (z - low) * (_TABLE / (high - low)))


def _quantiles(ascending: Array) -> Array:
    return _between(ascending, _PROBABILITIES * (ascending.size - 1))


def _between(table: Array, at: Array) -> Array:
    before = np.minimum(at.astype(np.intp), table.size - 2)
    first = table[before]
    before += 1
    return first + (at - before + 1) * (table[before] - first)


def _nodes(most: tuple[int, int]) -> tuple[int, int]:
    from scipy.fft import next_fast_len

    return (
        next_fast_len(2 * most[0] + 2, real=True),
        next_fast_len(2 * most[1] + 2, real=True),
    )


def _copy(source: Modes, target: Modes, most: tuple[int, int]) -> None:
    M, N = most
    target[: M + 1, : N + 1] = source[: M + 1, : N + 1]
    if M:
        target[-M:, : N + 1] = source[-M:, : N + 1]


def _heights(modes: Modes, nodes: tuple[int, int]) -> Array:
    """Sum the waves `modes` (overwritten); phases are relative to the origin of a `Grid`."""
    from scipy.fft import irfft2

    number = np.fft.fftfreq(nodes[0], 1 / nodes[0]), np.arange(modes.shape[1])
    for k, n, shape in zip(number, nodes, ((-1, 1), (1, -1)), strict=True):
        modes *= np.exp(-2j * np.pi * (n // 2) / n * k).reshape(shape)
    return np.asarray(irfft2(modes, s=nodes, norm="forward", overwrite_x=True))


def _provenance(
    scan: Surface, made: Surface, seed: int, *, periodic: bool
) -> dict[str, str | float]:
    grid = made.grid
    misfit = _misfit(made, scan)
    statistics = {
        f"scan_{key}": value for key, value in describe(scan).items() if value is not None
    }
    removed = left_out(scan, carried(scan, grid.spacing), grid.spacing)
    edges = f"{1e6 * scan.grid.size[0]:.4g} x {1e6 * scan.grid.size[1]:.4g} um"
    slope = rms_slope(made)
    notice = (
        f"{scan.provenance.get('file', 'the scan')}: the surface is a statistical twin (seed "
        f"{seed}) of the scan of {edges}, not the scan itself: Rq "
        f"{1e9 * float(np.std(made.height)):.4g} instead of {1e9 * statistics['scan_Sq_m']:.4g} "
        f"nm, rms slope {slope:.3g} instead of {rms_slope(scan):.3g}, rms difference of the "
        f"spectra {misfit:.0%} (usually 10% to 20%)"
    )
    if removed["removed_slope"] > 0:
        notice += (
            f"; waves shorter than {1e6 * removed['shortest_carried_m']:.4g} um, which this grid "
            f"does not resolve, have {removed['removed_slope']:.0%} of the scan's rms slope"
        )
    if misfit > _UNLIKE:
        notice += (
            "; one spectrum does not describe this scan, perhaps because of steps, scratches, "
            "single particles or residual form: crop the scan, remove outliers or level it"
        )
    return {
        **noted(scan.provenance, notice),
        "source": "twin",
        "extension": "statistical twin",
        "seed": seed,
        "longest_wave_m": max(scan.grid.size),
        "spectrum_misfit": misfit,
        "twin_Sdq": slope,
        **statistics,
        **({"periodicity": "periodic over the domain"} if periodic else {}),
        "placement": "made on the grid, with the waves that it carries",
        **removed,
    }


def _misfit(made: Surface, scan: Surface) -> float:
    """Relative rms difference between the radial spectra of the twin `made` and of `scan`.

    Only waves that both grids resolve are compared, in the mean over parts as large as the scan.
    """
    grid, pixel = made.grid, scan.grid.spacing
    nx, ny = (
        min(n, int(s / h * (1 + 1e-9)))
        for n, s, h in zip(grid.nodes, scan.grid.size, grid.spacing, strict=True)
    )
    corners = [
        (i, j)
        for i in range(0, grid.nodes[0] - nx + 1, nx)
        for j in range(0, grid.nodes[1] - ny + 1, ny)
    ][: max(1, min(_PARTS, _COMPARED // (nx * ny)))]
    part = Grid((nx, ny), grid.spacing)
    density = np.zeros(part.nodes)
    for i, j in corners:
        one = Surface(made.height[i : i + nx, j : j + ny], part)
        density += power_spectral_density(one) / len(corners)
    of_scan = radial_spectrum(Surface(place_on_grid(scan, part).height, part))
    of_twin = radial_spectrum(Surface(made.height[:nx, :ny], part), density)
    both = of_scan.wave_number <= math.pi / max(*pixel, *grid.spacing) * (1 + 1e-9)
    q, C = of_scan.wave_number[both], of_scan.density[both]
    if not q.size or not C.max() > 0:
        return 0.0
    # The weight of a band is its share of the mean square height plus its share of the mean square
    # slope. These mean squares are proportional to ∫ C q² d(ln q) and ∫ C q⁴ d(ln q).
    share = sum(power / power.sum() for power in (C * q**k for k in (2, 4)))
    off = (of_twin.density[both] / np.maximum(C, 1e-12 * C.max()) - 1) ** 2
    return float(np.sqrt(np.average(off, weights=share)))
