"""Periodic contact under a prescribed nominal pressure."""

from __future__ import annotations

import math

from restitution.arguments import typed
from restitution.contact.contact import Contact, whole_grid
from restitution.contact.equilibrium import (
    MAX_ITERATIONS,
    RESIDUAL,
    Solution,
    build_state,
    operators_of,
)
from restitution.contact.influence import (
    foundation_compliance,
    sprung_half_space,
)
from restitution.contact.state import State
from restitution.errors import CaseError, DomainError, NotConvergedError
from restitution.numerics.convolution.device import current
from restitution.numerics.quadratic.prescribed_mean import MeanTarget, minimise_at_mean

PRESSURE_TOLERANCE = 1e-8


@typed
def solve_at_pressure(contact: Contact, pressure: float, *, residual: float = RESIDUAL) -> State:
    """Load a periodic contact to a nominal pressure, within a relative error of 1e-8.

    For the solve, the bodies are put on an elastic foundation, which makes the problem positive
    definite even in a complete contact. Its compression is subtracted from the indentation.

    Args:
        contact: Periodic contact to load.
        pressure: Nominal pressure (Pa), positive: the normal force divided by the area of the grid.
        residual: Tolerance on the violation of the contact conditions (dimensionless), relative to
            the indentation.

    Returns:
        State under `pressure`.

    Raises:
        CaseError: The contact is not periodic or is adhesive, or the pressure is not positive.
        DomainError: The pressure is not below the yield pressure.
        NotConvergedError: A tolerance was not reached.
    """
    if not contact.periodic:
        raise CaseError("contact: only a periodic contact has a nominal pressure; call solve()")
    if contact.adhesive:
        raise CaseError(
            "contact: the bodies attract each other, so the pressure jumps on approach; prescribe "
            "the indentation"
        )
    if contact.plasticity.grows:
        raise CaseError(
            "contact: the yield pressure depends on the indentation (size effect); prescribe the "
            "indentation"
        )
    if not 0 < pressure < math.inf:
        raise CaseError(f"pressure: {pressure} Pa is not positive")
    limit = contact.hardness
    if pressure >= limit:
        raise DomainError(
            f"pressure: {pressure:.4g} Pa is not below the yield pressure, {limit:.4g} Pa; use a "
            "smaller pressure"
        )
    grid = contact.grid
    compliance = foundation_compliance(grid.nodes, grid.spacing, contact.pair.contact_modulus)
    device = current()
    solved = minimise_at_mean(
        operators_of(contact, sprung_half_space),
        device.put(contact.gap),
        limit,
        MeanTarget(pressure, PRESSURE_TOLERANCE, compliance, residual),
        max_iterations=MAX_ITERATIONS,
    )
    minimum = solved.minimum
    indentation = solved.multiplier - compliance * float(minimum.point.mean())
    if not minimum.converged:
        raise NotConvergedError(
            f"pressure: {pressure:.6g} Pa was not reached at a tolerance of {residual:.0e}; "
            "use another grid spacing or a smoother surface (in Python, also a larger residual)"
        )
    solution = Solution(
        overlap=indentation - contact.gap,
        pressure=device.get(minimum.point),
        gap=device.get(minimum.gradient),
        residual=minimum.residual / indentation,
        convolutions=solved.products,
    )
    return build_state(
        contact,
        indentation,
        whole_grid(contact),
        solution,
        limit=limit,
        history=None,
    )
