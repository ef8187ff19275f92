"""Contact at the deepest point of an impact, where the loading work equals the kinetic energy."""

from __future__ import annotations

import math
from dataclasses import replace

from restitution.arguments import typed
from restitution.contact.bodies import Pair
from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import RESIDUAL
from restitution.contact.interface import interface_of
from restitution.contact.loading import with_work
from restitution.contact.state import State
from restitution.errors import CaseError, NotConvergedError
from restitution.theory import Hertz

VELOCITY_TOLERANCE = 1e-6
# Relative tolerance on the velocity if the loading work is integrated. The relative error of the
# integral is about 1e-3, so a smaller tolerance would be useless.
_INTEGRATED_TOLERANCE = 1e-4
_MAX_GROWTH = 3.0  # largest ratio of two successive trial depths
_MOST_STEPS = 8  # largest number of Newton steps


@typed
def solve_at_velocity(
    contact: Contact, velocity: float, *, start: State | None = None, near: float | None = None
) -> State:
    """Load the undeformed bodies until the loading work is ½ m* V².

    m* is the reduced mass. The relative error of the velocity is at most 1e-6; if the work is
    integrated numerically, 1e-4 or, where the work jumps, its relative error.

    Args:
        contact: Contact to load.
        velocity: Impact velocity V (m/s), positive.
        start: State of the same contact at a smaller velocity, used as in `solve`.
        near: Expected indentation (m), a first guess that saves solves.

    Returns:
        State at the deepest point of the impact.

    Raises:
        CaseError: The velocity or `near` is not positive, a body has no density, or the contact is
            periodic.
        DomainError: The contact reaches the edge of the grid.
        NotConvergedError: The loading work jumps past ½ m* V², or a solve did not converge.
    """
    mass = mass_in_impact(contact.pair, velocity)
    if contact.periodic:
        raise CaseError(
            "velocity: the bodies of a periodic contact have infinite mass; call solve()"
        )
    if near is not None and not 0 < near < math.inf:
        raise CaseError(f"near: {near} m is not a positive depth")
    work = 0.5 * mass * velocity**2
    integrated = interface_of(contact).integrates_work(contact)
    tolerance = _INTEGRATED_TOLERANCE if integrated else VELOCITY_TOLERANCE
    search = _Search(contact, work, start, near)
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
    return replace(
        state, convolutions=sum(solved.convolutions for solved in search.states.values())
    )


def path_around_work(
    contact: Contact,
    work: float,
    *,
    start: State | None,
    scale: float = 0.0,
    residual: float = RESIDUAL,
) -> tuple[State, State] | None:
    """Last state of loading with less than `work` (J), and the next one; None: no path.

    `scale` and `residual` are those of `Adhesion.enclose`.
    """

    def reached(state: State) -> bool:
        return state.loading_work >= work and state.force > 0

    def ahead(state: State, stiffness: float) -> float:
        left = max(work - state.loading_work, 0.0)
        if stiffness <= 0:
            return left / state.force
        return (math.sqrt(state.force**2 + 2 * stiffness * left) - state.force) / stiffness

    return interface_of(contact).enclose(
        contact, reached, ahead, start=start, scale=scale, residual=residual
    )


def mass_in_impact(pair: Pair, velocity: float) -> float:
    """Reduced mass (kg); raises `CaseError` without it, or if `velocity` (m/s) is not positive."""
    if pair.mass is None:
        raise CaseError("density: is missing; an impact velocity needs the density of both bodies")
    if not 0 < velocity < math.inf:
        raise CaseError(f"velocity: {velocity} m/s is not positive")
    return pair.mass


class _Search:
    """The search for the indentation at which the loading work is `work` (J).

    Newton's method is applied to ln W as a function of ln δ, with the slope F δ/W. Where the work
    jumps, it can fail; a bracketing root finder then takes over.
    """

    def __init__(
        self, contact: Contact, work: float, start: State | None, near: float | None
    ) -> None:
        self._contact, self._work, self._start, self._near = contact, work, start, near
        self.states: dict[float, State] = {}
        self._interface = interface_of(contact)

    def depth(self, tolerance: float) -> float:
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
        if indentation not in self.states:
            shallower = (state for depth, state in self.states.items() if depth < indentation)
            guess = max(shallower, key=lambda state: state.indentation, default=self._start)
            state = self._interface.load(self._contact, indentation, start=guess, residual=RESIDUAL)
            self.states[indentation] = with_work(state, guess)
        return self.states[indentation]

    def miss(self, state: State) -> float:
        return abs(math.sqrt(max(state.loading_work, 0.0) / self._work) - 1)

    def first_depth(self) -> float:
        """First guess (m): the end of a loading path, a Newton step, or the depth of smooth bodies.

        Later solves continue from the last state of the path with less work.
        """

        contact = self._contact
        if path := path_around_work(contact, self._work, start=self._start):
            self.states.update((state.indentation, state) for state in path)
            return path[1].indentation
        if self._start is not None and (depth := self._step(self._start)) is not None:
            return depth
        if self._near is not None:
            return self._near
        # Hertz's depth is only a first guess: yield and roughness make the contact deeper.
        smooth = Hertz(contact.pair.radius, contact.pair.contact_modulus)
        shallow = float(smooth.indentation_from_energy(self._work))
        return self._interface.first_depth(contact, self._work, shallow)

    def newton(self, depth: float) -> float | None:
        """Depth (m) after a Newton step from `depth`; None if it is outside the bracket."""
        following, low = self._step(self.at(depth)), self._deepest_below()
        high = min((d for d, s in self.states.items() if self._excess(s) >= 0), default=math.inf)
        return following if following is not None and low < following < high else None

    def bracketed(self, tolerance: float) -> float:
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
        return max((d for d, s in self.states.items() if self._excess(s) < 0), default=0.0)

    def _step(self, state: State) -> float | None:
        force, work = state.force, state.loading_work
        if not (force > 0 and work > 0):
            return None
        change = math.log(self._work / work) * work / (force * state.indentation)
        return state.indentation * math.exp(min(change, math.log(_MAX_GROWTH)))

    def _excess(self, state: State) -> float:
        """(W/W₀)^0.4 − 1 with the loading work W and the prescribed W₀; nearly linear in depth."""
        work = state.loading_work
        return math.copysign((abs(work) / self._work) ** 0.4, work) - 1
