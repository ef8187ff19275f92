"""Contact at an impact velocity: the indentation at which the approach is used up."""

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
# Where the work is integrated, it is known no better than some parts in a thousand.
_INTEGRATED_TOLERANCE = 1e-4
_WIDEST = 3.0  # times the last depth: the longest step towards a deeper bracket


def solve_at_velocity(contact: Contact, velocity: float, *, start: State | None = None) -> State:
    """Load the undeformed bodies until ½ m* V² = W(δ) and return the state.

    `velocity` V (m/s) is met within 1e-6 of itself where the work is exact, within 1e-4 of what
    the state's own work says where it is integrated (`work_error` is what that is worth). Once
    positive the work grows with indentation, so a bracketing root finder cannot fail. `start` is a
    state of the same contact at a lower velocity, as for `solve`. Raises `CaseError` for a velocity
    that is not positive or a body without density, and as `solve`.
    """
    from scipy.optimize import toms748

    mass = contact.pair.mass
    if mass is None:
        raise CaseError("density: is missing; an impact velocity needs the masses")
    if not 0 < velocity < math.inf:
        raise CaseError(f"velocity: {velocity} m/s is not a positive velocity")
    work = 0.5 * mass * velocity**2
    tolerance = _INTEGRATED_TOLERANCE if work_is_integrated(contact) else VELOCITY_TOLERANCE
    found: dict[float, State] = {}

    def excess(indentation: float) -> float:
        """Nearly linear in the indentation: works grow as its power 2 to 2.5."""
        indentation = float(indentation)  # no NumPy scalar, which the root finder makes of it
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

    # Hertz's depth for this work; yield and roughness make it deeper.
    smooth = Hertz(contact.pair.radius, contact.pair.contact_modulus)
    high = float(smooth.indentation_from_energy(work))
    low, above = 0.0, excess(high)
    while above < 0:
        low, high = high, high * min(_WIDEST, max(1.05, 1.05 / max(1 + above, 1e-9)))
        above = excess(high)
    # ΔV/V = ½ ΔW/W ≈ Δδ/δ to 1.25 Δδ/δ.
    deepest = float(toms748(excess, low, high, xtol=0.3 * tolerance * high, rtol=1e-12, k=1))
    if deepest not in found:
        excess(deepest)
    state = found[deepest]
    require_inside_grid(state)
    miss = abs(math.sqrt(max(state.loading_work, 0.0) / work) - 1)
    if miss > max(tolerance, state.work_error / work):
        raise NotConvergedError(
            f"velocity: {velocity:.6g} m/s was met only within {miss:.1e} at an indentation of "
            f"{1e9 * deepest:.6g} nm; the work jumps there (too few nodes in contact): refine the "
            "grid or change the velocity"
        )
    return replace(state, convolutions=sum(each.convolutions for each in found.values()))
