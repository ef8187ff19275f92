"""The smoothest power spectrum through those of several scans."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from restitution.surfaces.joined.scan_spectrum import PER_OCTAVE, ScanSpectrum
from restitution.surfaces.surface import Array

# Prior standard deviation of the change of slope of ln C from one band to the next: a straight
# line is free, and the bend of a roll-off within an octave is three of it.
_BEND = 0.15
CALIBRATION = 0.03  # standard deviation of ln C of any scan
_ROUNDS = 8  # of the correction for the response of the scans
_ACROSS, _STEPS = 6.0, 121  # of the integral over waves across a line: up to 200 times shorter
_BELOW, _ABOVE = 2, 3  # octaves of the curve beyond all scans, for the response


class SpectrumCurve(NamedTuple):
    """ln C (C in m⁴) and its standard deviation at knots of ln q (q in rad/m)."""

    log_q: Array
    log_density: Array
    error: Array

    def at(self, q: Array) -> Array:
        return np.exp(interpolated(np.log(q), self.log_q, self.log_density))

    def profile(self, q: Array) -> Array:
        """C₁ (m³) of profiles: ∫ C dq_y/2π (Jacobs et al. 2017, eq. 8)."""
        return np.asarray(self._across(q)[1].sum(axis=1))

    def sensitivity(self, scan: ScanSpectrum, used: Array) -> Array:
        """Change of ln of `expected` with ln C at the knots, shape (used bands, knots)."""
        of = self._profile_weights if scan.line else self._map_weights
        rows = of(scan.wave_number)
        if long := len(scan.weights):
            parts = scan.weights * (self.profile if scan.line else self.at)(scan.waves)
            rows[:long] = parts / parts.sum(axis=1)[:, None] @ of(scan.waves)
        return np.asarray(rows[used])

    def _map_weights(self, q: Array) -> Array:
        return _weights(np.log(q), self.log_q)

    def _profile_weights(self, q: Array) -> Array:
        """Change of ln C₁ with ln C at the knots."""
        across, parts = self._across(q)
        shares = parts / parts.sum(axis=1)[:, None]
        weights = _weights(np.log(across.ravel()), self.log_q)
        return np.asarray(np.einsum("ij,ijk->ik", shares, weights.reshape(*across.shape, -1)))

    def _across(self, q: Array) -> tuple[Array, Array]:
        """Wave numbers q' = q cosh u, and their parts of C₁."""
        u = np.linspace(0.0, _ACROSS, _STEPS)
        across = q[:, None] * np.cosh(u)
        C = self.at(across.ravel()).reshape(across.shape)
        steps = np.full(u.size, u[1] - u[0])
        steps[[0, -1]] *= 0.5
        return across, C * across * steps / math.pi

    def expected(self, scan: ScanSpectrum) -> Array:
        """What the estimate of `scan` would be on average, in its bands."""
        density = self.profile if scan.line else self.at
        here = density(scan.wave_number)
        long = len(scan.weights)
        if not long:
            return here
        ratio = np.ones(here.size)
        ratio[:long] = scan.weights @ density(scan.waves) / here[:long]
        # Leakage of shorter waves falls with the square of the wave number.
        excess = (ratio[long - 1] - 1) * scan.wave_number[long - 1] ** 2
        ratio[long:] = 1 + excess / scan.wave_number[long:] ** 2
        return here * ratio


def interpolated(x: Array, at: Array, values: Array) -> Array:
    """Linear between the points, and a straight line through the first and last two beyond."""
    inner = np.interp(x, at, values)
    low, high = x < at[0], x > at[-1]
    first, last = ((values[k + 1] - values[k]) / (at[k + 1] - at[k]) for k in (0, -2))
    inner[low] = values[0] + first * (x[low] - at[0])
    inner[high] = values[-1] + last * (x[high] - at[-1])
    return inner


