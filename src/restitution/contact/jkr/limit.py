"""Adhesion of zero range, the limit of soft bodies (Johnson, Kendall and Roberts 1971)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from restitution.arguments import typed
from restitution.contact.bodies import Pair
from restitution.contact.checks.resolution import radius_of_asperities, tabor_parameter
from restitution.contact.contact import Contact
from restitution.contact.interface import load_under_bound
from restitution.contact.jkr.approach import AdhesiveApproach, Approach
from restitution.contact.jkr.area import balances_are_reliable, unload_adhesive
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
from restitution.contact.state import State
from restitution.errors import CaseError
from restitution.theory import JKR, MaugisDugdale

# A relative error of 1.5e-3 of the loading work changes COR by at most 0.00075. The force jumps as
# asperities attach, which limits the accuracy.
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
        work_tolerance: Relative error of the loading work where it is integrated (dimensionless).

    Raises:
        CaseError: A value is impossible.

    Source:
        K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301–313.
    """

    work_of_adhesion: float
    approach: Approach = AdhesiveApproach()
    detachment: Detachment = CrackClosure()
    equilibrium_separation: float = EQUILIBRIUM_SEPARATION
    work_tolerance: float = _TOLERANCE

    label = "jkr"
    bytes_per_node = 150.0

    def __post_init__(self) -> None:
        set_field(self, "work_of_adhesion", "J/m2")
        set_field(self, "equilibrium_separation", "m")
        set_field(self, "work_tolerance", "")

    def with_work_tolerance(self, tolerance: float) -> JKRLimit:
        return replace(self, work_tolerance=tolerance)

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
        return self.crack_opening(contact) / self.residual_length(contact.pair, indentation)

    def load(
        self, contact: Contact, indentation: float, *, start: State | None, residual: float
    ) -> State:
        solve = partial(self.approach.load, contact, indentation, start, residual)
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
        if known and gain <= 2 * self.work_tolerance * mechanical:
            # The adhesive work is set to its largest possible value, the work of adhesion times the
            # contact area. In contacts for which it was integrated, it was 0.37 to 0.93 times this
            # value, and above 0.7 times in most of them. The error covers this range.
            return replace(state, adhesive_work=gain, work_error=0.65 * gain)
        balanced = self.approach.in_equilibrium and balances_are_reliable(state)
        if balanced and plasticity.bounds_solve:
            work, error, convolutions = work_by_balance(
                state, start, self._intermediate, self.work_tolerance
            )
            if start is not None:
                error += start.work_error - pinning_error(start)
            error += pinning_error(state)
        else:
            work, error, convolutions = work_by_force(
                state, start, self._intermediate, self.work_tolerance
            )
        state = replace(state, work_error=error, convolutions=convolutions + state.convolutions)
        if not plasticity.bounds_solve:
            # There is no formula for the plastic work of a truncated pressure. It is computed as
            # the integrated work minus the elastic energy.
            return replace(state, plastic_work=work - state.stored_energy, adhesive_work=0.0)
        return replace(state, adhesive_work=state.stored_energy + state.plastic_work - work)

    def step(self, state: State, indentation: float, residual: float) -> State:
        return unload_adhesive(state, indentation, residual=residual)

    def first_depth(self, contact: Contact, work: float, shallow: float) -> float:
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
