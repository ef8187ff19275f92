"""Contact at the deepest point of an impact, where the loading work equals the kinetic energy."""

from __future__ import annotations

import math
from dataclasses import replace

from restitution.arguments import typed
from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.cohesive_path import load_until
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import RESIDUAL
from restitution.contact.loading import solve_without_work, with_work, work_is_integrated
from restitution.contact.state import State
from restitution.errors import CaseError, NotConvergedError
from restitution.theory import JKR, Hertz

VELOCITY_TOLERANCE = 1e-6
# Relative tolerance on the velocity if the loading work is integrated. The relative error of the
# integral is about 1e-3, so a smaller tolerance would be useless.
_INTEGRATED_TOLERANCE = 1e-4
_MAX_GROWTH = 3.0  # largest ratio of two successive trial depths
_MOST_STEPS = 8  # largest number of Newton steps


@typed
def solve_at_velocity(contact: Contact, velocity: float, *, start: State | None = None) -> State:
    """Load the undeformed bodies until the loading work is ½ m* V².

    m* is the reduced mass. If the work is known exactly, the relative error of the velocity is at
    most 1e-6. If the work is integrated numerically, it has the error `State.work_error`. The
    velocity computed from `State.loading_work` then agrees with V within 1e-4 or, where the work
    jumps, within the relative error of the work. Where the work is positive, it increases with the
    indentation. The search therefore succeeds unless the work jumps past ½ m* V².

    Args:
        contact: Contact to load.
        velocity: Impact velocity V (m/s), positive.
        start: State of the same contact at a smaller velocity, used as in `solve`.

    Returns:
        State at the deepest point of the impact.

    Raises:
        CaseError: The velocity is not positive, a body has no density, or the contact is periodic.
        DomainError: The contact reaches the edge of the grid.
        NotConvergedError: The loading work jumps past ½ m* V², or a solve did not converge.
    """
    mass = contact.pair.mass
    if mass is None:
        raise CaseError("density: is missing; an impact velocity needs the density of both bodies")
    if contact.periodic:
        raise CaseError(
            "velocity: the bodies of a periodic contact have infinite mass; call solve()"
        )
    if not 0 < velocity < math.inf:
        raise CaseError(f"velocity: {velocity} m/s is not positive")
    work = 0.5 * mass * velocity**2
    tolerance = _INTEGRATED_TOLERANCE if work_is_integrated(contact) else VELOCITY_TOLERANCE
    search = _Search(contact, work, start)
    depth = search.depth(0.3 * tolerance)
    state = search.at(depth)
    require_inside_grid(state)
    miss = search.miss(state)
    if miss > max(tolerance, state.work_error / work):
        raise NotConvergedError(
            f"{velocity:.6g} m/s could be reached only to a relative error of "
            f"{miss:.1e}, at an indentation of {1e9 * depth:.6g} nm, because the work jumps there "
            "(too few nodes in contact); refine the grid or change the velocity",
            argument="velocity",
        )
    return replace(state, convolutions=sum(each.convolutions for each in search.found.values()))


