"""Random rough surfaces with a prescribed autocorrelation, by an FFT digital filter.

    R(τ) = Rq² exp(−2.3 ρ)   (exponential)     R(τ) = Rq² exp(−2.3 ρ²)   (Gaussian)
    ρ = sqrt((τx/βx)² + (τy/βy)²),   S = FFT(R),   z = IFFT(sqrt(S) · FFT(white noise))

β, the correlation length, is where the autocorrelation has fallen to 10 % (e^−2.3 = 0.100).

Source: Hu & Tonder (1992), Int. J. Mach. Tools Manufact. 32, 83–90.
"""

from __future__ import annotations

import math
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.surface import Surface

AutocorrelationKind = Literal["exponential", "gaussian"]


def generate_surface(
    grid: Grid,
    *,
    kind: AutocorrelationKind,
    rms: float,
    correlation_length: float | tuple[float, float],
    seed: int,
) -> Surface:
    """Make a Gaussian-distributed surface with zero mean and exactly the rms height `rms`.

    `rms` (Rq) and `correlation_length` (β, or (βx, βy)) are in metres. The same arguments give
    the same surface on every machine and numpy version, to rounding. The surface is periodic
    over the domain of `grid`: opposite edges match. Another grid draws other noise, so the same
    seed on a finer grid is another surface and not a refinement of this one.

    Raises `SurfaceError` for an unknown `kind`, a negative seed, and an rms or a correlation
    length that is not positive or that the grid cannot hold (below its spacing, above half of
    its domain).
    """
    if kind not in get_args(AutocorrelationKind):
        raise SurfaceError(
            f"roughness.kind: {kind!r} is no autocorrelation known here; "
            "choose 'exponential' or 'gaussian'"
        )
    if not (math.isfinite(rms) and rms > 0):
        raise SurfaceError(
            f"roughness.rms: {rms:g} m is not a positive length; give the rms height, "
            'such as "0.1 um"'
        )
    if seed < 0:
        raise SurfaceError(f"roughness.seed: {seed} is negative; give a whole number from 0 up")
    beta = (
        correlation_length
        if isinstance(correlation_length, tuple)
        else (correlation_length, correlation_length)
    )
    for axis in range(2):
        _check_correlation_length("xy"[axis], beta[axis], grid.spacing[axis], grid.size[axis])

    height = _filter_noise(_white_noise(grid.nodes, seed), _autocorrelation(grid, kind, beta))
    height -= height.mean()
    height *= rms / math.sqrt(np.mean(height**2))
    return Surface(
        height,
        grid,
        {
            "source": "generated",
            "method": "Hu and Tonder 1992",
            "kind": kind,
            "rms_m": float(rms),
            "correlation_length_x_m": float(beta[0]),
            "correlation_length_y_m": float(beta[1]),
            "correlation_length_defined_at": "autocorrelation of 10 %",
            "seed": int(seed),
            "noise": "PCG64 raw stream, inverse normal distribution",
            "periodicity": "periodic over the domain",
        },
    )


def _check_correlation_length(axis: str, beta: float, spacing: float, size: float) -> None:
    if not (math.isfinite(beta) and beta > 0):
        raise SurfaceError(
            f"roughness.correlation_length: {beta:g} m along {axis} is not a positive length; "
            'give one such as "5 um"'
        )
    if beta < spacing:
        raise SurfaceError(
            f"roughness.correlation_length: {beta * 1e6:g} um along {axis} is below the grid "
            f"spacing of {spacing * 1e6:g} um and cannot be resolved; refine grid.spacing or give "
            "a longer correlation length"
        )
    if beta > 0.5 * size:
        raise SurfaceError(
            f"roughness.correlation_length: {beta * 1e6:g} um along {axis} is above half of the "
            f"domain of {size * 1e6:g} um; enlarge the domain (grid.nodes) or give a shorter "
            "correlation length"
        )


def _white_noise(shape: tuple[int, int], seed: int) -> NDArray[np.float64]:
    """Independent standard normal numbers of the given shape."""
    from scipy.special import ndtri

    # numpy keeps the raw stream of a bit generator fixed for ever, but lets the methods of
    # Generator (standard_normal and the like) change from release to release (NEP 19). So the
    # raw 64-bit words are mapped here. 52 of their bits and a half keep u off 0 and 1, where
    # the inverse distribution is infinite; a 53rd bit would round up to 1.
    raw = np.random.PCG64(seed).random_raw(shape[0] * shape[1])
    u = ((raw >> np.uint64(12)).astype(np.float64) + 0.5) * 2.0**-52
    noise: NDArray[np.float64] = ndtri(u).reshape(shape)
    return noise


def _autocorrelation(
    grid: Grid, kind: AutocorrelationKind, beta: tuple[float, float]
) -> NDArray[np.float64]:
    """Target R/Rq² at every lag of the grid, shape `grid.nodes`, wrapped round the domain."""
    lag_x, lag_y = (
        np.minimum(np.arange(n), n - np.arange(n)) * h
        for n, h in zip(grid.nodes, grid.spacing, strict=True)
    )
    rho2 = (lag_x[:, None] / beta[0]) ** 2 + (lag_y[None, :] / beta[1]) ** 2
    rho_power = np.sqrt(rho2) if kind == "exponential" else rho2
    R: NDArray[np.float64] = np.exp(-2.3 * rho_power)
    return R


def _filter_noise(noise: NDArray[np.float64], R: NDArray[np.float64]) -> NDArray[np.float64]:
    """White noise coloured to the autocorrelation `R`; both of shape (nx, ny)."""
    from scipy.fft import irfft2, rfft2

    # Wrapping puts a kink into R at half of the domain, so S may dip below zero there.
    S = np.maximum(rfft2(R).real, 0.0)
    H = np.sqrt(S)
    z: NDArray[np.float64] = irfft2(H * rfft2(noise), s=noise.shape)
    return z
