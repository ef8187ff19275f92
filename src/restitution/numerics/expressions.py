"""Array expressions whose compiled loops have the same names (see `kernels`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[Any]  # double or single precision


@use_loop
def max_magnitude(values: Array) -> float:
    """Largest magnitude; NaN if a value is NaN."""
    return float(np.maximum(values.max(), -values.min()))


@use_loop
def dot(a: Array, b: Array) -> float:
    """Σ a b, summed in double precision."""
    # np.vdot would use threads, whose synchronisation takes longer than the products themselves.
    return float(np.einsum("ij,ij->", a, b, dtype=np.float64))


@use_loop
def add_curvature(d: Array, Sd: Array, k: Array, out: Array) -> float:
    """Write Sd + k d into `out`; return Σ d `out`."""
    np.multiply(k, d, out=out)
    out += Sd
    return dot(d, out)


@use_loop
def advance(x: Array, Sx: Array, rest: Array, d: Array, Sd: Array, Hd: Array, a: float) -> None:
    """Add a d to x, a Sd to Sx, and −a Hd to the residual `rest`."""
    x += a * d
    Sx += a * Sd
    rest -= a * Hd


@use_loop
def redirect(d: Array, Sd: Array, z: Array, rest: Array, b: float) -> None:
    """Replace d by b d + z, and Sd by b Sd + `rest`."""
    d *= b
    d += z
    Sd *= b
    Sd += rest


@use_loop
def largest_ratio(r: Array, k: Array, least: float) -> float:
    """Largest |r|/(|k| + least); NaN if a value is NaN."""
    return float(np.max(np.abs(r) / (np.abs(k) + least)))


@use_loop
def lennard_jones(
    gap: Array, w: float, z0: float, energy: Array, slope: Array, stiffness: Array
) -> None:
    """Write the energy of the law of `theory.LennardJones` and its two derivatives at `gap`."""
    x = z0 / gap
    x2 = x * x
    x4 = x2 * x2
    x6 = x4 * x2
    energy[...] = (-w / 3) * x2 * (4 - x6)
    slope[...] = (8 * w / (3 * z0)) * (x2 * x) * (1 - x6)
    stiffness[...] = (8 * w / z0**2) * x4 * (3 * x6 - 1)


@use_loop
def diffuse(neighbours: NDArray[np.intp], weights: Array, steps: int, values: Array) -> None:
    """Replace the two values at each node by weighted sums over its neighbours, `steps` times.

    `neighbours` (node indices) and `weights` have shape (nodes, neighbours), `values` (nodes, 2).
    An index above nodes − 1 raises `IndexError`.
    """
    for _ in range(steps):
        values[...] = np.einsum("ij,ijk->ik", weights, values[neighbours])


@use_loop
def multipoles(x: Array, y: Array, moments: Array, out: Array) -> None:
    """Write Σ_kl moments[k, l] c^l / r^(2k + 1) into `out`, with c = x²/r² and r² = x² + y².

    `x` has shape (nx, 1), `y` (1, ny), `moments` (3, 3) and `out` (nx, ny).
    """
    s = 1.0 / (x * x + y * y)
    c = x * x * s
    out[...] = 0.0
    for row in moments[::-1]:
        out *= s
        out += (row[2] * c + row[1]) * c + row[0]
    out *= np.sqrt(s)
