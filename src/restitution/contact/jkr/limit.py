"""Adhesion of zero range, the limit of soft bodies (Johnson, Kendall and Roberts 1971)."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from restitution.arguments import typed
from restitution.contact.bodies import Pair
from restitution.contact.checks.resolution import radius_of_asperities, tabor_parameter
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import solve_nonadhesive
from restitution.contact.interface import load_under_bound
from restitution.contact.jkr.area import (
    balances_are_reliable,
    grow_contact,
    jkr_of,
    unload_adhesive,
)
from restitution.contact.jkr.detachment import CrackClosure, Detachment
from restitution.contact.jkr.loading_work import pinning_error, work_by_balance, work_by_force
from restitution.contact.jkr.separation import separate, separation_of
from restitution.contact.models import (
    EQUILIBRIUM_SEPARATION,
    WORK_RESIDUAL,
    Adhesion,
    Separation,
    set_field,
)
from restitution.contact.state import Array, State
from restitution.errors import CaseError
from restitution.numerics.box import bounding_box
from restitution.theory import JKR, MaugisDugdale

# Retraction after each loading increment (m) (Ghanbarzadeh et al. 2019, §2.2).
PULL_INCREMENT = 1e-10
# Relative tolerance of the integral of an adhesive force. The force jumps as asperities attach,
# which limits the accuracy. A relative error of 1.5e-3 of the loading work changes COR by at most
# 0.00075.
_TOLERANCE = 1.5e-3
# With four or more nodes per pull-off radius and `CrackClosure`, the pull-off force of smooth
# spheres is within 2.3 % of JKR. This held for all tested positions of the apex relative to the
# nodes (docs/adhesion.md).
ADHESIVE_NODES = 4
# Traction of the Maugis-Dugdale law, in units of w/z₀, with the pull-off force of Lennard-Jones
# (docs/adhesion.md).
_TRACTION = 0.548
# Values of the Tabor parameter, and the energy that smooth elastic spheres dissipate in a cycle of
# contact, as a fraction of the energy dissipated in JKR theory. The fractions come from an
# axisymmetric reference solution (docs/studies/cohesive_reference.csv).
_TABOR = (0.7, 1.0, 2.0, 3.0, 5.0)
_HYSTERESIS = (0.0, 0.0347, 0.2039, 0.3198, 0.4581)
_BEYOND = 0.44  # exponent of the extrapolation to larger Tabor parameters


class Approach(ABC):
    """How adhesion acts during loading.

    Attributes:
        label: Name in case files and results.
        attracts: Whether adhesion does work during loading (bool).
        in_equilibrium: Whether each state is an adhesive equilibrium, so that the contact begins by
            a jump at first touch (bool).
        pinning: Error of the loading work because loading steps influence which nodes attach, as a
            fraction of the work of adhesion times the contact area. In validation contacts, 93 % of
            29 works in equilibrium and all of 11 with pull increments differed by less than this
            from the work of 240 steps.
    """

    label: ClassVar[str]
    attracts: ClassVar[bool] = True
    in_equilibrium: ClassVar[bool] = False
    pinning: ClassVar[float] = 0.0

    @abstractmethod
    def load(
        self,
        contact: Contact,
        indentation: float,
        limit: Array | float,
        start: State | None,
        residual: float,
    ) -> State:
        """Load the undeformed bodies to `indentation` (m) under the bound `limit` (Pa)."""


@typed
@dataclass(frozen=True)
class AdhesiveApproach(Approach):
    """Loading finds the adhesive equilibrium at each depth."""

    label = "equilibrium"
    in_equilibrium = True
    pinning = 0.02

    def load(
        self,
        contact: Contact,
        indentation: float,
        limit: Array | float,
        start: State | None,
        residual: float,
    ) -> State:
        shallower = start if start is not None and start.indentation <= indentation else None
        by_energy = jkr_of(contact).detachment.by_energy
        if shallower is not None and not by_energy:
            box, held = shallower.box, shallower.box_pressure != 0
        else:
            # A contact that grows from a smaller one can stop growing too early, before the energy
            # release rate along its edge has fallen to the work of adhesion. So the search starts
            # from all nodes that overlap at this indentation, and then releases nodes.
            inside = contact.gap <= indentation
            if shallower is not None:
                inside[shallower.box] |= shallower.box_pressure != 0
            around = bounding_box(inside)
            assert around is not None  # the gap is zero at the node that touches first
            box, held = around, inside[around]
        return grow_contact(
            contact,
            indentation,
            box,
            held,
            limit=limit,
            first_guess=None if start is None else start.pressure_on(box),
            residual=residual,
        )


@typed
@dataclass(frozen=True)
class HertzianApproach(Approach):
    """Loading without adhesion."""

    label = "hertzian"
    attracts = False

    def load(
        self,
        contact: Contact,
        indentation: float,
        limit: Array | float,
        start: State | None,
        residual: float,
    ) -> State:
        return solve_nonadhesive(contact, indentation, limit, residual)


@typed
@dataclass(frozen=True)
class PullIncrements(Approach):
    """Loading without adhesion, followed by a retraction of 0.1 nm with adhesion.

    Source:
        A. Ghanbarzadeh et al. (2019), §2.2.
    """

    label = "pull-increments"
    pinning = 0.006

    def load(
        self,
        contact: Contact,
        indentation: float,
        limit: Array | float,
        start: State | None,
        residual: float,
    ) -> State:
        # If the retraction releases all nodes, the result is a state out of contact, not an error.
        pressed = solve_nonadhesive(contact, indentation + PULL_INCREMENT, limit, residual)
        state = unload_adhesive(pressed, indentation, residual=residual)
        return replace(state, adhesive_work=0.0, is_first_loading=True)


@typed
@dataclass(frozen=True)
class JKRLimit(Adhesion):
    """Adhesion of zero range: nodes in contact can carry tension, other nodes do not attract.

    Attributes:
        work_of_adhesion: Work of adhesion w (J/m²), positive.
        approach: `AdhesiveApproach`, `HertzianApproach` or `PullIncrements`.
        detachment: `CrackClosure` or `PohrtPopov`.
        equilibrium_separation: Gap z₀ (m) at which the traction is zero, for the errors due to the
            neglected range.

    Raises:
        CaseError: A value is impossible.

    Source:
        K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301–313.
    """

    work_of_adhesion: float
    approach: Approach = AdhesiveApproach()
    detachment: Detachment = CrackClosure()
    equilibrium_separation: float = EQUILIBRIUM_SEPARATION

    label = "jkr"
    bytes_per_node = 150.0

    def __post_init__(self) -> None:
        set_field(self, "work_of_adhesion", "J/m2")
        set_field(self, "equilibrium_separation", "m")

    def describe(self, unloading: str) -> dict[str, str]:
        return {
            "adhesion": "JKR limit",
            "approach": self.approach.label,
            "detachment": self.detachment.label,
            "unloading": unloading,
        }

    def check(self, contact: Contact) -> None:
        if contact.periodic:
            raise CaseError(
                "adhesion: the JKR limit is not defined for a periodic contact; use "
                "Cohesive(work_of_adhesion), or leave out adhesion"
            )

    def crack_opening(self, contact: Contact) -> float:
        """Gap 1.86 sqrt(w h/E*) (m) one cell outside a straight edge that is about to recede."""
        h = math.sqrt(contact.grid.cell_area)
        return 1.86 * math.sqrt(self.work_of_adhesion * h / contact.pair.contact_modulus)

    def relative_opening(self, contact: Contact, indentation: float) -> float:
        """`crack_opening` relative to the length by which residuals are divided."""
        return self.crack_opening(contact) / self.residual_length(contact.pair, indentation)

    def load(
        self, contact: Contact, indentation: float, *, start: State | None, residual: float
    ) -> State:
        def solve(limit: Array | float) -> State:
            return self.approach.load(contact, indentation, limit, start, residual)

        return load_under_bound(contact, indentation, residual, solve)

    def _intermediate(self, contact: Contact, depth: float, start: State | None) -> State:
        return self.load(contact, depth, start=start, residual=WORK_RESIDUAL)

    def integrates_work(self, contact: Contact) -> bool:
        return self.approach.attracts or not contact.plasticity.exact_work

    def with_work(self, state: State, start: State | None) -> State:
        plasticity = state.contact.plasticity
        if plasticity.bounds_solve or not self.approach.attracts:
            state = plasticity.with_loading_work(state, start, self._intermediate)
        if not self.approach.attracts:
            return state
        gain = self.work_of_adhesion * state.contact_area
        mechanical = state.stored_energy + state.plastic_work
        known = self.approach.in_equilibrium and plasticity.exact_work
        if known and gain <= 2 * _TOLERANCE * mechanical:
            # The adhesive work is set to its largest possible value, the work of adhesion times the
            # contact area. In contacts for which it was integrated, it was 0.37 to 0.93 times this
            # value, and above 0.7 times in most of them. The error covers this range.
            return replace(state, adhesive_work=gain, work_error=0.65 * gain)
        balanced = self.approach.in_equilibrium and balances_are_reliable(state)
        if balanced and plasticity.bounds_solve:
            work, error, convolutions = work_by_balance(
                state, start, self._intermediate, _TOLERANCE
            )
            if start is not None:
                error += start.work_error - pinning_error(start)
            error += pinning_error(state)
        else:
            work, error, convolutions = work_by_force(state, start, self._intermediate, _TOLERANCE)
        state = replace(state, work_error=error, convolutions=convolutions + state.convolutions)
        if not plasticity.bounds_solve:
            # There is no formula for the plastic work of a truncated pressure. It is computed as
            # the integrated work minus the elastic energy.
            return replace(state, plastic_work=work - state.stored_energy, adhesive_work=0.0)
        return replace(state, adhesive_work=state.stored_energy + state.plastic_work - work)

    def step(self, state: State, indentation: float, residual: float) -> State:
        return unload_adhesive(state, indentation, residual=residual)

    def first_depth(self, contact: Contact, work: float, shallow: float) -> float:
        """Depth (m) of smooth JKR bodies, where each state is in equilibrium."""
        if not (self.approach.in_equilibrium and self.detachment.by_energy):
            return shallow
        from scipy.optimize import brentq

        smooth = self._sphere(contact.pair, contact.pair.radius)
        deep = shallow + 10 * abs(float(smooth.break_indentation))
        return float(brentq(lambda depth: float(smooth.loading_work(depth)) - work, shallow, deep))

    def unload(
        self, state: State, *, steps: int, tolerance: float, residual: float, known: Sequence[State]
    ) -> Iterator[State]:
        return separate(state, tolerance=tolerance, known=known)

    def separation_of(self, path: list[State]) -> Separation:
        return separation_of(path)

    def release_error(self) -> float:
        return self.detachment.release_error * self.work_of_adhesion

    def pull_off_radius(self, pair: Pair, radius: float) -> float:
        """Contact radius (m) at pull-off of a sphere of reduced radius `radius` (m)."""
        return float(self._sphere(pair, radius).pull_off_radius)

    def needed_spacing(self, state: State) -> float:
        radius = radius_of_asperities(state)
        return self.pull_off_radius(state.contact.pair, radius) / ADHESIVE_NODES

    def expected_pull_off_error(self, contact: Contact) -> float:
        pair = contact.pair
        nodes = self.pull_off_radius(pair, pair.radius) / max(contact.grid.spacing)
        return self.detachment.pull_off_error / nodes

    def range_error(self, state: State, restitution: float) -> float:
        work = state.loading_work
        if work <= 0 or state.contact_nodes == 0:
            return 0.0
        lost = max(1 - restitution**2 - state.plastic_work / work, 0.0)
        regained = lost * (1 - hysteresis_ratio(tabor_parameter(state)))
        return min(math.sqrt(restitution**2 + regained), 1.0) - restitution

    def pull_off_error(self, state: State) -> float:
        """Difference of Maugis' pull-off force (1992) at the asperities in contact."""
        radius, w, pair = radius_of_asperities(state), self.work_of_adhesion, state.contact.pair
        traction = _TRACTION * w / self.equilibrium_separation
        maugis = float(MaugisDugdale(radius, pair.contact_modulus, w, traction).pull_off_force)
        return maugis / float(self._sphere(pair, radius).pull_off_force) - 1

    def _sphere(self, pair: Pair, radius: float) -> JKR:
        return JKR(radius, pair.contact_modulus, self.work_of_adhesion)


def hysteresis_ratio(tabor: float) -> float:
    """Energy dissipated in a contact cycle of smooth elastic spheres, as a fraction of that of JKR.

    Beyond the Tabor parameter µ = 5, its difference from 1 is extrapolated as µ^(−0.44). In the
    table the exponent increases with µ, so the result is more likely too small than too large.
    """
    if tabor >= _TABOR[-1]:
        return 1 - (1 - _HYSTERESIS[-1]) * math.pow(_TABOR[-1] / tabor, _BEYOND)
    return float(np.interp(tabor, _TABOR, _HYSTERESIS))
