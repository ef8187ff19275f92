"""Attractions of finite range: a traction at every node that depends on the gap."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np

from restitution.arguments import typed
from restitution.contact.bodies import Pair
from restitution.contact.checks.findings import Finding, RangeUnresolved
from restitution.contact.checks.resolution import divisions, radius_of_asperities
from restitution.contact.cohesive.bounded_law import NodeLaw
from restitution.contact.cohesive.equilibrium import CohesiveState, box_gap
from restitution.contact.cohesive.loading import load_cohesive, load_until, move
from restitution.contact.cohesive.separation import separate_cohesive, separation_of
from restitution.contact.cohesive.steps import ACCURACY
from restitution.contact.contact import Contact
from restitution.contact.models import (
    COMPANION,
    EQUILIBRIUM_SEPARATION,
    Adhesion,
    Separation,
    set_field,
)
from restitution.contact.state import Array, State
from restitution.errors import CaseError
from restitution.numerics.box import Box
from restitution.numerics.expressions import (
    Triple,
    chords_over,
    continued_lennard_jones,
    cubic_root,
    lennard_jones,
    lennard_jones_chords,
    lennard_jones_totals,
)
from restitution.numerics.quadrature import integrate_adaptively
from restitution.theory import LennardJones

# The grid spacing must not exceed this fraction of the length of the cohesive zone, E* z₀²/w, nor
# of sqrt(R* z₀). On coarser grids the edge of the contact is pinned between nodes, which makes the
# dissipated energy and the pull-off force wrong.
COARSEST = 0.3
# Cells up to this fraction of sqrt(r z0) at asperities of radius r change the pull-off force by at
# most 1.5 % (docs/adhesion.md).
_COARSEST_ON_ASPERITIES = 0.5
# Tolerance of the energy balance of a step of unloading, as a fraction of the tolerance of COR.
_UNACCOUNTED = 0.25
# Tolerances of periodic contacts, divided by those of others: many asperities jump one by one, and
# the energy of each is small beside that of all.
_OF_PERIODIC = 0.2
# Relative error of the adhesive loss on the coarsest grid that is allowed (docs/adhesion.md).
_GRID_LOSS = 0.05
# Relative error of the pull-off force if the grid resolves the range of the attraction.
_PULL_OFF = 0.01
# The attraction of Lennard-Jones weakens most steeply at the gap z₀/_SOFTEST.
_SOFTEST = (2 / 15) ** (1 / 6)
_FAR = 100.0  # gap, in units of z₀, beyond which a law without closed forms does not attract
_SHARES = (*(0.5**k for k in range(1, 11)), *(-(2.0**k) for k in range(20)))
_SAMPLES = 2000  # gaps at which the slope of such a law is sampled


class CohesiveLaw(Adhesion, NodeLaw):
    """A traction law between the surfaces, as a function of their gap g.

    A law defines `energy`, `traction`, `stiffness`, `gap_of_largest_traction` and the two fields of
    `Adhesion`; the other methods follow from these. The traction must be 0 at the equilibrium
    separation, and the repulsion must grow without bound as the gap decreases.
    """

    bytes_per_node = 1800.0  # up to 100 states are kept, with 16 bytes per node each
    follows_path = True
    steep = True
    work_tolerance = ACCURACY  # error of a step of loading, relative to its energies

    @abstractmethod
    def energy(self, gap: Array) -> Array:
        """Energy per area (J/m²): −w at the equilibrium separation, 0 at infinity."""

    @abstractmethod
    def traction(self, gap: Array) -> Array:
        """Attractive traction (Pa), the derivative of the energy with respect to the gap."""

    @abstractmethod
    def stiffness(self, gap: Array) -> Array:
        """Derivative of the traction with respect to the gap (Pa/m)."""

    @property
    @abstractmethod
    def gap_of_largest_traction(self) -> float:
        """Gap (m) at which the attraction is largest; nodes below are in contact."""

    def potential(self, gap: Array) -> tuple[Array, Array, Array]:
        """New arrays of energy, traction and stiffness."""
        return self.energy(gap), self.traction(gap), self.stiffness(gap)

    def totals(self, gap: Array, shift: float, least: float) -> tuple[float, float]:
        """Sums of energy (J/m²) and traction (Pa) at the gap + `shift`, at least `least` (m)."""
        gap = np.maximum(gap + shift, least)
        return float(self.energy(gap).sum()), float(self.traction(gap).sum())

    def chords(
        self, base: Array, u: Array, known: Triple, ends: tuple[Array, Array], least_way: float
    ) -> Array:
        """Slopes (Pa/m) of the chords from the gap `base` + `u` to the gap at the pressure.

        `known` are the pressure of each node, and traction and stiffness at its gap; `ends` are the
        pressure and the softness (m/Pa) at its smallest gap. The stiffness stays where neither
        repels, where the chord is not longer than `least_way` (m), and where it falls.
        """
        p, (bound, softness), gap = known[0], ends, base + u
        repels = (p > 0) | (gap < self.equilibrium_separation)
        wanted = np.maximum(p[repels], 0.0)
        inside = np.minimum(wanted, bound[repels])
        way = np.zeros_like(gap)
        way[repels] = gap[repels] - self.gap_at(inside) + (wanted - inside) * softness[repels]
        return chords_over(way, known, least_way)

    def at_nodes(self, contact: Contact, box: Box) -> NodeLaw:
        """The law at the nodes of `box`, by default the same at all."""
        return self

    def gap_at(self, pressure: Array) -> Array:
        """Gap (m) at which the pressure (Pa, not negative) of the law has this value."""
        z0 = self.equilibrium_separation
        low = high = np.full(np.shape(pressure), z0)
        for share in _SHARES:  # of z₀: positive first, because a law can be singular at gap 0
            if not (short := -self.traction(low) < pressure).any():
                break
            low = np.where(short, share * z0, low)
        gap: Array = 0.5 * (low + high)
        for _ in range(60):
            over = -self.traction(gap) - pressure
            low, high = np.where(over > 0, gap, low), np.where(over > 0, high, gap)
            newton = gap + over / np.maximum(self.stiffness(gap), 1e-300)
            inside = (newton > low) & (newton < high)
            new = np.where(inside, newton, 0.5 * (low + high))
            change, gap = np.abs(new - gap), new
            if change.max(initial=0.0) <= 1e-12 * z0:
                break
        return gap

    def largest_softening(self, smallest_gap: float) -> float:
        """Largest rate (Pa/m) at which the attraction weakens beyond `smallest_gap` (m)."""
        gaps = np.linspace(smallest_gap, _FAR * self.equilibrium_separation, _SAMPLES)
        return max(0.0, -float(self.stiffness(gaps).min()))

    def rigid_sphere_force(self, gap: float, radius: float) -> float:
        """Normal force (N) between rigid spheres with the smallest gap `gap` (m)."""
        return 2 * math.pi * radius * float(self.energy(np.asarray(gap)))

    def rigid_sphere_energy(self, gap: float, radius: float) -> float:
        """Energy (J) between rigid spheres with the smallest gap `gap` (m)."""
        far = _FAR * self.equilibrium_separation
        if gap >= far:
            return 0.0
        at, end = (self.rigid_sphere_force(g, radius) for g in (gap, far))
        tolerance = 1e-6 * radius * self.work_of_adhesion * self.equilibrium_separation
        force = lambda g: self.rigid_sphere_force(g, radius)  # noqa: E731
        return integrate_adaptively(force, gap, far, at, end, tolerance, panels=8)[0]

    def describe(self, unloading: str) -> dict[str, str]:
        return {"adhesion": self.label, "unloading": unloading}

    def check(self, contact: Contact) -> None:
        if not contact.plasticity.bounds_solve:
            raise CaseError(
                f'plasticity: "{contact.plasticity.label}" is not defined with an attraction of '
                "finite range; use ConstantBound, or JKRLimit as adhesion"
            )

    def loading_accuracy(self, contact: Contact) -> float:
        """Error of a step of loading, relative to its energies."""
        return self.work_tolerance * _share(contact)

    def load(
        self, contact: Contact, indentation: float, *, start: State | None, residual: float
    ) -> State:
        accuracy = self.loading_accuracy(contact)
        return load_cohesive(
            contact, indentation, start=start, residual=residual, accuracy=accuracy
        )

    def with_work(self, state: State, start: State | None) -> State:
        return state  # the path to the state has counted its work

    def integrates_work(self, contact: Contact) -> bool:
        return True

    def step(self, state: State, indentation: float, residual: float) -> State:
        accuracy = self.loading_accuracy(state.contact)
        return move(cast(CohesiveState, state), indentation, residual, accuracy)

    def enclose(
        self,
        contact: Contact,
        reached: Callable[[State], bool],
        ahead: Callable[[State, float], float],
        *,
        start: State | None,
        scale: float,
        residual: float,
    ) -> tuple[State, State] | None:
        accuracy = self.loading_accuracy(contact)
        options = {"residual": residual, "scale": scale, "accuracy": accuracy}
        return load_until(contact, reached, ahead, start=start, **options)

    def unload(
        self, state: State, *, steps: int, tolerance: float, residual: float, known: Sequence[State]
    ) -> Iterator[State]:
        accuracy = _UNACCOUNTED * tolerance * _share(state.contact)
        return separate_cohesive(cast(CohesiveState, state), accuracy=accuracy, known=known)

    def separation_of(self, path: list[State]) -> Separation:
        return separation_of(path)

    def attraction_energy(self, state: State) -> float:
        return -cast(CohesiveState, state).interaction_energy

    def unbalance(self, state: State, end: State, work: float, lost: float) -> float:
        begin, last = cast(CohesiveState, state), cast(CohesiveState, end)
        released = begin.potential_energy - last.potential_energy
        released -= end.plastic_work - state.plastic_work
        return (work + lost - released) / state.stored_energy

    def node_stiffness(self, state: State) -> Array | None:
        return self.at_nodes(state.contact, state.box).stiffness(box_gap(state))

    def zone_length(self, pair: Pair) -> float:
        """Length E*z₀²/w (m) of the cohesive zone at the edge of a contact."""
        return pair.contact_modulus * self.equilibrium_separation**2 / self.work_of_adhesion

    def coarsest_spacing(self, pair: Pair) -> float:
        # At the distance sqrt(2R*z₀) from the apex, the gap under a paraboloid of radius R* has
        # grown by z₀, the range of the attraction. The factor is a margin for rounding.
        reach = math.sqrt(pair.radius * self.equilibrium_separation)
        return COARSEST * (1 + 1e-9) * min(self.zone_length(pair), reach)

    def needed_spacing(self, state: State) -> float:
        radius = radius_of_asperities(state)
        reach = _COARSEST_ON_ASPERITIES * math.sqrt(radius * self.equilibrium_separation)
        return min(self.coarsest_spacing(state.contact.pair), reach)

    def require_fine_grid(self, contact: Contact) -> None:
        """Raise `CaseError` if the cells are too coarse; surfaces of companions are exempt."""
        if not self.resolves_range(contact) and not contact.surface.provenance.get(COMPANION):
            needed = self.coarsest_spacing(contact.pair)
            raise CaseError(
                f"grid.spacing: {1e9 * max(contact.grid.spacing):.4g} nm is too coarse for the "
                f'range of the attraction; adhesion = "cohesive" needs {1e9 * needed:.4g} nm or '
                "less (0.3 times the smaller of E* z0^2/w and sqrt(R* z0), with the work of "
                "adhesion w and the equilibrium separation z0)"
            )

    def grid_finding(self, contact: Contact) -> Finding | None:
        if self.resolves_range(contact):
            return None
        spacing, needed = max(contact.grid.spacing), self.coarsest_spacing(contact.pair)
        return RangeUnresolved(spacing, needed, divisions(spacing, needed), contact.periodic)

    def grid_loss(self, contact: Contact) -> float:
        fineness = max(contact.grid.spacing) / (COARSEST * self.zone_length(contact.pair))
        return _GRID_LOSS * fineness**2

    def expected_pull_off_error(self, contact: Contact) -> float:
        return _PULL_OFF


@typed
@dataclass(frozen=True)
class Cohesive(CohesiveLaw):
    """The Lennard-Jones law between half-spaces (`theory.LennardJones`).

    Attributes:
        work_of_adhesion: Work of adhesion w (J/m²), positive.
        equilibrium_separation: Gap z₀ (m) at which the traction is zero, which sets the range.
        work_tolerance: Error of a step of loading, relative to its energies (dimensionless).

    Raises:
        CaseError: A value is not positive.
    """

    work_of_adhesion: float
    equilibrium_separation: float = EQUILIBRIUM_SEPARATION
    work_tolerance: float = ACCURACY

    label = "cohesive"

    def __post_init__(self) -> None:
        set_field(self, "work_of_adhesion", "J/m2")
        set_field(self, "equilibrium_separation", "m")
        set_field(self, "work_tolerance", "")

    def with_work_tolerance(self, tolerance: float) -> Cohesive:
        return replace(self, work_tolerance=tolerance)

    @cached_property
    def _law(self) -> LennardJones:
        return LennardJones(self.work_of_adhesion, self.equilibrium_separation)

    def describe(self, unloading: str) -> dict[str, str]:
        z0 = f"{1e9 * self.equilibrium_separation:.4g} nm"
        words = f"Lennard-Jones between half-spaces, z0 = {z0}"
        return {"adhesion": words, "unloading": unloading}

    @property
    def gap_of_largest_traction(self) -> float:
        return float(self._law.gap_of_largest_traction)

    def energy(self, gap: Array) -> Array:
        return self._law.energy(gap)

    def traction(self, gap: Array) -> Array:
        return self._law.traction(gap)

    def stiffness(self, gap: Array) -> Array:
        return self._stiffness_at(self.equilibrium_separation / gap)

    def _stiffness_at(self, x: Array) -> Array:
        scale = 8 * self.work_of_adhesion / self.equilibrium_separation**2
        return scale * x**4 * (3 * x**6 - 1)

    def potential(self, gap: Array) -> tuple[Array, Array, Array]:
        energy, slope, stiffness = np.empty_like(gap), np.empty_like(gap), np.empty_like(gap)
        w, z0 = self.work_of_adhesion, self.equilibrium_separation
        lennard_jones(gap, w, z0, energy, slope, stiffness)
        return energy, slope, stiffness

    def totals(self, gap: Array, shift: float, least: float) -> tuple[float, float]:
        law = self.work_of_adhesion, self.equilibrium_separation
        return lennard_jones_totals(gap, shift, least, law)

    def continued(self, base: Array, u: Array, ends: Triple) -> tuple[Array, Array, Array]:
        energy, slope, stiffness = (np.empty(base.shape) for _ in range(3))
        law = self.work_of_adhesion, self.equilibrium_separation
        continued_lennard_jones(base, u, ends, law, energy, slope, stiffness)
        return energy, slope, stiffness

    def chords(
        self, base: Array, u: Array, known: Triple, ends: tuple[Array, Array], least_way: float
    ) -> Array:
        law, out = (self.work_of_adhesion, self.equilibrium_separation), np.empty(base.shape)
        lennard_jones_chords(base, u, known, ends, law, least_way, out)
        return out

    def gap_at(self, pressure: Array) -> Array:
        w, z0 = self.work_of_adhesion, self.equilibrium_separation
        return np.asarray(z0 / np.cbrt(cubic_root(pressure * 3 * z0 / (8 * w))))

    def largest_softening(self, smallest_gap: float) -> float:
        x = np.minimum(self.equilibrium_separation / np.asarray(smallest_gap), _SOFTEST)
        return max(0.0, -float(self._stiffness_at(x)))

    def rigid_sphere_force(self, gap: float, radius: float) -> float:
        return float(self._law.rigid_sphere_force(gap, radius))

    def rigid_sphere_energy(self, gap: float, radius: float) -> float:
        return float(self._law.rigid_sphere_energy(gap, radius))


def _share(contact: Contact) -> float:
    return _OF_PERIODIC if contact.periodic else 1.0