def used_bands(scan: ScanSpectrum, others: Sequence[ScanSpectrum]) -> Array:
    """Bands of `scan` that count: trusted ones, and those that no other scan trusts."""
    trusted = scan.inside(*scan.trusted)
    possible = scan.inside(scan.shortest, scan.edge)
    wave = 2 * math.pi / scan.wave_number
    known = np.zeros(wave.size, bool)
    for other in others:
        if other is not scan:
            low, high = other.trusted
            known |= (wave >= low) & (wave <= high)
    return np.asarray(trusted | (possible & ~known))


def fitted_curve(spectra: Sequence[ScanSpectrum]) -> SpectrumCurve:
    """The smoothest curve through the spectra, by penalised least squares of ln C."""
    first = min(float(scan.band.min()) for scan in spectra) - _BELOW * PER_OCTAVE
    last = max(float(scan.band.max()) for scan in spectra) + _ABOVE * PER_OCTAVE
    knots = np.arange(first, last + 2) * math.log(2) / PER_OCTAVE + math.log(2 * math.pi)
    bends = np.diff(np.eye(knots.size), 2, axis=0) / _BEND
    parts = [(scan, used_bands(scan, spectra)) for scan in spectra]
    values = [(np.log(scan.density) - scan.bias)[used] for scan, used in parts]
    modes = np.concatenate([scan.modes[used] for scan, used in parts])
    w = 1 / (_variance(modes) + CALIBRATION**2)
    # To begin with, C of a line scan is that of a power law with H = 0.8: C₁·4.6/q.
    wanted = [
        value - (np.log(scan.wave_number[used] / 4.6) if scan.line else 0.0)
        for value, (scan, used) in zip(values, parts, strict=True)
    ]
    rows = [_weights(np.log(scan.wave_number[used]), knots) for scan, used in parts]
    curve = SpectrumCurve(knots, *_solved(np.concatenate(rows), w, np.concatenate(wanted), bends))
    for _ in range(_ROUNDS):
        for k, (scan, used) in enumerate(parts):
            rows[k] = curve.sensitivity(scan, used)
            here = np.log(curve.expected(scan)[used])
            wanted[k] = values[k] - here + rows[k] @ curve.log_density
        solved = _solved(np.concatenate(rows), w, np.concatenate(wanted), bends)
        curve = SpectrumCurve(knots, *solved)
    return curve


def scatter_of_places(
    curve: SpectrumCurve, spectra: Sequence[ScanSpectrum], places: Sequence[int]
) -> Array:
    """Standard deviation of ln C at the knots between sets of scans of other places.

    Each of the `spectra` is the mean of a number of `places`.
    """
    parts = [(scan, used_bands(scan, spectra)) for scan in spectra]
    rows = np.concatenate([curve.sensitivity(scan, used) for scan, used in parts])
    modes = np.concatenate(
        [n * scan.modes[used] for n, (scan, used) in zip(places, parts, strict=True)]
    )
    bends = np.diff(np.eye(curve.log_q.size), 2, axis=0) / _BEND
    w = 1 / (_variance(modes) + CALIBRATION**2)
    weights = np.linalg.solve(rows.T @ (w[:, None] * rows) + bends.T @ bends, rows.T * w)
    return np.asarray(np.sqrt((weights**2) @ _variance(modes)))


def _variance(modes: Array) -> Array:
    return 1 / modes + 0.5 / modes**2  # of ln C


def _solved(A: Array, w: Array, wanted: Array, bends: Array) -> tuple[Array, Array]:
    """ln C at the knots, and its standard deviation."""
    covariance = np.linalg.inv(A.T @ (w[:, None] * A) + bends.T @ bends)
    return covariance @ (A.T @ (w * wanted)), np.sqrt(np.diag(covariance))


def _weights(x: Array, knots: Array) -> Array:
    """Weights of the knots in the curve at `x`, shape (x.size, knots.size)."""
    at = np.clip(np.searchsorted(knots, x) - 1, 0, knots.size - 2)
    share = (x - knots[at]) / (knots[at + 1] - knots[at])
    weights = np.zeros((x.size, knots.size))
    rows = np.arange(x.size)
    weights[rows, at] = 1 - share
    weights[rows, at + 1] = share
    return weights
