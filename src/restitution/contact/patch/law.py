"""Waves below the grid as a model of the interface: their law is solved on periodic patches."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from restitution.arguments import typed
from restitution.contact.bodies import Pair
from restitution.contact.checks.resolution import radius_of_asperities
from restitution.contact.cohesive.law import COARSEST, Cohesive, CohesiveLaw
from restitution.contact.contact import Contact
from restitution.contact.interface import NoAttraction
from restitution.contact.models import Plasticity
from restitution.contact.patch.attraction import AttractionCurve, AttractionTable
from restitution.contact.patch.equilibrium import PatchState, solve_with_patches
from restitution.contact.patch.repulsion import PatchCurve, RepulsionTable
from restitution.contact.plasticity.bound import Elastic
from restitution.contact.state import Array, State
from restitution.numerics.read_only import freeze
from restitution.surfaces import Surface
from restitution.theory import JKR


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

    label = "patch"

    def of_contact(self, contact: Contact) -> PatchRepulsion:
        pair = flat(contact.pair)
        if self.pair == pair and self.plasticity == contact.plasticity:
            return self
        return replace(self, pair=pair, plasticity=contact.plasticity)

    @cached_property
    def curves(self) -> tuple[PatchCurve, ...]:
        """The loading of each patch."""
        assert self.pair is not None
        return tuple(
            PatchCurve.of(Contact(self.pair, patch, periodic=True), self.plasticity)
            for patch in self.patches
        )

    @cached_property
    def table(self) -> RepulsionTable:
        """The mean of the patches."""
        return RepulsionTable.of(self.curves)

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
        return limit, convolutions + free.convolutions

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
    """

    patches: tuple[Surface, ...]
    wavelength: float
    attraction: Cohesive
    pair: Pair | None = None
    plasticity: Plasticity = Elastic()

    label = "patch"

    def of_contact(self, contact: Contact) -> PatchAttraction:
        pair = flat(contact.pair)
        if self.pair == pair and self.plasticity == contact.plasticity:
            return self
        return replace(self, pair=pair, plasticity=contact.plasticity)

    def with_work_of_adhesion(self, work_of_adhesion: float) -> PatchAttraction:
        return replace(self, attraction=self.attraction.with_work_of_adhesion(work_of_adhesion))

    @property
    def work_of_adhesion(self) -> float:  # type: ignore[override]
        return self.attraction.work_of_adhesion

    @cached_property
    def curves(self) -> tuple[AttractionCurve, ...]:
        """The loading of each patch."""
        assert self.pair is not None
        model = self.plasticity.of_asperities(self.pair, math.inf)
        return tuple(
            AttractionCurve.of(Contact(self.pair, patch, model, self.attraction, periodic=True))
            for patch in self.patches
        )

    @cached_property
    def table(self) -> AttractionTable:
        """The mean of the patches."""
        return AttractionTable.of(self.curves)

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
        return float(JKR(pair.radius, pair.contact_modulus, self.table.work).adhesive_length)

    def zone_length(self, pair: Pair) -> float:
        return pair.contact_modulus * self.reach**2 / self.table.work

    def coarsest_spacing(self, pair: Pair) -> float:
        return COARSEST * min(self.zone_length(pair), math.sqrt(pair.radius * self.reach))

    def needed_spacing(self, state: State) -> float:
        radius = radius_of_asperities(state)
        return min(self.coarsest_spacing(state.contact.pair), 0.5 * math.sqrt(radius * self.reach))


@lru_cache(maxsize=4)
def _without_patches(contact: Contact) -> Contact:
    return replace(contact, adhesion=None)
