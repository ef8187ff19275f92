"""Detachment criteria: which nodes of an adhesive contact are released.

Adhesion has no range here (the JKR limit): nodes in contact can carry tension, and other nodes do
not attract. In the continuum, the contact edge recedes where the energy release rate G reaches the
work of adhesion w. On a grid the edge is a staircase of nodes. Two local criteria are available:

`pohrt-popov`: a node is released if its tension exceeds the limit σ_c of a single node on the
half-space (Pohrt and Popov 2015, Facta Universitatis 13, 3–10). The criterion is simple and
independent of the order of release. However, nodes on a straight edge hold until G = 1.8 w and
nodes at a kink until G = 1.0 w. The relative error of the pull-off force is therefore +1.5 h/a.

`crack-closure`: the contact edge is a crack, and G is the work of closing the crack by one cell
(Rybicki and Kanninen 1977, Eng. Fract. Mech. 9, 931–938). For each face between a node in contact
and a node outside, this work per area is ½ |p| times the opening. The relative error of G is 1e-3
on a straight edge; on a staircase, the mean of G over the faces has this accuracy. G is therefore
averaged along the edge over about four cells, but never across to another patch. The opening is the
separation of the surfaces beyond the smooth continuation of their contact:

    opening = (u₊ − 2u₀ + u₋) + (h₀ − 2h₋ + h₋₋),

where u is the elastic displacement and h the gap before this displacement. Index 0 is the edge
node, + the node outside, and − and −− the nodes inside. The second bracket continues the curvature
of the surfaces in the contact. The initial gap outside, where the surfaces never touched, does not
count as opening.

For rectangular cells σ_c² = 2πE*w hx hy/I, where I is the double integral of 1/r over the cell; for
square cells σ_c² = E*w/(κh), κ = (2/3π)[1 − √2 + 3 ln(1 + √2)] = 0.473201.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.diffusion import diffuse

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Detachment = Literal["crack-closure", "pohrt-popov"]

_FACES = np.array([(1, 0), (-1, 0), (0, 1), (0, -1)])
_AROUND = np.array([(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1), (0, 0)])
# Steps of averaging G along the edge. Each step adds a variance of ⅔ cell², so the standard
# deviation of the weights is about five cells in all.
_SMOOTHING_STEPS = 32
# After a solve, at most one of the edge nodes within this distance (cells) is released.
_RELEASE_RADIUS = 3
# Tensions that differ by less than this fraction of the largest tension count as equal, because
# the difference may be an error of the solve.
_TIE = 1e-3
_TINY = float(np.finfo(float).tiny)


def tension_limit(
    contact_modulus: float, work_of_adhesion: float, spacing: tuple[float, float]
) -> float:
    """Tension σ_c of a single node (Pa) beyond which releasing the node lowers the energy."""
    hx, hy = spacing
    twice = 2 * (hx**2 * hy * math.asinh(hy / hx) + hx * hy**2 * math.asinh(hx / hy)) + 2 / 3 * (
        hx**3 + hy**3 - math.hypot(hx, hy) ** 3
    )
    return math.sqrt(2 * math.pi * contact_modulus * work_of_adhesion * hx * hy / twice)


class Criterion(Protocol):
    """Selects the nodes in contact that are released next."""

    def releases(self, p: Array, u: Array, h: Array, touching: Mask) -> Mask:
        """Select nodes from pressure p, displacement u and the gap h before displacement."""


@dataclass(frozen=True)
class TensionLimit:
    """The criterion `pohrt-popov`."""

    limit: float

    def releases(self, p: Array, u: Array, h: Array, touching: Mask) -> Mask:
        """Select all nodes whose tension exceeds the limit."""
        return touching & (p < -self.limit)


@dataclass(frozen=True)
class CrackClosure:
    """The criterion `crack-closure`; nodes beyond the tension limit are released as well."""

    work_of_adhesion: float
    limit: float

    def releases(self, p: Array, u: Array, h: Array, touching: Mask) -> Mask:
        """Select the node of largest tension in each part of the edge along which G ≥ w."""
        from scipy.ndimage import minimum_filter

        edge, G = energy_release_rate(p, u, h, touching)
        # The release of a node unloads its neighbours, so releasing several neighbours together
        # would release too many. Ties are broken by index, so that rounding does not decide.
        ready = np.where((self.work_of_adhesion <= G) & (p[edge] < 0), p[edge], 0.0)
        ready = np.round(ready / (_TIE * max(-float(ready.min(initial=0.0)), _TINY)))
        ready = np.where(ready < 0, ready + 0.5 * np.arange(ready.size) / ready.size, 0.0)
        tension = np.zeros_like(p)
        tension[edge] = ready
        largest = minimum_filter(tension, size=2 * _RELEASE_RADIUS + 1, mode="constant")
        released = touching & (p < -self.limit)
        released[edge] |= (ready < 0) & (ready == largest[edge])
        return released


def criterion(
    detachment: Detachment,
    contact_modulus: float,
    work_of_adhesion: float,
    spacing: tuple[float, float],
) -> Criterion:
    """Make the criterion named `detachment`."""
    limit = tension_limit(contact_modulus, work_of_adhesion, spacing)
    if detachment == "pohrt-popov":
        return TensionLimit(limit)
    return CrackClosure(work_of_adhesion, limit)


def energy_release_rate(
    p: Array, u: Array, h: Array, touching: Mask
) -> tuple[tuple[NDArray[np.intp], NDArray[np.intp]], Array]:
    """Return the indices of the edge nodes of the contact and G (J/m²), averaged along the edge."""
    T = np.zeros((touching.shape[0] + 2, touching.shape[1] + 2), dtype=bool)
    T[1:-1, 1:-1] = touching
    surrounded = T[:-2, 1:-1] & T[2:, 1:-1] & T[1:-1, :-2] & T[1:-1, 2:]
    i, j = np.nonzero(touching & ~surrounded)
    side, node = np.nonzero(~T[i + 1 + _FACES[:, :1], j + 1 + _FACES[:, 1:]])
    # A step outwards adds one number to a flat index. An index can leave the array only if the
    # contact is at the edge of the grid, and this raises an error later.
    row = touching.shape[1]
    here = i[node] * row + j[node]
    outwards = (_FACES @ np.array([row, 1]))[side]

    def values_at(values: Array, cells: int) -> Array:
        """Return `values` on the normal of each face, `cells` cells outwards from its edge node.

        A face is a side of an edge node without contact beyond it. Negative `cells` lie inwards.
        """
        found: Array = np.take(values, here + cells * outwards, mode="clip")
        return found

    opening = values_at(u, 1) - 2 * values_at(u, 0) + values_at(u, -1)
    inside = np.take(touching, here - outwards, mode="clip")
    opening += inside * (values_at(h, 0) - 2 * values_at(h, -1) + values_at(h, -2))
    opened = np.bincount(node, weights=np.maximum(opening, 0.0), minlength=i.size)
    faces = np.bincount(node, minlength=i.size)
    sums = np.column_stack([-0.5 * p[i, j] * opened, faces])
    diffuse(*_diffusion(i, j, touching.shape), _SMOOTHING_STEPS, sums)
    return (i, j), sums[:, 0] / sums[:, 1]


def _diffusion(
    i: NDArray[np.intp], j: NDArray[np.intp], shape: tuple[int, ...]
) -> tuple[NDArray[np.intp], Array]:
    """Return the neighbours of each edge node and their weights in a diffusion step.

    Both arrays have shape (nodes, 9). The step diffuses along the edge and conserves the sum
    (Metropolis weights). A missing neighbour is replaced by the node itself.
    """
    here = np.arange(i.size)
    number = np.full((shape[0] + 2, shape[1] + 2), -1)
    number[i + 1, j + 1] = here
    # Each row holds the eight neighbours of a node and, last, the node itself.
    neighbours = number[i[:, None] + 1 + _AROUND[:, 0], j[:, None] + 1 + _AROUND[:, 1]]
    joined = neighbours >= 0
    neighbours = np.where(joined, neighbours, here[:, None])
    degree = joined.sum(axis=1) - 1
    weight = joined / (1 + np.maximum(degree[:, None], degree[neighbours]))
    weight[:, -1] = 1.0 - weight[:, :-1].sum(axis=1)
    return neighbours, weight
