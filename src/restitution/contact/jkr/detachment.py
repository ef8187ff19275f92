"""Detachment criteria: which nodes of an adhesive contact in the JKR limit are released.

In the continuum, the contact edge recedes where the energy release rate G reaches the work of
adhesion w. On a grid, G is ½ |p| times the opening for each face between a node in contact and a
node outside:

    opening = (u₊ − 2u₀ + u₋) + (h₀ − 2h₋ + h₋₋)

with the displacement u and the gap h before it. Index 0 is the edge node, + the node outside, and −
and −− are the next two nodes inside. The second bracket corrects the linear extrapolation of u for
its curvature in the contact, −h. A gap between surfaces that never touched is not part of it.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from restitution.arguments import typed
from restitution.contact.state import State
from restitution.numerics.expressions import diffuse

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Nodes = tuple[NDArray[np.intp], NDArray[np.intp]]

_FACES = np.array([(1, 0), (-1, 0), (0, 1), (0, -1)])
_AROUND = np.array([(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1), (0, 0)])
# Number of steps in which G is averaged along the edge. Each step adds a variance of ⅔ cell², so
# the standard deviation of the weights after all steps is about five cells.
_SMOOTHING_STEPS = 32
# On a curved edge the computed G is too small. The relative error is this factor times the
# curvature (1/cell). On discs with radii of 5, 10 and 20 cells, the mean of G is 0.970, 0.984 and
# 0.992 times its exact value.
_CURVATURE_BIAS = 0.16
# Upper limit of the curvature (1/cell) that is used for this correction.
_LARGEST_CURVATURE = 0.35
# Limits of the distance (cells) between nodes that are released in the same step.
_RELEASE_RADIUS, _LARGEST_RADIUS = 3, 40
# An edge moves by whole nodes, so the energy release rate G scatters along an edge at rest. On
# coarse grids, the largest G of an edge is this factor times the mean. A node is therefore released
# only if G exceeds this factor times the work of adhesion.
_LARGEST_ON_COARSE_GRIDS = 1.04
# A grid counts as fine if the rim under tension is wider than _RESOLVED_RIM (cells). On a fine grid
# the mean of G is accurate, and the limit σ_c of the tension of a single node does not apply.
# Releases by this limit would begin at the kinks of an edge as soon as G reaches the work of
# adhesion w, and would roughen the edge. A patch is at rest if the mean of max(1 − sqrt(w/G), 0)
# over its edge nodes is below _AT_REST.
_RESOLVED_RIM, _AT_REST = 2.0, 0.002
# Smallest width (cells) of a strip along the edge whose nodes are all released together. If the
# strip is narrower, single nodes are released.
_LEAST_STRIP = 0.75
_SMOOTHED = 3  # standard deviation (cells) of the filter that smooths the outline of the contact

# Tensions that differ by less than this fraction of the largest tension count as equal, because
# the difference may be an error of the solve.
_TIE = 1e-3
_TINY = float(np.finfo(float).tiny)
_ACCURACY = 1e-3  # tolerance of solves between releases, as a fraction of the crack opening


class Detachment(ABC):
    """A criterion by which nodes are released, with the errors that it causes.

    Attributes:
        label: Name in case files and results.
        by_energy: Whether the criterion is the energy release rate of the edge (bool).
        pull_off_error: Relative error of the pull-off force of smooth spheres, times the nodes per
            pull-off radius (docs/adhesion.md).
        release_error: Error of the unloading work, as a fraction of the work of adhesion times the
            contact area, that smaller steps do not reduce.
        steps_of_tension: Smallest number of steps into which the pull-off displacement of a flat
            punch is divided. The punch has the contact area of the present state.
        small_error: If the error due to the steps is below this fraction of the surface energy, the
            error due to the grid is larger, and finer steps are useless.
        lateness: Error of the unloading work as a fraction of the work lost by late release. It is
            1.5 times the largest value in a comparison with ten times finer steps.
    """

    label: ClassVar[str]
    by_energy: ClassVar[bool]
    pull_off_error: ClassVar[float]
    release_error: ClassVar[float]
    steps_of_tension: ClassVar[int]
    small_error: ClassVar[float]
    lateness: ClassVar[float]

    def accuracy(self, opening: float, residual: float) -> float:
        """Tolerance of solves that only decide which nodes are released.

        `opening` is the relative residual of the crack opening.
        """
        return residual

    @abstractmethod
    def released(
        self, state: State, gap: Array, held: Mask, work_of_adhesion: float, limit: float
    ) -> Mask:
        """Select held nodes to release; `limit` is the tension (Pa) of a single node."""


@typed
@dataclass(frozen=True)
class CrackClosure(Detachment):
    """Release nodes where the energy release rate of the edge exceeds the work of adhesion.

    The relative error of G is 1e-3 on a straight edge. On a staircase, only its mean has this
    accuracy; it is averaged over about five cells along the edge.

    Source:
        E. F. Rybicki, M. F. Kanninen, Eng. Fract. Mech. 9 (1977) 931–938.
    """

    label = "crack-closure"
    by_energy = True
    pull_off_error = 0.25
    release_error = 0.015  # nodes detach at an energy release rate of 0.985 to 0.99 w
    steps_of_tension = 32
    small_error = 0.005
    lateness = 0.15

    def accuracy(self, opening: float, residual: float) -> float:
        accuracy = _ACCURACY * opening
        # A second solve at the end would hardly be more accurate.
        return residual if accuracy < 2 * residual else accuracy

    def released(
        self, state: State, gap: Array, held: Mask, work_of_adhesion: float, limit: float
    ) -> Mask:
        pressure = state.box_pressure
        edge = Edge.of(pressure, state.box_displacement, gap, held)
        return released_by_closure(edge, pressure, work_of_adhesion, limit)


@typed
@dataclass(frozen=True)
class PohrtPopov(Detachment):
    """Release nodes whose tension exceeds the limit of a single node on the half-space.

    Nodes on a straight edge hold until G = 1.8 w and nodes at a kink until G = 1.0 w, so the
    pull-off force is too large.

    Source:
        R. Pohrt, V. L. Popov, Facta Universitatis 13 (2015) 3–10.
    """

    label = "pohrt-popov"
    by_energy = False
    pull_off_error = 1.5
    release_error = 0.4  # nodes detach at 1.0 to 1.8 w, too large by 0 to 0.8 w
    steps_of_tension = 16
    small_error = 0.0
    lateness = 0.5  # nodes are released in larger jumps than by `CrackClosure`

    def released(
        self, state: State, gap: Array, held: Mask, work_of_adhesion: float, limit: float
    ) -> Mask:
        return released_beyond(limit, state.box_pressure, held)


def tension_limit(
    contact_modulus: float, work_of_adhesion: float, spacing: tuple[float, float]
) -> float:
    """Tension σ_c of a single node (Pa) beyond which releasing the node lowers the energy.

    For a cell with the edges hx and hy, σ_c² = 2πE*w hx hy/I, where I is the integral of 1/r over
    all pairs of points of the cell; for square cells, σ_c² = E*w/(0.473201 hx).
    """
    hx, hy = spacing
    twice = 2 * (hx**2 * hy * math.asinh(hy / hx) + hx * hy**2 * math.asinh(hx / hy)) + 2 / 3 * (
        hx**3 + hy**3 - math.hypot(hx, hy) ** 3
    )
    return math.sqrt(2 * math.pi * contact_modulus * work_of_adhesion * hx * hy / twice)


def released_beyond(limit: float, p: Array, touching: Mask) -> Mask:
    return touching & (p < -limit)


def released_by_closure(edge: Edge, p: Array, work_of_adhesion: float, limit: float) -> Mask:
    """Select nodes to release until the energy release rate falls to the work of adhesion.

    All nodes under tension in the strip by which the edge must recede are released. If the strip is
    narrow, single nodes under the largest tension are released instead. On coarse grids, nodes
    whose tension exceeds `limit` (Pa) are also released.
    """
    tensile = edge.touching & (p < 0)
    fine = bool(np.count_nonzero(tensile) > _RESOLVED_RIM * edge.G.size)
    released = np.zeros_like(tensile) if fine else released_beyond(limit, p, edge.touching)
    recession = _recession(edge, tensile, work_of_adhesion, fine)
    if not recession.any():
        return released
    if recession.max() > _LEAST_STRIP and (strip := edge.strip(recession) & tensile).any():
        return released | strip
    alone = _apart(edge.nodes, np.where(recession > 0, p[edge.nodes], 0.0), recession)
    released[edge.nodes[0][alone], edge.nodes[1][alone]] = True
    return released


def _recession(edge: Edge, tensile: Mask, work_of_adhesion: float, fine: bool) -> Array:
    """Distance (cells) by which each edge node must recede until G falls to the work of adhesion w.

    In a smooth contact (JKR), receding by the small distance d reduces sqrt(G) by the fraction
    d/(2t), where t is the width of the rim under tension. So d = 2t [1 − sqrt(w/G)].
    """
    largest = (1.0 if fine else _LARGEST_ON_COARSE_GRIDS) * work_of_adhesion
    moves = (largest < edge.G) & tensile[edge.nodes]
    excess = np.zeros(edge.G.size)
    excess[moves] = 1 - np.sqrt(largest / edge.G[moves])
    if fine:
        excess[edge.patch_mean(excess) < _AT_REST] = 0.0
    return 2 * edge.tensile_width(tensile) * excess if excess.any() else excess


@dataclass(frozen=True)
class Edge:
    """The edge nodes of a contact (indices), and the energy release rate G (J/m²) at each of them.

    G is averaged along the edge, with the neighbours and weights `diffusion`.
    """

    touching: Mask
    nodes: Nodes
    G: Array
    diffusion: tuple[NDArray[np.intp], Array]

    @classmethod
    def of(cls, p: Array, u: Array, h: Array, touching: Mask) -> Edge:
        # `np.pad` would take 25 times as long on small contacts.
        T = np.zeros((touching.shape[0] + 2, touching.shape[1] + 2), dtype=bool)
        T[1:-1, 1:-1] = touching
        surrounded = T[:-2, 1:-1] & T[2:, 1:-1] & T[1:-1, :-2] & T[1:-1, 2:]
        i, j = np.nonzero(touching & ~surrounded)
        side, node = np.nonzero(~T[i + 1 + _FACES[:, :1], j + 1 + _FACES[:, 1:]])
        # A step outwards adds a fixed number to the flat index of a node. The new index can be
        # outside the array only if the contact reaches the edge of the grid. Such a contact raises
        # an error later.
        row = touching.shape[1]
        here = i[node] * row + j[node]
        outwards = (_FACES @ np.array([row, 1]))[side]

        def values_at(values: Array, cells: int) -> Array:
            """For each face of an edge node, `values` at the node `cells` cells outwards."""
            return np.asarray(np.take(values, here + cells * outwards, mode="clip"))

        opening = values_at(u, 1) - 2 * values_at(u, 0) + values_at(u, -1)
        inside = np.take(touching, here - outwards, mode="clip")
        opening += inside * (values_at(h, 0) - 2 * values_at(h, -1) + values_at(h, -2))
        opened = np.bincount(node, weights=np.maximum(opening, 0.0), minlength=i.size)
        faces = np.bincount(node, minlength=i.size)
        sums = np.column_stack([-0.5 * p[i, j] * opened, faces])
        diffusion = _diffusion(i, j, touching.shape)
        diffuse(*diffusion, _SMOOTHING_STEPS, sums)
        bias = 1 - _CURVATURE_BIAS * _curvature(touching, (i, j), faces)
        return cls(touching, (i, j), sums[:, 0] / (sums[:, 1] * bias), diffusion)

    def tensile_width(self, tensile: Mask) -> Array:
        """Width (cells) of the rim of the contact under tension, averaged along the edge."""
        under = self._nearest[self.touching & tensile]
        return self._averaged(np.bincount(under, minlength=self.G.size))

    def strip(self, width: Array) -> Mask:
        """Contact nodes at most the `width` (cells) of the nearest edge node inside the outline."""
        return self.touching & (self._depth <= width[self._nearest])

    def patch_mean(self, values: Array) -> Array:
        patch = _patch_numbers(self.touching, self.nodes)
        means = np.bincount(patch, weights=values) / np.maximum(np.bincount(patch), 1)
        return np.asarray(means[patch])

    def _averaged(self, values: ArrayLike) -> Array:
        sums = np.column_stack([values, np.ones(self.G.size)])
        diffuse(*self.diffusion, _SMOOTHING_STEPS, sums)
        return np.asarray(sums[:, 0] / sums[:, 1])

    @cached_property
    def _depth(self) -> Array:
        """Depth (cells) of each node inside the smoothed outline of the contact.

        The outline is placed so that the mean depth of the edge nodes is half a cell.
        """
        from scipy.ndimage import distance_transform_edt, gaussian_filter

        inside = np.pad(self.touching, _SMOOTHED)
        signed = distance_transform_edt(inside) - distance_transform_edt(~inside)
        signed -= 0.5 * np.sign(signed)
        smooth = gaussian_filter(signed, _SMOOTHED, truncate=2.0)
        smooth = smooth[_SMOOTHED:-_SMOOTHED, _SMOOTHED:-_SMOOTHED]
        return np.asarray(smooth - (self._averaged(smooth[self.nodes]) - 0.5)[self._nearest])

    @cached_property
    def _nearest(self) -> NDArray[np.intp]:
        from scipy.ndimage import distance_transform_edt

        off_edge = np.ones(self.touching.shape, dtype=bool)
        off_edge[self.nodes] = False
        number = np.zeros(off_edge.shape, dtype=np.intp)
        number[self.nodes] = np.arange(self.G.size)
        nearest = distance_transform_edt(off_edge, return_distances=False, return_indices=True)
        return np.asarray(number[tuple(nearest)])


def _curvature(touching: Mask, nodes: Nodes, faces: NDArray[np.intp]) -> Array:
    """For each edge node, the mean curvature 2π/perimeter (1/cell) of the outline of its patch.

    The length of a smooth outline is on average π/4 times that of its staircase.
    """
    patch = _patch_numbers(touching, nodes)
    total = np.bincount(patch, weights=faces)[patch]
    return np.minimum(8 / total, _LARGEST_CURVATURE)


def _patch_numbers(touching: Mask, nodes: Nodes) -> NDArray[np.intp]:
    """For each edge node, the index of its patch; cells connect by sides or corners."""
    from scipy.ndimage import label

    return np.asarray(label(touching, structure=np.ones((3, 3)))[0][nodes])


def _apart(nodes: Nodes, pressure: Array, recession: Array) -> NDArray[np.intp]:
    """Positions in `nodes` of edge nodes to release singly, under the largest tension first.

    Where the edge must recede by a fraction r of a cell, one of every 1/r nodes is released: a
    release unloads the neighbours. Ties are broken by index, so that rounding does not decide.
    """
    i, j = nodes
    rank = np.round(pressure / (_TIE * max(-float(pressure.min(initial=0.0)), _TINY)))
    left = np.argsort(rank, kind="stable")
    left = left[rank[left] < 0]
    radius = np.clip(0.5 / np.maximum(recession, _TINY), _RELEASE_RADIUS, _LARGEST_RADIUS)
    chosen = []
    while left.size:
        first = left[0]
        chosen.append(first)
        away = np.maximum(np.abs(i[left] - i[first]), np.abs(j[left] - j[first]))
        left = left[away > radius[first]]
    return np.array(chosen, dtype=np.intp)


def _diffusion(
    i: NDArray[np.intp], j: NDArray[np.intp], shape: tuple[int, ...]
) -> tuple[NDArray[np.intp], Array]:
    """Neighbours of each edge node and their weights in a diffusion step, shape (nodes, 9).

    The weights (Metropolis) conserve the sum of the values over all edge nodes. A missing neighbour
    is replaced by the node itself.
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
