"""Contact at the deepest point of an impact, where the loading work is the kinetic energy."""

from __future__ import annotations

import math
from dataclasses import replace

from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import RESIDUAL
from restitution.contact.loading import solve_without_work, with_work, work_is_integrated
from restitution.contact.state import State
from restitution.errors import CaseError, NotConvergedError
from restitution.theory import Hertz

VELOCITY_TOLERANCE = 1e-6
# Relative tolerance on the velocity if the loading work is integrated. The relative error of the
# integral is about 1e-3, so a smaller tolerance would be useless.
_INTEGRATED_TOLERANCE = 1e-4
_MAX_GROWTH = 3.0  # largest factor between two trial depths in the search for an upper bound


def solve_at_velocity(contact: Contact, velocity: float, *, start: State | None = None) -> State:
    """Load the undeformed bodies until the loading work is ½ m* V².

    If the work is known exactly, the relative error of the velocity is at most 1e-6. If the work is
    integrated, the velocity computed from `State.loading_work` is V within 1e-4, and
    `State.work_error` is an additional error. Where the work is positive, it increases with the
    indentation, so a bracketing root finder always converges.

    Args:
        contact: Contact to load.
        velocity: Impact velocity V (m/s), positive.
        start: State of the same contact at a lower velocity, as for `solve`.

    Returns:
        State at the deepest point of the impact.

    Raises:
        CaseError: The velocity is not positive, or a body has no density.
        DomainError: The contact reaches the edge of the grid.
        NotConvergedError: The work jumps at this indentation, or a solve did not converge.
    """
    from scipy.optimize import toms748

    mass = contact.pair.mass
    if mass is None:
        raise CaseError("density: is missing; give the density of both bodies, or no velocity")
    if not 0 < velocity < math.inf:
        raise CaseError(f"velocity: {velocity} m/s is not positive")
    work = 0.5 * mass * velocity**2
    tolerance = _INTEGRATED_TOLERANCE if work_is_integrated(contact) else VELOCITY_TOLERANCE
    found: dict[float, State] = {}

    def excess(indentation: float) -> float:
        """Function with the sign of W − ½ m* V², nearly linear because W grows as δ² to δ^2.5."""
        indentation = float(indentation)  # the root finder passes a NumPy scalar
        if indentation == 0:
            return -1.0
        guess = max(
            (state for depth, state in found.items() if depth < indentation),
            key=lambda state: state.indentation,
            default=start,
        )
        state = solve_without_work(contact, indentation, start=guess, residual=RESIDUAL)
        found[indentation] = state = with_work(state, guess)
        return math.copysign((abs(state.loading_work) / work) ** 0.4, state.loading_work) - 1

    # Start at Hertz's depth for this work; yield and roughness make the contact deeper.
    smooth = Hertz(contact.pair.radius, contact.pair.contact_modulus)
    high = float(smooth.indentation_from_energy(work))
    low, above = 0.0, excess(high)
    while above < 0:
        low, high = high, high * min(_MAX_GROWTH, max(1.05, 1.05 / max(1 + above, 1e-9)))
        above = excess(high)
    # The tolerance on the depth follows from ΔV/V = ½ ΔW/W, between Δδ/δ and 1.25 Δδ/δ.
    deepest = float(toms748(excess, low, high, xtol=0.3 * tolerance * high, rtol=1e-12, k=1))
    if deepest not in found:
        excess(deepest)
    state = found[deepest]
    require_inside_grid(state)
    miss = abs(math.sqrt(max(state.loading_work, 0.0) / work) - 1)
    if miss > max(tolerance, state.work_error / work):
        raise NotConvergedError(
            f"velocity: {velocity:.6g} m/s was met only within {miss:.1e} at an indentation of "
            f"{1e9 * deepest:.6g} nm, where the work jumps (too few nodes in contact); refine the "
            "grid or change the velocity"
        )
    return replace(state, convolutions=sum(each.convolutions for each in found.values()))
