"""Waves below the grid as a model of the interface: their law is solved on periodic patches."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import ClassVar

import numpy as np

from restitution.arguments import typed
from restitution.contact.bodies import Pair
from restitution.contact.checks.findings import Finding, PatchRangeUnresolved
from restitution.contact.checks.resolution import radius_of_asperities
from restitution.contact.cohesive.bounded_law import NodeLaw
from restitution.contact.cohesive.equilibrium import box_gap
from restitution.contact.cohesive.law import COARSEST, Cohesive, CohesiveLaw
from restitution.contact.contact import Contact
from restitution.contact.interface import NoAttraction
from restitution.contact.models import COMPANION, Plasticity, Separation, adhesive_length
from restitution.contact.patch.attraction import AttractionCurve, AttractionTable
from restitution.contact.patch.blocks import BlockLaw, BlockTables, Shape, shape_in
from restitution.contact.patch.equilibrium import PatchState, solve_with_patches
from restitution.contact.patch.repulsion import PatchCurve, RepulsionTable
from restitution.contact.plasticity.bound import Elastic
from restitution.contact.state import Array, State
from restitution.errors import CaseError
from restitution.numerics.box import Box
from restitution.numerics.read_only import freeze
from restitution.surfaces import Surface, rms_slope

# The unloading branch of patches that yield is known by its energy, not by its tension. This is the
# error of the energy, as a fraction of the dissipated energy.
_OF_BRANCH = 0.5
_INDENTED = 0.5  # of the mean gap: asperities are as sharp at any indentation


def flat(pair: Pair) -> Pair:
    """`pair` with flat bodies."""
    return Pair(*(replace(body, radius=math.inf) for body in (pair.first, pair.second)))


@typed
@dataclass(frozen=True)
class PatchRepulsion(NoAttraction):
    """The law of waves below the grid between bodies without attraction.

    Attributes:
        patches: Periodic surfaces, which contain only waves shorter than `wavelength`.
        wavelength: Longest wave of the patches (m).
        pair: The bodies; set by `Contact`.
        plasticity: How they yield; set by `Contact`.
    """

    patches: tuple[Surface, ...]
    wavelength: float
    pair: Pair | None = None
    plasticity: Plasticity = Elastic()

    label = "none"

    def of_contact(self, contact: Contact) -> PatchRepulsion:
        pair = flat(contact.pair)
        if self.pair == pair and self.plasticity == contact.plasticity:
            return self
        return replace(self, pair=pair, plasticity=contact.plasticity)

    @property
    def seconds_per_node(self) -> float:
        """Time (s) of solving a patch, per node."""
        return 2.2e-5 if self.plasticity.grows else 6e-6

    def curve(self, patch: Surface) -> PatchCurve:
        """The loading of one of the patches."""
        assert self.pair is not None
        return PatchCurve.of(Contact(self.pair, patch, periodic=True), self.plasticity)

    @cached_property
    def table(self) -> RepulsionTable:
        """The mean of the patches."""
        curves = [self.curve(patch) for patch in self.patches]
        return RepulsionTable.of(curves, elastic=math.isinf(self.plasticity.hardness))

    def summary(self) -> dict[str, float]:
        """Numbers of the law, by their names in `summary.json`."""
        table = self.table
        work = table.work(np.array([table.pressure.first]))[0][0]
        return {
            "touch_gap_m": table.touch,
            "deepest_pressure_Pa": float(table.pressure.values[0]),
            "deepest_work_J_per_m2": float(work),
            "deepest_loss_J_per_m2": float(work * table.lost[0]),
        }

    def load(
        self, contact: Contact, indentation: float, *, start: State | None, residual: float
    ) -> State:
        limit, convolutions = self._bound(contact, indentation, residual)
        state = solve_with_patches(contact, self.table, indentation, limit, residual)
        return replace(state, convolutions=state.convolutions + convolutions)

    def _bound(
        self, contact: Contact, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        """Bound of the nominal pressure (Pa), that of the bulk, and the number of convolutions.

        A bound that grows is that of the long waves alone, at their share of the indentation.
        """
        model = contact.plasticity
        if not model.grows:
            return model.bound(contact, indentation, residual)
        free = solve_with_patches(contact, self.table, indentation, math.inf, residual)
        depth = indentation - free.patch_approach
        limit, convolutions = model.bound(_without_patches(contact), depth, residual)
        return freeze(self.table.bulk_bound(np.asarray(limit))), convolutions + free.convolutions

    def yielding(self, state: State) -> Iterator[tuple[Contact, float, Array]]:
        assert isinstance(state, PatchState)
        bulk = replace(state, plastic_work=state.plastic_work - state.patch_work)
        for contact, indentation, work in super().yielding(bulk):
            yield contact, indentation - state.patch_approach, work
        yield _waves(self.patches[0], contact.pair, state.patch_work)

    def with_work(self, state: State, start: State | None) -> State:
        if isinstance(start, PatchState):
            start = replace(start, plastic_work=start.plastic_work - start.patch_work)
        new = super().with_work(state, start)
        if new is state or not isinstance(new, PatchState):
            return new
        return replace(new, plastic_work=new.plastic_work + new.patch_work)

    def step(self, state: State, indentation: float, residual: float) -> State:
        model, limit, convolutions = state.contact.plasticity, state.bound, 0
        if indentation > state.indentation:
            limit, convolutions = self._bound(state.contact, indentation, residual)
            if isinstance(limit, np.ndarray):
                limit = freeze(np.maximum(limit, state.bound))
        new = solve_with_patches(
            state.contact, self.table, indentation, limit, residual, history=state
        )
        if model.grows:
            work = new.plastic_work + model.work(state, new)[0]
            new = replace(new, plastic_work=work, convolutions=new.convolutions + convolutions)
        return new


@typed
@dataclass(frozen=True)
class PatchAttraction(CohesiveLaw):
    """The law of waves below the grid between bodies that attract each other.

    Attributes:
        patches: Periodic surfaces, which contain only waves shorter than `wavelength`.
        wavelength: Longest wave of the patches (m).
        attraction: Attraction between half-spaces.
        pair: The bodies; set by `Contact`.
        plasticity: How they yield; set by `Contact`.
        place: Number of the part of the patches that is at the middle of the grid; 0: their middle.
        cell: Cells of the grid (m); set by `Contact`.
    """

    patches: tuple[Surface, ...]
    wavelength: float
    attraction: Cohesive
    pair: Pair | None = None
    plasticity: Plasticity = Elastic()
    place: int = 0
    cell: tuple[float, float] | None = None

    label = "patch"
    seconds_per_node: ClassVar[float] = 1.2e-4

    def of_contact(self, contact: Contact) -> PatchAttraction:
        new = replace(
            self,
            pair=flat(contact.pair),
            plasticity=contact.plasticity,
            cell=contact.grid.spacing,
        )
        return self if new == self else new

    def with_work_of_adhesion(self, work_of_adhesion: float) -> PatchAttraction:
        return replace(self, attraction=replace(self.attraction, work_of_adhesion=work_of_adhesion))

    @property
    def work_of_adhesion(self) -> float:  # type: ignore[override]
        return self.attraction.work_of_adhesion

    def curve(self, patch: Surface) -> AttractionCurve:
        """The loading of one of the patches."""
        return AttractionCurve.of(self._contact(patch), self._shape(patch))

    @property
    def lost_in_jumps(self) -> float:
        """Largest work (J/m²) that a patch has lost in jumps, of those that are solved."""
        known = filter(self._is_known, self.patches)
        return max((float(self.curve(patch).jumped.max()) for patch in known), default=0.0)

    def pull_off_error(self, state: State) -> float:
        # Unloading patches hold on until the work of their jumps is done, too.
        return self.lost_in_jumps / self.work_of_adhesion

    def _is_known(self, patch: Surface) -> bool:
        return AttractionCurve.is_known(self._contact(patch), self._shape(patch))

    def _shape(self, patch: Surface) -> Shape:
        return shape_in(patch.grid, self.cell or patch.grid.size)

    def _contact(self, patch: Surface) -> Contact:
        pair = self.pair
        assert pair is not None
        model = self.plasticity.of_asperities(pair, 0.5 * pair.contact_modulus * rms_slope(patch))
        return Contact(pair, patch, model, self.attraction, periodic=True)

    def yielding(self, state: State) -> Iterator[tuple[Contact, float, Array]]:
        yield from super().yielding(state)
        # How much of the plastic work is that of patches is not known.
        yield _waves(self.patches[0], state.contact.pair, state.plastic_work)

    def grid_finding(self, contact: Contact) -> Finding | None:
        if not all(map(self._is_known, self.patches)) or self.resolves_range(contact):
            return None
        return self._too_coarse(contact)

    def require_fine_grid(self, contact: Contact) -> None:
        if not self.resolves_range(contact) and not contact.surface.provenance.get(COMPANION):
            raise CaseError(self._too_coarse(contact).text())

    def _too_coarse(self, contact: Contact) -> PatchRangeUnresolved:
        needed = self.coarsest_spacing(contact.pair)
        return PatchRangeUnresolved(max(contact.grid.spacing), needed)

    @cached_property
    def table(self) -> AttractionTable:
        """The mean of the patches."""
        return _tables(replace(self, place=0))[0]

    def at_nodes(self, contact: Contact, box: Box) -> NodeLaw:
        return _on_grid(self, contact).inside(box)

    def summary(self) -> dict[str, float]:
        """Numbers of the law, by their names in `summary.json`."""
        gap, tension = self.table.largest_tension
        return {
            "largest_tension_Pa": tension,
            "largest_tension_gap_m": gap,
            "work_of_adhesion_J_per_m2": self.table.work,
            "equilibrium_gap_m": self.table.equilibrium,
            "deepest_pressure_Pa": float(self.table.pressure.values[0]),
        }

    def separation_of(self, path: list[State]) -> Separation:
        whole = super().separation_of(path)
        start = path[0]
        sums = (float(of.sum()) for of in self.table.lost_at(box_gap(start)))
        lost, jumped = (of * start.contact.grid.cell_area for of in sums)
        # A contact may jump, too, where its patches do, so their jumps may count twice.
        branch = _OF_BRANCH * (lost - jumped) + jumped
        return replace(
            whole,
            unloading_work=whole.unloading_work - lost,
            adhesive_loss=whole.adhesive_loss + lost,
            error=math.hypot(whole.error, branch),
        )

    @property
    def equilibrium_separation(self) -> float:  # type: ignore[override]
        return self.table.equilibrium

    @property
    def gap_of_largest_traction(self) -> float:
        return self.table.largest_tension[0]

    def potential(self, gap: Array) -> tuple[Array, Array, Array]:
        return self.table.potential(np.asarray(gap, dtype=float))

    def energy(self, gap: Array) -> Array:
        return self.potential(np.atleast_1d(gap))[0].reshape(np.shape(gap))

    def traction(self, gap: Array) -> Array:
        return self.potential(np.atleast_1d(gap))[1].reshape(np.shape(gap))

    def stiffness(self, gap: Array) -> Array:
        return self.potential(np.atleast_1d(gap))[2].reshape(np.shape(gap))

    def gap_at(self, pressure: Array) -> Array:
        return self.table.gap_at(pressure)

    def rigid_sphere_energy(self, gap: float, radius: float) -> float:
        return self.table.energy_between_spheres(gap, radius)

    @property
    def reach(self) -> float:
        """Range of the attraction (m): its work divided by the largest tension."""
        return self.table.work / self.table.largest_tension[1]

    def length(self, pair: Pair) -> float:
        if pair.flat:
            return 0.0
        return adhesive_length(pair, self.table.work)

    def zone_length(self, pair: Pair) -> float:
        return pair.contact_modulus * self.reach**2 / self.table.work

    def coarsest_spacing(self, pair: Pair) -> float:
        return COARSEST * min(self.zone_length(pair), math.sqrt(pair.radius * self.reach))

    def needed_spacing(self, state: State) -> float:
        radius = radius_of_asperities(state)
        return min(self.coarsest_spacing(state.contact.pair), 0.5 * math.sqrt(radius * self.reach))


@lru_cache(maxsize=8)
def _tables(law: PatchAttraction) -> tuple[AttractionTable, BlockTables]:
    curves = [law.curve(patch) for patch in law.patches]
    return AttractionTable.of(curves), BlockTables.of(curves, law.cell or law.patches[0].grid.size)


@lru_cache(maxsize=4)
def _on_grid(law: PatchAttraction, contact: Contact) -> BlockLaw:
    return BlockLaw.on(_tables(replace(law, place=0))[1], contact, law.place)


@lru_cache(maxsize=4)
def _without_patches(contact: Contact) -> Contact:
    return replace(contact, adhesion=None)


def _waves(patch: Surface, pair: Pair, work: float) -> tuple[Contact, float, Array]:
    """A patch, its indentation (m), and plastic work at its nodes (J), the same at all."""
    contact = Contact(flat(pair), patch, periodic=True)
    share = np.full(patch.grid.nodes, work / patch.height.size)
    return contact, _INDENTED * float(contact.gap.mean()), share


PatchLaw = PatchRepulsion | PatchAttraction


def law_of_patches(contact: Contact) -> PatchLaw | None:
    """The law of waves below the grid; None if `contact` has none."""
    return contact.adhesion if isinstance(contact.adhesion, PatchLaw) else None