class _Search:
    """The search for the indentation at which the loading work is `work` (J).

    Newton's method is applied to ln W as a function of ln δ, with the loading work W and the
    indentation δ. The slope is F δ/W with the force F, because dW/dδ = F. Two or three solves are
    usually enough. Where the work jumps, Newton's method can fail; a bracketing root finder then
    takes over.
    """

    def __init__(self, contact: Contact, work: float, start: State | None) -> None:
        self._contact, self._work, self._start = contact, work, start
        self.found: dict[float, State] = {}

    def depth(self, tolerance: float) -> float:
        """Find the depth (m) at which the velocity is reached within the relative `tolerance`."""
        depth: float | None = self.first_depth()
        for _ in range(_MOST_STEPS):
            if depth is None or self.miss(self.at(depth)) <= tolerance:
                break
            depth = self.newton(depth)
        else:
            depth = None
        return self.bracketed(tolerance) if depth is None else depth

    def at(self, indentation: float) -> State:
        """Return the state at an indentation (m). A solve starts from the next shallower state."""
        if indentation not in self.found:
            shallower = (state for depth, state in self.found.items() if depth < indentation)
            guess = max(shallower, key=lambda state: state.indentation, default=self._start)
            state = solve_without_work(self._contact, indentation, start=guess, residual=RESIDUAL)
            self.found[indentation] = with_work(state, guess)
        return self.found[indentation]

    def miss(self, state: State) -> float:
        """Relative difference of the velocity of `state` from the prescribed velocity."""
        return abs(math.sqrt(max(state.loading_work, 0.0) / self._work) - 1)

    def first_depth(self) -> float:
        """Return a first guess (m) of the depth.

        It is found by a Newton step from the start state. Without a start state, or if this step
        fails, it is the depth of smooth bodies. A cohesive contact is instead loaded until the
        prescribed work is exceeded. Later solves continue from the last state with less work, so
        the loading path is not followed again.
        """
        if self._contact.cohesive:
            before, reached = load_until(
                self._contact,
                lambda state: state.loading_work >= self._work and state.force > 0,
                start=self._start,
                residual=RESIDUAL,
            )
            self.found[before.indentation] = before
            return reached.indentation
        if self._start is not None and (depth := self._step(self._start)) is not None:
            return depth
        contact = self._contact
        # Hertz's depth is only a first guess: yield and roughness make the contact deeper.
        smooth = Hertz(contact.pair.radius, contact.pair.contact_modulus)
        depth = float(smooth.indentation_from_energy(self._work))
        balanced = contact.approach == "equilibrium" and contact.detachment == "crack-closure"
        if contact.adhesive and balanced:
            return _adhesive_depth(contact, self._work, depth)
        return depth

    def newton(self, depth: float) -> float | None:
        """Return the depth (m) after a Newton step from `depth`; None if it is outside the bracket.

        The bracket extends from the deepest depth tried so far with too little work to the
        shallowest one with too much work.
        """
        following, low = self._step(self.at(depth)), self._deepest_below()
        high = min((d for d, s in self.found.items() if self._excess(s) >= 0), default=math.inf)
        return following if following is not None and low < following < high else None

    def bracketed(self, tolerance: float) -> float:
        """Find the depth (m) with a bracketing root finder, within the relative `tolerance`."""
        from scipy.optimize import toms748

        low = self._deepest_below()
        high = max(low, self.first_depth())
        while (above := self._excess(self.at(high))) < 0:
            low, high = high, high * min(_MAX_GROWTH, max(1.05, 1.05 / max(1 + above, 1e-9)))

        def excess(indentation: float) -> float:
            return self._excess(self.at(float(indentation))) if indentation else -1.0

        # The work W grows with the depth δ as δ² to δ^2.5. So the relative change of the velocity,
        # ΔV/V = ½ ΔW/W, is 1 to 1.25 times Δδ/δ. The relative tolerance of the velocity is
        # therefore also used for the depth.
        return float(toms748(excess, low, high, xtol=tolerance * high, rtol=1e-12, k=1))

    def _deepest_below(self) -> float:
        """Return the deepest depth (m) tried so far with too little work."""
        return max((d for d, s in self.found.items() if self._excess(s) < 0), default=0.0)

    def _step(self, state: State) -> float | None:
        """Return the depth (m) after a Newton step from `state`.

        None if the force or the work of `state` is not positive.
        """
        force, work = state.force, state.loading_work
        if not (force > 0 and work > 0):
            return None
        change = math.log(self._work / work) * work / (force * state.indentation)
        return state.indentation * math.exp(min(change, math.log(_MAX_GROWTH)))

    def _excess(self, state: State) -> float:
        """Return a measure of how far the loading work of `state` is above the prescribed work.

        The result is (W/W₀)^0.4 − 1 with the loading work W and the prescribed work W₀. W grows
        with the indentation δ as δ² to δ^2.5, so the result is nearly linear in δ.
        """
        work = state.loading_work
        return math.copysign((abs(work) / self._work) ** 0.4, work) - 1


def _adhesive_depth(contact: Contact, work: float, shallow: float) -> float:
    """Indentation (m) at which the loading work of smooth JKR bodies is `work` (J).

    `shallow` is the indentation (m) without adhesion.
    """
    from scipy.optimize import brentq

    pair = contact.pair
    smooth = JKR(pair.radius, pair.contact_modulus, contact.work_of_adhesion)
    deep = shallow + 10 * abs(float(smooth.break_indentation))
    return float(brentq(lambda depth: float(smooth.loading_work(depth)) - work, shallow, deep))
