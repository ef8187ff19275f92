"""Contact whose waves below the grid repel by a law: one solve, and the state that it returns.

At the indentation δ, the displacement u minimises ½ uᵀK⁻¹u + Σ φ(g) with g = g₁ + h₀ + u_p − δ + u,
where g₁ is the gap at first touch of the patches, h₀ the initial gap of the long waves and u_p the
plastic displacement of the bulk. φ is the work of loading a patch to its gap g. Where a patch was
deeper before, φ is the elastic energy that it returns, proportional to (g_s − g)^(m+1), with the
gap of separation g_s; force and energy of the deepest state determine m. The energy is convex.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import MAX_ITERATIONS, candidate_box, operators_of
from restitution.contact.influence import half_space
from restitution.contact.patch.repulsion import RepulsionTable
from restitution.contact.state import Array, State
from restitution.errors import NotConvergedError
from restitution.numerics.box import NOWHERE, Box, shape_of
from restitution.numerics.convolution.device import CPU, on_device
from restitution.numerics.quadratic.multilevel import solve_multilevel
from restitution.numerics.read_only import freeze
from restitution.numerics.truncated_newton import minimise_locally

if TYPE_CHECKING:
    from restitution.contact.patch.law import PatchRepulsion

_TOLERANCE, _LEAST_TOLERANCE = 10.0, 1e-8
# A node is in contact if its pressure is at least this fraction of the largest pressure.
_TOUCHING = 0.01
# The first guess of a step is solved to this tolerance, at this fraction of the way of the patches
# to their separation.
_ROUGH, _UNLOADED = 1e-3, 0.2
_LINEAR, _STIFFEST = 1.0, 30.0  # limits of m


@dataclass(frozen=True, eq=False, repr=False)
class PatchState(State):
    """A contact without attraction whose waves below the grid follow a law.

    Attributes:
        least_gap: Smallest gap of the patch at each node so far (m), shape `grid.nodes`; inf where
            no patch has touched.
        patch_energy: Elastic energy of the waves below the grid (J).
        patch_work: Work that their yielding has dissipated (J), part of `plastic_work`.
        real_area: Real contact area (m²), that of the patches.
        patch_approach: Mean approach of the patches since their first touch (m), weighted with the
            pressure.
    """

    least_gap: Array | None = None
    patch_energy: float = 0.0
    patch_work: float = 0.0
    real_area: float = 0.0
    patch_approach: float = 0.0

    @property
    def stored_energy(self) -> float:
        return super().stored_energy + self.patch_energy

    @property
    def contact_area(self) -> float:
        return self.real_area

    @property
    def separation_indentation(self) -> float:
        if self.least_gap is None or not np.isfinite(self.least_gap).any():
            return super().separation_indentation
        table = cast("PatchRepulsion", self.contact.adhesion).table
        touched = np.isfinite(self.least_gap)
        branch = Branch.of(table, self.least_gap[touched])
        flattened = table.touch - branch.least - branch.length
        opened = self.contact.gap + self.plastic_displacement
        opened[touched] += np.maximum(flattened, 0.0)
        return float(opened.min())

    @property
    def box_touching(self) -> NDArray[np.bool_]:
        largest = float(self.box_pressure.max(initial=0.0))
        return np.asarray(self.box_pressure > _TOUCHING * largest)


@dataclass(frozen=True, eq=False)
class Branch:
    """Unloading of the patches whose smallest gap (m) was `least`; arrays of one shape.

    `pressure` (Pa), the elastic `energy` and the energy `lost` (J/m²) are those at this gap, and
    `range` (m) the distance to the gap where the pressure of the mean patch is zero.
    """

    least: Array
    pressure: Array
    energy: Array
    lost: Array
    range: Array

    @classmethod
    def of(cls, table: RepulsionTable, least: Array) -> Branch:
        work, pressure, _ = table.work(least)
        lost = work * table.of_gap(table.lost, least)
        return cls(least, pressure, work - lost, lost, table.of_gap(table.range, least))

    @cached_property
    def power(self) -> Array:
        """The exponent m of the pressure."""
        energy = np.maximum(self.energy, 1e-300)
        return np.clip(self.pressure * self.range / energy - 1, _LINEAR, _STIFFEST)

    @cached_property
    def length(self) -> Array:
        """Distance (m) to the gap of separation, at which all elastic energy is returned."""
        return (self.power + 1) * self.energy / np.maximum(self.pressure, 1e-300)

    def at(self, gap: Array) -> tuple[Array, Array, Array]:
        """Energy (J/m²), pressure (Pa) and its derivative (Pa/m), where `gap` is above `least`."""
        m, length = self.power, self.length
        left = np.clip(1 - (gap - self.least) / np.maximum(length, 1e-300), 0.0, 1.0)
        p = self.pressure * left**m
        slope = -self.pressure * m / np.maximum(length, 1e-300) * left ** (m - 1)
        return self.energy * left ** (m + 1), p, slope


class PatchNodes:
    """The law of the nodes of a box, as a function of their elastic displacement u.

    The gap is `base` + u. The pressure is at most `limit` (Pa), which it reaches at the gap
    `lowest` (m).
    """

    def __init__(
        self, table: RepulsionTable, base: Array, limit: Array | float, least: Array | None
    ) -> None:
        self.base, self.table = base, table
        self.limit = np.broadcast_to(np.asarray(limit, dtype=float), base.shape)
        finite = np.isfinite(self.limit)
        # Where nothing limits the pressure, no gap is below the lowest, so that no work is added.
        self.most = np.where(finite, self.limit, 1.0)
        self.lowest = np.where(finite, table.gap_at(self.most), -np.inf)
        self.least = np.full(base.shape, np.inf) if least is None else least
        self.branch = None if least is None else Branch.of(table, np.minimum(least, table.touch))
        # A patch that is loaded again first returns to its deepest state.
        self.lost = 0.0 if self.branch is None else self.branch.lost

    def __call__(self, u: Array) -> tuple[Array, Array, Array]:
        """Return energy (J/m²), its derivative (Pa) and second derivative (Pa/m) at `u`."""
        gap = self.base + u
        inside = np.maximum(gap, self.lowest)
        energy, p, slope = self.table.work(inside)
        below = inside - gap
        energy += self.most * below - self.lost
        slope = np.where(below > 0, 0.0, slope)
        if self.branch is not None and (back := gap >= self.least).any():
            for new, old in zip(self.branch.at(gap), (energy, p, slope), strict=True):
                np.copyto(old, new, where=back)
        return energy, -p, -slope

    def yielded(self, u: Array) -> Array:
        """New plastic displacement (m) of the bulk."""
        return np.maximum(self.lowest - self.base - u, 0.0)

    def least_gap(self, u: Array) -> Array:
        gap = np.minimum(np.maximum(self.base + u, self.lowest), self.least)
        return np.where(gap < self.table.touch, gap, np.inf)

    def energies(self, u: Array) -> tuple[Array, Array, Array]:
        """Elastic energy and dissipated work (J/m²), and relative contact area, at each node."""
        gap, table = np.maximum(self.base + u, self.lowest), self.table
        least = np.minimum(np.minimum(gap, self.least), table.touch)
        work, share = table.work(least)[0], table.of_gap(table.lost, least)
        stored = work * (1 - share)
        area = np.where(gap < table.touch, table.of_gap(table.area, gap), 0.0)
        if self.branch is not None:
            back = gap > self.least
            energy, p, _ = self.branch.at(gap)
            np.copyto(stored, energy, where=back)
            left = p / np.maximum(self.branch.pressure, 1e-300)
            np.copyto(area, table.of_gap(table.area, least) * left, where=back)
        return stored, work * share, area


def solve_with_patches(
    contact: Contact,
    table: RepulsionTable,
    indentation: float,
    limit: Array | float,
    residual: float,
    history: State | None = None,
) -> PatchState:
    """Solve the contact at `indentation` (m) under a bound `limit` (Pa), after `history`.

    The plastic work of a bound that grows is added by the caller. Raises `NotConvergedError`.
    """
    before = history if isinstance(history, PatchState) else None
    plastic = np.zeros(contact.grid.nodes) if before is None else before.plastic_displacement
    least = None if before is None else before.least_gap
    box = candidate_box(contact, indentation, before)
    common: dict[str, Any] = {
        "contact": contact,
        "indentation": indentation,
        "bound": limit,
        "adhesive_work": 0.0,
        "work_error": 0.0 if before is None else before.work_error,
    }
    if box is None:
        nothing = np.zeros((0, 0))
        return PatchState(
            **common,
            box=NOWHERE,
            box_pressure=nothing,
            box_displacement=nothing,
            plastic_displacement=plastic,
            plastic_work=0.0 if before is None else before.plastic_work,
            residual=0.0,
            convolutions=0,
            least_gap=least,
            patch_work=0.0 if before is None else before.patch_work,
        )
    with on_device(CPU):
        K = half_space(shape_of(box), contact.grid.spacing, contact.pair.contact_modulus)
    upper = limit[box] if isinstance(limit, np.ndarray) else limit
    base = contact.gap[box] + plastic[box] + (table.touch - indentation)
    nodes = PatchNodes(table, base, upper, None if least is None else least[box])
    p = np.zeros(shape_of(box)) if before is None else _unloaded(contact, nodes)
    scale = float(np.max(table.touch - base))
    solved = minimise_locally(
        K,
        nodes,
        start=(p, K(p)),
        length=scale,
        tolerance=max(_TOLERANCE * residual, _LEAST_TOLERANCE) * scale,
    )
    if not solved.converged:
        raise NotConvergedError(
            f"the solve at an indentation of {1e9 * indentation:.6g} nm stopped at a residual of "
            f"{solved.residual / scale:.1e} after {solved.steps} steps; use another grid spacing"
        )
    yielded = nodes.yielded(solved.u)
    cell = contact.grid.cell_area
    work = 0.0 if before is None else before.plastic_work - before.patch_work
    if yielded.any():
        plastic = plastic.copy()
        plastic[box] += yielded
        if not contact.plasticity.grows:
            work += float(np.sum(nodes.limit * yielded, where=yielded > 0)) * cell
    deepest = np.full(contact.grid.nodes, np.inf) if least is None else least.copy()
    deepest[box] = nodes.least_gap(solved.u)
    stored, lost, area = (float(values.sum()) * cell for values in nodes.energies(solved.u))
    if least is not None:
        lost += _outside(table, least, box) * cell
    return PatchState(
        **common,
        box=box,
        box_pressure=freeze(np.maximum(solved.p, 0.0)),
        box_displacement=freeze(solved.u),
        plastic_displacement=freeze(plastic),
        plastic_work=work + lost,
        residual=solved.residual / scale,
        convolutions=K.count,
        least_gap=freeze(deepest),
        patch_energy=stored,
        patch_work=lost,
        real_area=area,
        patch_approach=_approach(table, solved.p, nodes.base + solved.u),
    )


def _approach(table: RepulsionTable, p: Array, gap: Array) -> float:
    force, closed = float(p.sum()), table.touch - np.clip(gap, table.pressure.first, table.touch)
    return float(np.sum(p * closed)) / force if force > 0 else 0.0


def _unloaded(contact: Contact, nodes: PatchNodes) -> Array:
    """First guess of the pressure (Pa) after a step: that under patches which no longer deform.

    Unloading patches are stiff, so Newton's method must begin where most of them touch.
    """
    wall = np.minimum(nodes.least, nodes.table.touch)
    if nodes.branch is not None:
        wall = wall + _UNLOADED * nodes.branch.length
    overlap = np.minimum(wall, nodes.table.touch) - nodes.base
    largest = float(overlap.max())
    if largest <= 0:
        return np.zeros_like(overlap)
    with on_device(CPU):
        minimum, _ = solve_multilevel(
            operators_of(contact),
            overlap,
            math.inf,
            tolerance=_ROUGH * largest,
            max_iterations=MAX_ITERATIONS,
            periodic=False,
        )
    return np.asarray(np.minimum(minimum.point, nodes.limit))


def _outside(table: RepulsionTable, least: Array, box: Box) -> float:
    """Sum of the dissipated work (J/m²) of the nodes outside `box`."""
    elsewhere = least.copy()
    elsewhere[box] = np.inf
    gap = elsewhere[np.isfinite(elsewhere)]
    return float(np.sum(table.work(gap)[0] * table.of_gap(table.lost, gap)))
