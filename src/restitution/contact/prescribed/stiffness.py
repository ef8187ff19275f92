"""Normal stiffness of a periodic contact: increase of the nominal pressure per approach.

Without attraction, an additional approach of 1 lowers all nodes in contact by 1, and the pressure
elsewhere stays zero. As in `pressure`, the bodies are put on an elastic foundation. With
attraction, the problem is Newton's equation at the equilibrium.
"""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.equilibrium import MAX_ITERATIONS, operators_of, require_converged
from restitution.contact.influence import (
    foundation_compliance,
    periodic_half_space,
    sprung_half_space,
)
from restitution.contact.interface import interface_of
from restitution.contact.state import Array, State
from restitution.errors import CaseError, NotConvergedError
from restitution.numerics.convolution.device import CPU, current, on_device
from restitution.numerics.quadratic.minimise import BoundedQuadratic, minimise_quadratic
from restitution.numerics.truncated_newton import minimise_locally

_TOLERANCE = 1e-7  # largest error of the additional displacement, relative to the approach
_COMPLETE = 1e-6  # share of the total approach below which that of the contact counts as zero


def normal_stiffness(state: State) -> float:
    """Stiffness (Pa/m) of a periodic contact: change of the nominal pressure per approach.

    All nodes in contact follow the approach elastically, also those at the yield pressure. Where
    nothing yields, this is the slope of the loading curve; otherwise it is the slope at the
    beginning of unloading.

    Args:
        state: State of a periodic contact.

    Returns:
        Stiffness; inf in complete contact, whose mean gap cannot change, and 0 without contact.

    Raises:
        CaseError: The contact is not periodic.
        NotConvergedError: The solution was not found.
    """
    if not state.contact.periodic:
        raise CaseError("state: only a periodic contact has a stiffness per nominal area")
    if (stiffness := interface_of(state.contact).node_stiffness(state)) is not None:
        return _attracted(state, stiffness)
    if not state.contact_nodes:
        return 0.0
    contact, grid, device = state.contact, state.contact.grid, current()
    compliance = foundation_compliance(grid.nodes, grid.spacing, contact.pair.contact_modulus)
    K, inverse = operators_of(contact, sprung_half_space)(grid.nodes, 0)
    free = np.where(state.box_touching, math.inf, 0.0)
    solved = minimise_quadratic(
        BoundedQuadratic(
            K,
            device.put(np.ones(grid.nodes)),
            lower=device.put(-free),
            upper=device.put(free),
            K_single=K.single_precision,
        ),
        start=device.put(np.zeros(grid.nodes)),
        precondition=inverse,
        tolerance=_TOLERANCE,
        max_iterations=MAX_ITERATIONS,
    )
    require_converged(solved, "the solve for the stiffness", _TOLERANCE, solved.residual)
    pressure = float(device.get(solved.point).mean())  # per approach of contact and foundation
    own = 1 - compliance * pressure
    return pressure / own if own > _COMPLETE else math.inf


def _attracted(state: State, k: Array) -> float:
    """Stiffness with the stiffness `k` (Pa/m) of the attraction at each node.

    The displacement u per approach minimises ½ uᵀK⁻¹u + ½ Σ k (u − 1)².
    """
    contact, grid = state.contact, state.contact.grid

    def potential(u: Array) -> tuple[Array, Array, Array]:
        return 0.5 * k * (u - 1) ** 2, k * (u - 1), k

    with on_device(CPU):
        K = periodic_half_space(grid.nodes, grid.spacing, contact.pair.contact_modulus)
    zero = np.zeros(grid.nodes)
    solved = minimise_locally(
        K, potential, start=(zero, zero), length=1.0, tolerance=_TOLERANCE, zero_mean=True
    )
    if not solved.converged or solved.negative_curvature:
        raise NotConvergedError(
            "the stiffness is not defined, because the contact is about to jump; use another "
            "indentation"
        )
    return float(solved.p.mean())
