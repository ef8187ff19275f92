"""Array expressions whose compiled loops have the same names (see `kernels`)."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.box import NOWHERE, bounding_box
from restitution.numerics.kernels import use_loop

Array = NDArray[Any]  # double or single precision
Triple = tuple[Array, Array, Array]


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
def descend(
    rest: Array,
    d: Array,
    work: tuple[Array, Array, Array, Array, Array],
    k: Array,
    product: Callable[[], object],
    limits: tuple[float, float, float, int],
    zero_mean: bool,
) -> tuple[bool, bool]:
    """Solve (K⁻¹ + k) x = b by conjugate gradients with K as preconditioner (Steihaug 1983).

    `rest` is b and becomes the residual; `d` is K b. `work` are x and S x, with S = K⁻¹, both 0 and
    overwritten, S d = b, and two more arrays: `product` writes K `rest` to the first. `limits` are
    the bᵀK b to reach, the radius of the trust region in the norm (xᵀS x)^½, infinite if there is
    none, the largest change along a direction of negative curvature in that case, and the number of
    iterations. With `zero_mean`, K ignores means. Return whether a limit ended the search, and
    whether a direction had negative curvature.
    """
    x, Sx, Sd, z, Hd = work
    enough, radius, length, most = limits
    inside = math.isinf(radius)  # no trust region yet
    xSd = xSx = dSd = 0.0
    rz = dot(rest, d)
    for _ in range(most):
        np.multiply(k, d, out=Hd)
        Hd += Sd
        dHd = dot(d, Hd)
        if not inside:
            dSd, xSd = dot(d, Sd), dot(x, Sd)
        bent = dHd <= 0
        a = math.inf if bent else rz / dHd
        along = 0.0 if bent or inside else xSx + a * (2 * xSd + a * dSd)
        at_edge = bent or along >= radius * radius
        if at_edge and inside:
            a = length / max_magnitude(d)
        elif at_edge:
            a = (math.sqrt(max(xSd * xSd + dSd * (radius**2 - xSx), 0.0)) - xSd) / dSd
        xSx = along
        x += a * d
        Sx += a * Sd
        rest -= a * Hd
        if at_edge:
            return True, bent
        if zero_mean:  # means would only increase rounding errors
            rest -= rest.mean()
        product()
        before, rz = rz, dot(rest, z)
        if rz <= enough:
            break
        d *= rz / before
        d += z
        Sd *= rz / before
        Sd += rest
    return False, False


@use_loop
def add_and_compare(p: Array, slope: Array, k: Array, least: float, out: Array) -> float:
    """Write p + slope to `out`; return its largest |p + slope|/(|k| + least), NaN for any NaN."""
    np.add(p, slope, out=out)
    return float(np.max(np.abs(out) / (np.abs(k) + least)))


@use_loop
def ends_above(values: Array, least: float) -> tuple[int, int, int, int]:
    """Ends of the rows and columns with a magnitude above `least`, as of two slices; 0 if none."""
    box = bounding_box(np.abs(values) > least) or NOWHERE
    return box[0].start, box[0].stop, box[1].start, box[1].stop


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
def lennard_jones_totals(
    gap: Array, shift: float, least: float, law: tuple[float, float]
) -> tuple[float, float]:
    """Sums of the energy and the slope of `lennard_jones` at the gap + `shift`, at least `least`.

    `law` is (w, z₀).
    """
    energy, slope, unused = (np.empty(gap.shape) for _ in range(3))
    lennard_jones(np.maximum(gap + shift, least), *law, energy, slope, unused)
    return float(energy.sum()), float(slope.sum())


@use_loop
def continued_lennard_jones(
    base: Array,
    u: Array,
    ends: Triple,
    law: tuple[float, float],
    energy: Array,
    slope: Array,
    stiffness: Array,
) -> None:
    """Write `lennard_jones` of the `law` (w, z₀) at the gap `base` + `u`.

    `ends` has smallest gaps, and pressures and stiffnesses with which the law continues there.
    """
    gap = base + u
    inside = np.maximum(gap, ends[0])
    lennard_jones(inside, *law, energy, slope, stiffness)
    continue_below(gap - inside, ends, energy, slope, stiffness)


def continue_below(
    below: Array, ends: Triple, energy: Array, slope: Array, stiffness: Array
) -> None:
    """Continue a law linearly at the smallest gaps of `ends`; `below` is the gap minus these."""
    _, bound, stiff = ends
    energy += below * (0.5 * stiff * below - bound)
    slope += stiff * below
    np.copyto(stiffness, stiff, where=below < 0)


@use_loop
def lennard_jones_chords(
    base: Array,
    u: Array,
    known: Triple,
    ends: tuple[Array, Array],
    law: tuple[float, float],
    least_way: float,
    out: Array,
) -> None:
    """Write the slopes of chords from the gap `base` + `u` to the gap at the pressure p.

    `known` has p, and φ′ and φ″ at the gap; `law` is (w, z₀). `ends` has pressures, above which the
    gap falls by the softness, also in `ends`, times the rest. φ″ stays where p ≤ 0 and the gap is
    above z₀, where the chord is not longer than `least_way`, and where it falls.
    """
    p, (bound, softness), (w, z0) = known[0], ends, law
    gap, wanted = base + u, np.maximum(p, 0.0)
    inside = np.minimum(wanted, bound)
    goal = z0 / np.cbrt(cubic_root(inside * (3 * z0 / (8 * w)))) - (wanted - inside) * softness
    repels = (p > 0) | (gap < z0)
    out[...] = chords_over(np.where(repels, gap - goal, 0.0), known, least_way)


def chords_over(way: Array, known: Triple, least_way: float) -> Array:
    """Slopes over the distances `way`; φ″ stays where these are short, and where the slope falls.

    `known` is that of `lennard_jones_chords`.
    """
    p, slope, stiffness = known
    chord = np.divide(p + slope, way, out=np.zeros_like(way), where=np.abs(way) > least_way)
    return np.where(chord > 0, chord, stiffness)


def cubic_root(c: Array) -> Array:
    """The largest root y of y³ − y = c, for c ≥ 0."""
    t = 1.5 * math.sqrt(3) * c
    inside = np.cos(np.arccos(np.minimum(t, 1.0)) / 3)
    beyond = np.cosh(np.arccosh(np.maximum(t, 1.0)) / 3)
    return np.asarray(2 / math.sqrt(3) * np.where(t < 1, inside, beyond))


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
