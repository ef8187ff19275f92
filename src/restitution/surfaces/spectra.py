"""Spectra of generated surfaces: wave amplitudes as functions of the wave vector."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.surface import Array


@dataclass(frozen=True)
class Autocorrelated:
    """Exponential or Gaussian autocorrelation, R = Rq² exp(−2.3 ρ) or Rq² exp(−2.3 ρ²).

    ρ² = (τ₁/β₁)² + (τ₂/β₂)² with the lags τ along and across the lay and the `correlation_length` β
    (m), at which R has fallen to 10 %. `lay` is the angle of the lay from the x axis (rad),
    `shortest` the shortest wavelength (m). Hu and Tonder (1992), Int. J. Mach. Tools Manufact. 32,
    83–90.
    """

    kind: Literal["exponential", "gaussian"]
    correlation_length: tuple[float, float]
    lay: float = 0.0
    shortest: float | None = None

    @property
    def longest(self) -> float:
        """The longest correlation length (m)."""
        return max(self.correlation_length)

    def check(self, grid: Grid) -> None:
        """Raise `SurfaceError` if a parameter is invalid or `grid` cannot represent these waves."""
        for axis, beta in enumerate(self.correlation_length):
            where = (
                f"along {'xy'[axis]}" if self.lay == 0 else ("along", "across")[axis] + " the lay"
            )
            # If the lay is rotated, each correlation length must fit the grid along both axes.
            spacing, size = grid.spacing[axis], grid.size[axis]
            if self.lay != 0:
                spacing, size = max(grid.spacing), min(grid.size)
            _check_correlation_length(where, beta, spacing, size)
        if self.lay != 0 and self.correlation_length[0] == self.correlation_length[1]:
            raise SurfaceError(
                "a surface with one correlation length has no lay; give two "
                "lengths, along the lay and across it, or remove the key lay",
                argument="lay",
            )
        _check_shortest(self.shortest, grid)

    def amplitude(self, grid: Grid) -> Array:
        """Factors for the `rfft2` modes of white noise on `grid`; only their ratios matter."""
        from scipy.fft import rfft2

        x, y = (
            np.where(2 * np.arange(n) > n, np.arange(n) - n, np.arange(n)) * h
            for n, h in zip(grid.nodes, grid.spacing, strict=True)
        )
        c, s = math.cos(self.lay), math.sin(self.lay)
        along = c * x[:, None] + s * y[None, :]
        across = c * y[None, :] - s * x[:, None]
        rho2 = (along / self.correlation_length[0]) ** 2
        rho2 = rho2 + (across / self.correlation_length[1]) ** 2
        R = np.exp(-2.3 * (np.sqrt(rho2) if self.kind == "exponential" else rho2))
        # Periodic continuation causes a kink in R at half the domain, so the spectrum of R can be
        # negative.
        H: Array = np.sqrt(np.maximum(rfft2(R).real, 0.0))
        return _without_short_waves(H, grid, self.shortest)

    def density(self, qx: Array, qy: Array, grid: Grid) -> Array:
        """Power spectral density at wave vectors (rad/m), up to a factor, without `shortest`."""
        c, s = math.cos(self.lay), math.sin(self.lay)
        along, across = (c * qx + s * qy), (c * qy - s * qx)
        q2 = (along * self.correlation_length[0]) ** 2 + (across * self.correlation_length[1]) ** 2
        scale = math.prod(self.correlation_length)
        if self.kind == "exponential":
            return np.asarray(2 * math.pi * 2.3 * scale * (2.3**2 + q2) ** -1.5)
        return np.asarray(math.pi / 2.3 * scale * np.exp(-q2 / (4 * 2.3)))

    def parameters(self, grid: Grid) -> dict[str, str | float]:
        """Provenance entries that describe these waves on `grid`."""
        axes = ("x", "y") if self.lay == 0 else ("along_lay", "across_lay")
        lengths = zip(axes, self.correlation_length, strict=True)
        return {
            **{f"correlation_length_{axis}_m": float(beta) for axis, beta in lengths},
            "correlation_length_defined_at": "autocorrelation of 10 %",
            "lay_rad": float(self.lay),
            "shortest_m": float(self.shortest or 2 * max(grid.spacing)),
        }


@dataclass(frozen=True)
class SelfAffine:
    """Power spectral density ∝ q^−2(H+1) between the wavelengths `shortest` and `rolloff` (m).

    H is the exponent `hurst`. At longer wavelengths the density is constant; without `rolloff` the
    power law extends to the size of the domain. Persson et al. (2005), J. Phys.: Condens. Matter
    17, R1–R62.
    """

    hurst: float
    rolloff: float | None = None
    shortest: float | None = None

    @property
    def longest(self) -> float:
        """The distance (m) beyond which heights are uncorrelated; infinite without `rolloff`."""
        return math.inf if self.rolloff is None else self.rolloff

    def check(self, grid: Grid) -> None:
        """Raise `SurfaceError` if a parameter is invalid or `grid` cannot represent these waves."""
        if not 0 < self.hurst <= 1:
            raise SurfaceError(
                f"{self.hurst:g} should be above 0 and at most 1; real surfaces often have "
                "a Hurst exponent of 0.8",
                argument="hurst",
            )
        _check_shortest(self.shortest, grid)
        rolloff, shortest = self.rolloff, self.shortest or 2 * max(grid.spacing)
        if rolloff is None:
            return
        _check_positive("rolloff", rolloff)
        if not shortest < rolloff <= max(grid.size):
            raise SurfaceError(
                f"{rolloff * 1e6:g} um is not between the shortest wavelength, "
                f"{shortest * 1e6:g} um, and the size of the domain, {max(grid.size) * 1e6:g} um; "
                "change rolloff, or leave rolloff out for a power law up to the size of the domain",
                argument="rolloff",
            )

    def amplitude(self, grid: Grid) -> Array:
        """Factors for the `rfft2` modes of white noise on `grid`; only their ratios matter."""
        q = _wave_numbers(grid)
        q_r = 2 * math.pi / (max(grid.size) if self.rolloff is None else self.rolloff)
        H: Array = np.maximum(q / q_r, 1.0) ** -(self.hurst + 1.0)
        H[0, 0] = 0.0
        return _without_short_waves(H, grid, self.shortest)

    def density(self, qx: Array, qy: Array, grid: Grid) -> Array:
        """Power spectral density at wave vectors (rad/m), up to a factor, without `shortest`.

        Without `rolloff`, the power law extends to the size of `grid`.
        """
        longest = max(grid.size) if self.rolloff is None else self.rolloff
        q = np.hypot(qx, qy) * longest / (2 * math.pi)
        return np.asarray(np.maximum(q, 1.0) ** (-2 * (self.hurst + 1.0)))

    def parameters(self, grid: Grid) -> dict[str, str | float]:
        """Provenance entries that describe these waves on `grid`."""
        return {
            "hurst": float(self.hurst),
            "rolloff_m": float(self.rolloff or max(grid.size)),
            "shortest_m": float(self.shortest or 2 * max(grid.spacing)),
        }


Spectrum = Autocorrelated | SelfAffine


def _without_short_waves(H: Array, grid: Grid, shortest: float | None) -> Array:
    if shortest is not None:
        H[_wave_numbers(grid) > 2 * math.pi / shortest * (1 + 1e-9)] = 0.0
    return H


def _wave_numbers(grid: Grid) -> Array:
    (nx, ny), (hx, hy) = grid.nodes, grid.spacing
    qx, qy = np.fft.fftfreq(nx, hx)[:, None], np.fft.rfftfreq(ny, hy)[None, :]
    return np.asarray(2 * math.pi * np.hypot(qx, qy))


def _check_correlation_length(where: str, beta: float, spacing: float, size: float) -> None:
    if not (math.isfinite(beta) and beta > 0):
        raise SurfaceError(
            f"{beta:g} m {where} is not a positive length; give a length such as 5 um",
            argument="correlation_length",
        )
    if beta < spacing:
        raise SurfaceError(
            f"{beta * 1e6:g} um {where} is below the grid "
            f"spacing of {spacing * 1e6:g} um and cannot be resolved; reduce grid.spacing or give "
            "a longer correlation length",
            argument="correlation_length",
        )
    if beta > 0.5 * size:
        raise SurfaceError(
            f"{beta * 1e6:g} um {where} is above half of the "
            f"domain of {size * 1e6:g} um; enlarge the domain (grid.nodes) or give a shorter "
            "correlation length",
            argument="correlation_length",
        )


def _check_shortest(shortest: float | None, grid: Grid) -> None:
    if shortest is None:
        return
    _check_positive("shortest", shortest)
    if not 2 * max(grid.spacing) <= shortest < max(grid.size):
        raise SurfaceError(
            f"{shortest * 1e6:g} um is not a wavelength that the grid can represent "
            f"({2e6 * max(grid.spacing):g} to {1e6 * max(grid.size):g} um); reduce grid.spacing, "
            "or leave out the key 'shortest'",
            argument="shortest",
        )


def _check_positive(name: str, wavelength: float) -> None:
    if not (math.isfinite(wavelength) and wavelength > 0):
        raise SurfaceError(
            f"{wavelength:g} m is not a positive wavelength; give a wavelength such as "
            f"10 um, or leave {name} out",
            argument=name,
        )
