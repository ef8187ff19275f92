"""Which nodes of an adhesive contact let go: two local criteria.

Adhesion has no range here (the JKR limit): nodes in contact carry tension, others do not pull. In
the continuum the edge of the contact recedes where the energy released per area, G, reaches the
work of adhesion w. On a grid the edge is a staircase of nodes, and there are two ways to ask:

`pohrt-popov`: a node lets go when its tension passes the limit at which a single node, alone on the
half-space, would (Pohrt and Popov 2015, Facta Universitatis 13, 3–10). Simple, and independent of
the order of release; but nodes on a straight edge hold on until G is 1.8 w, those at a kink until
1.0 w, so that pull-off is overestimated by 1.5 h/a.

`crack-closure`: the edge is a crack, and G is the work of closing it by one cell (Rybicki and
Kanninen 1977, Eng. Fract. Mech. 9, 931–938): ½ |p| times the opening, for each face between a node
in contact and one outside. On a straight edge this is G to 1e-3, on a staircase its mean over the
faces is. So G is averaged along the edge, over about four cells, and never across to another patch.
The opening is what the surfaces have moved apart beyond the smooth continuation of their contact:

    opening = (u₊ − 2u₀ + u₋) + (h₀ − 2h₋ + h₋₋),

u the elastic displacement, h the gap before it, 0 the node at the edge, + the one outside, − those
inside. The second bracket is the curvature of the surfaces under the contact, continued; whatever
shape they have outside, where they never touched, is no opening.

With rectangular cells σ_c² = 2πE*w hx hy/I, with I the integral of 1/r over the cell twice; for
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
_SMOOTHING_STEPS = 32  # each spreads by ⅔ cell² along an edge: some five cells in all
_RELEASE_RADIUS = 3  # cells around a released node that wait for the next solve
_ALIKE = 1e-3  # of the largest tension: a smaller difference is what a solve leaves
_TINY = float(np.finfo(float).tiny)


def tension_limit(
    contact_modulus: float, work_of_adhesion: float, spacing: tuple[float, float]
) -> float:
    """Largest tension σ_c of a node alone, Pa: it lets go when that gains energy."""
    hx, hy = spacing
    twice = 2 * (hx**2 * hy * math.asinh(hy / hx) + hx * hy**2 * math.asinh(hx / hy)) + 2 / 3 * (
        hx**3 + hy**3 - math.hypot(hx, hy) ** 3
    )
    return math.sqrt(2 * math.pi * contact_modulus * work_of_adhesion * hx * hy / twice)


class Criterion(Protocol):
    """Which of the nodes in contact let go now."""

    def releases(self, p: Array, u: Array, h: Array, touching: Mask) -> Mask:
        """Nodes to release at pressure p, displacement u and gap h before it; all of one shape."""


@dataclass(frozen=True)
class TensionLimit:
    """`pohrt-popov`."""

    limit: float

    def releases(self, p: Array, u: Array, h: Array, touching: Mask) -> Mask:
        """All nodes beyond the limit."""
        return touching & (p < -self.limit)


@dataclass(frozen=True)
class CrackClosure:
    """`crack-closure`; single nodes beyond the tension limit let go, too."""

    work_of_adhesion: float
    limit: float

    def releases(self, p: Array, u: Array, h: Array, touching: Mask) -> Mask:
        """The tensest node of each stretch of the edge along which G has reached w."""
        from scipy.ndimage import minimum_filter

        edge, G = energy_release_rate(p, u, h, touching)
        # Releasing neighbours at once would overshoot: each relieves the others. Of nodes that are
        # alike the first goes, so that the last digits decide nothing.
        ready = np.where((self.work_of_adhesion <= G) & (p[edge] < 0), p[edge], 0.0)
        ready = np.round(ready / (_ALIKE * max(-float(ready.min(initial=0.0)), _TINY)))
        ready = np.where(ready < 0, ready + 0.5 * np.arange(ready.size) / ready.size, 0.0)
        tension = np.zeros_like(p)
        tension[edge] = ready
        tensest = minimum_filter(tension, size=2 * _RELEASE_RADIUS + 1, mode="constant")
        released = touching & (p < -self.limit)
        released[edge] |= (ready < 0) & (ready == tensest[edge])
        return released


def criterion(
    detachment: Detachment,
    contact_modulus: float,
    work_of_adhesion: float,
    spacing: tuple[float, float],
) -> Criterion:
    """The criterion of that name."""
    limit = tension_limit(contact_modulus, work_of_adhesion, spacing)
    if detachment == "pohrt-popov":
        return TensionLimit(limit)
    return CrackClosure(work_of_adhesion, limit)


def energy_release_rate(
    p: Array, u: Array, h: Array, touching: Mask
) -> tuple[tuple[NDArray[np.intp], NDArray[np.intp]], Array]:
    """Nodes at the edge of the contact (indices) and G there, J/m², averaged along the edge."""
    T = np.zeros((touching.shape[0] + 2, touching.shape[1] + 2), dtype=bool)
    T[1:-1, 1:-1] = touching
    surrounded = T[:-2, 1:-1] & T[2:, 1:-1] & T[1:-1, :-2] & T[1:-1, 2:]
    i, j = np.nonzero(touching & ~surrounded)
    side, node = np.nonzero(~T[i + 1 + _FACES[:, :1], j + 1 + _FACES[:, 1:]])
    # Flat indices: a step outwards is one number. Where one leaves the array the contact is at the
    # rim of the grid, which is refused.
    row = touching.shape[1]
    here = i[node] * row + j[node]
    outwards = (_FACES @ np.array([row, 1]))[side]

    def taken(values: Array, cells: int) -> Array:
        """The values so many cells outwards of each face."""
        found: Array = np.take(values, here + cells * outwards, mode="clip")
        return found

    opening = taken(u, 1) - 2 * taken(u, 0) + taken(u, -1)
    inside = np.take(touching, here - outwards, mode="clip")
    opening += inside * (taken(h, 0) - 2 * taken(h, -1) + taken(h, -2))
    opened = np.bincount(node, weights=np.maximum(opening, 0.0), minlength=i.size)
    faces = np.bincount(node, minlength=i.size)
    sums = np.column_stack([-0.5 * p[i, j] * opened, faces])
    diffuse(*_diffusion(i, j, touching.shape), _SMOOTHING_STEPS, sums)
    return (i, j), sums[:, 0] / sums[:, 1]


def _diffusion(
    i: NDArray[np.intp], j: NDArray[np.intp], shape: tuple[int, ...]
) -> tuple[NDArray[np.intp], Array]:
    """Neighbours of each node and their weights, of shape (nodes, 9), in a step of diffusion.

    It goes along the edge and conserves the sum (Metropolis). Who has fewer is its own neighbour.
    """
    here = np.arange(i.size)
    number = np.full((shape[0] + 2, shape[1] + 2), -1)
    number[i + 1, j + 1] = here
    # One row for each node: its eight neighbours, and last itself.
    neighbours = number[i[:, None] + 1 + _AROUND[:, 0], j[:, None] + 1 + _AROUND[:, 1]]
    joined = neighbours >= 0
    neighbours = np.where(joined, neighbours, here[:, None])
    degree = joined.sum(axis=1) - 1
    weight = joined / (1 + np.maximum(degree[:, None], degree[neighbours]))
    weight[:, -1] = 1.0 - weight[:, :-1].sum(axis=1)
    return neighbours, weight
