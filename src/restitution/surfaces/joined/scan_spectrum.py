"""Power spectrum of one scan in bands that all scans share, and its trusted range."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from restitution.errors import SurfaceError
from restitution.surfaces.joined import response
from restitution.surfaces.psd import power_spectral_density, tapers, wave_numbers
from restitution.surfaces.surface import Array, Surface

PER_OCTAVE = 4  # bands
PIXELS = 4.0  # the shortest trusted wave, in pixels
PERIODS = 3.0  # of the longest trusted wave in an edge
_LEAST = 16  # pixels along each edge
_WINDOW = 2.0  # periods over which tapers average, for the variance of a single estimate
_TAPERED = 1.17  # variance of an estimate with tapers, relative to one without, along each axis
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class ScanSpectrum:
    """Power spectrum of a scan, averaged over bands of the wave number.

    Attributes:
        name: Name of the scan in messages.
        surface: The levelled scan; a line scan has one pixel along y.
        band: Number of each band: wave numbers around 2π·2^(band/4)/m.
        wave_number: Mean wave number in each band (rad/m).
        density: C of a height map (m⁴), C₁ of a line scan (m³), in each band.
        modes: Number of independent waves in each band.
        bias: Mean of the logarithm of an estimate minus the logarithm of its mean.
        shortest: Shortest wave (m) that the instrument resolves.
        why: What sets `shortest`.
        weights: Response of each band of long waves (rows) to waves (columns).
        waves: Wave numbers (rad/m) of the columns of `weights`.
    """

    name: str
    surface: Surface
    band: Array
    wave_number: Array
    density: Array
    modes: Array
    bias: Array
    shortest: float
    why: str
    weights: Array
    waves: Array

    @classmethod
    def of(
        cls, surface: Surface, degree: int, name: str, cut_off: tuple[float, str] = (0.0, "")
    ) -> Self:
        """Spectrum of `surface`, levelled by a polynomial of `degree` (−1: not levelled).

        `cut_off` is the shortest wave (m) that the instrument resolves, and the reason.

        Raises `SurfaceError` for a scan that is flat or has fewer than 16 pixels along an edge.
        """
        if max(surface.grid.nodes) < _LEAST or 1 < min(surface.grid.nodes) < _LEAST:
            raise SurfaceError(f"{name}: has fewer than {_LEAST} pixels along an edge")
        if not np.ptp(surface.height) > 8 * np.finfo(float).eps * np.abs(surface.height).max():
            raise SurfaceError(f"{name}: is flat; leave it out")
        line = is_line(surface)
        q, C, modes = _of_line(surface) if line else _of_map(surface)
        edge = surface.grid.size[0] if line else min(surface.grid.size)
        if line:
            k, waves, weights = response.of_line(degree)
        else:
            aspect = max(surface.grid.size) / edge
            k, waves, weights = response.of_map(round(min(aspect, 4.0), 2), degree)
        number = np.floor(PER_OCTAVE * np.log2(q / (2 * math.pi))).astype(int)
        bands = np.unique(number)
        index = np.searchsorted(bands, number)
        size = np.bincount(index, modes)
        mean_q = np.exp(np.bincount(index, modes * np.log(q)) / size)
        unit = 2 * math.pi / edge
        rows = [
            weights[inside].mean(axis=0)
            for band in bands
            if (inside := _inside(band, k * unit)).any()
            and 2 ** ((band + 1) / PER_OCTAVE) * edge <= response.MOST
        ]
        periods = mean_q / unit
        # Neighbouring bands share the waves over which tapers average, so these are counted in the
        # variance of one estimate, but not in the weights.
        wider = np.hypot(1.0, _WINDOW / (math.log(2) / PER_OCTAVE * periods))
        share = _TAPERED if line else 2 * _TAPERED**2
        return cls(
            name,
            surface,
            bands.astype(float),
            mean_q,
            np.bincount(index, modes * C) / size,
            np.maximum(size / share, 1.0),
            -0.5 * share / (size * wider),
            max(2 * max(_pixels(surface)), cut_off[0]),
            cut_off[1] if cut_off[0] > 2 * max(_pixels(surface)) else "two pixels",
            np.array(rows).reshape(-1, waves.size),
            waves * unit,
        )

    @property
    def line(self) -> bool:
        """Whether it is a line scan."""
        return is_line(self.surface)

    @property
    def edge(self) -> float:
        """The shorter edge (m) of a map, or the length of a line."""
        size = self.surface.grid.size
        return size[0] if self.line else min(size)

    @property
    def pixel(self) -> float:
        """The larger edge of a pixel (m)."""
        return max(_pixels(self.surface))

    @property
    def filled(self) -> float:
        """Fraction of interpolated pixels: they have no short waves."""
        return float(self.surface.provenance.get("undefined_fraction", 0.0))

    @property
    def variance(self) -> float:
        """Mean square height (m²)."""
        return float(np.var(self.surface.height))

    @property
    def trusted(self) -> tuple[float, float]:
        """Shortest and longest wave (m) that are trusted beside other scans."""
        return max(self.shortest, PIXELS * self.pixel), self.edge / PERIODS

    def inside(self, shortest: float, longest: float) -> Array:
        """Which bands have waves from `shortest` to `longest` (m)."""
        wave = 2 * math.pi / self.wave_number
        low, high = shortest * (1 - _ROUNDING), longest * (1 + _ROUNDING)
        return np.asarray((wave >= low) & (wave <= high))

    def cut(self, shortest: float, why: str) -> Self:
        """This spectrum without waves below `shortest` (m)."""
        return replace(self, shortest=shortest, why=why)


def is_line(surface: Surface) -> bool:
    """Whether `surface` is a line scan along x."""
    return surface.grid.nodes[1] == 1


def _pixels(surface: Surface) -> tuple[float, ...]:
    return surface.grid.spacing[:1] if is_line(surface) else surface.grid.spacing


def _inside(band: float, q: Array) -> Array:
    number = np.floor(PER_OCTAVE * np.log2(q / (2 * math.pi)))
    return np.asarray(number == band)


def _of_map(surface: Surface) -> tuple[Array, Array, Array]:
    C = power_spectral_density(surface).ravel()
    q = wave_numbers(surface.grid.nodes, surface.grid.spacing).ravel()
    least, most = 2 * math.pi / min(surface.grid.size), math.pi / max(surface.grid.spacing)
    kept = (q >= least * (1 - _ROUNDING)) & (q <= most * (1 + _ROUNDING))
    return q[kept], C[kept], np.ones(int(kept.sum()))


def _of_line(surface: Surface) -> tuple[Array, Array, Array]:
    from scipy.fft import rfft

    n, h = surface.grid.nodes[0], surface.grid.spacing[0]
    z = surface.height[:, 0] - surface.height.mean()
    power = np.mean([np.abs(rfft(z * taper)) ** 2 for taper in tapers(n)], axis=0) * h / n
    q = 2 * math.pi * np.fft.rfftfreq(n, h)[1:]
    return q.astype(np.float64), np.asarray(power[1:], np.float64), np.ones(q.size)
