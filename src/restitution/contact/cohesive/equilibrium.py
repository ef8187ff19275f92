"""Contact with an attraction of finite range: one solve, and the state that it returns.

The bodies interact at every node by a traction that depends on the gap g (the interface law,
`theory.LennardJones`). At a prescribed indentation δ, the displacement u is a local minimum of

    ½ uᵀK⁻¹u + Σ φ(g),   g = z₀ + h₀ + u_p − δ + u.

φ is the energy of the law, K the operator from pressure to elastic displacement, z₀ the equilibrium
separation, h₀ the initial gap and u_p the plastic displacement. Unlike in the JKR limit, no set of
contact nodes has to be found, and no nodes are released. Where an equilibrium ceases to exist, the
solve descends to another equilibrium. `cohesive_path` computes the energy that is dissipated there.
Surfaces yield where the pressure of the law would exceed the pressure bound of the material. The
pressure then stays at this bound, and further approach of the surfaces becomes plastic
displacement.

A node is *in contact* if its gap is smaller than 3^{1/6} z₀, the gap at which the attraction is
largest. At smaller gaps the law is stable: its attraction grows with the gap. As the range of the
attraction decreases, the nodes in contact approach the contact area of JKR, whose edge is under
tension.

The solve covers a box, which is a rectangle of grid nodes. The nodes outside the box, and the
paraboloid outside the grid, also attract but are treated as rigid.

In a periodic contact the box is the whole period, and δ is the approach of the mean planes. The
mean of u is then zero, and the mean pressure follows from the interface law alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from restitution.contact.bodies import Pair
from restitution.contact.cohesive.law import BoundedLaw, largest_softening, law_of, stiffness
from restitution.contact.contact import Contact, whole_grid
from restitution.contact.influence import half_space, periodic_half_space
from restitution.contact.state import Array, State
from restitution.errors import CaseError, DomainError, NotConvergedError
from restitution.numerics.box import Box, bounding_box, reframe, shape_of
from restitution.numerics.convolution.device import CPU, on_device
from restitution.numerics.convolution.operators import Convolution
from restitution.numerics.read_only import freeze
from restitution.numerics.truncated_newton import minimise_locally

# The grid spacing must not exceed this fraction of the length of the cohesive zone, E* z₀²/w, nor
# of sqrt(R* z₀). On coarser grids the edge of the contact is pinned between nodes, which makes the
# dissipated energy and the pull-off force wrong.
COARSEST = 0.3
COMPANION = "companion"  # provenance key of a surface that only serves to compare grids

# A solve includes all nodes at which the attraction matters. At these nodes the gap before elastic
# deformation is below about _REACH z₀ + L, where L is `Contact.adhesive_length`.
_REACH = 12.0
# The tolerance of the displacement is z₀ times the `residual` of a solve times _TOLERANCE. Because
# of rounding, it is at least z₀ times _LEAST_TOLERANCE.
_TOLERANCE, _LEAST_TOLERANCE = 100.0, 1e-7
# An equilibrium counts as unique if the bound that `is_unique` computes is below this value.
_UNIQUE = 0.7


@dataclass(frozen=True, eq=False, repr=False)
class CohesiveState(State):
    """A state with an attraction of finite range.

    Attributes:
        interaction_energy: Energy of the interface law (J); 0 for bodies far apart.
        far_force: Normal force (N) outside `box`, the part of the grid that is solved.
        adhesive_loss: Energy dissipated so far by jumps between equilibria (J).
        jumps: Number of these jumps so far.
        unaccounted: Work of the force minus the change of energy (J), summed over all steps without
            a jump so far. It differs from zero only by the error of integration.
        smallest_gap: Smallest gap between the surfaces (m). The traction is zero at the gap z₀.
    """

    interaction_energy: float = 0.0
    far_force: float = 0.0
    adhesive_loss: float = 0.0
    jumps: int = 0
    unaccounted: float = 0.0
    smallest_gap: float = math.inf

    @property
    def force(self) -> float:
        """Normal force (N), including the attraction outside `box` and outside the grid."""
        return super().force + self.far_force

    @property
    def box_touching(self) -> NDArray[np.bool_]:
        """Whether each node of the box is in contact (bool).

        A node is in contact if its gap is below the gap at which the attraction is largest.
        """
        return box_gap(self) < float(law_of(self.contact).gap_of_largest_traction)

    @property
    def mean_gap(self) -> float:
        """Mean gap (m) of a periodic contact. For flat surfaces at zero force it is z₀."""
        return super().mean_gap + self.contact.equilibrium_separation

    @property
    def potential_energy(self) -> float:
        """Sum of elastic energy and interaction energy (J)."""
        return self.stored_energy + self.interaction_energy


def box_gap(state: State) -> Array:
    """Gap between the deformed surfaces on the box of `state` (m)."""
    base = _base(state.contact, state.indentation, state.box, state.plastic_displacement)
    return base + state.box_displacement


def cohesive_length(contact: Contact) -> float:
    """Length E*z₀²/w (m) of the cohesive zone at the edge of a contact.

    z₀ is the equilibrium separation and w the work of adhesion.
    """
    z0, w = contact.equilibrium_separation, contact.work_of_adhesion
    return contact.pair.contact_modulus * z0**2 / w


def coarsest_spacing(pair: Pair, work_of_adhesion: float, z0: float) -> float:
    """The largest grid spacing (m) that resolves the attraction, with a margin for rounding.

    The grid must resolve two lengths: the cohesive zone at the edge of a contact, and the radius
    over which a sphere attracts. This radius is of the order sqrt(R*z₀). At the distance
    sqrt(2R*z₀) from the apex, the gap under a paraboloid of radius R* has grown by z₀, the range of
    the attraction.
    """
    zone = pair.contact_modulus * z0**2 / work_of_adhesion
    return COARSEST * (1 + 1e-9) * min(zone, math.sqrt(pair.radius * z0))


def needed_spacing(contact: Contact) -> float:
    """Largest grid spacing (m) that resolves the range of the attraction of `contact`."""
    return coarsest_spacing(contact.pair, contact.work_of_adhesion, contact.equilibrium_separation)


def resolves_range(contact: Contact) -> bool:
    """Whether the cells of the grid resolve the range of the attraction."""
    return max(contact.grid.spacing) <= needed_spacing(contact)


def require_fine_grid(contact: Contact) -> None:
    """Raise `CaseError` if the cells are too coarse to resolve the range of the attraction.

    The coarser surfaces of companion curves (provenance key `COMPANION`) are exempt, because they
    only serve to compare grids.
    """
    if not resolves_range(contact) and not contact.surface.provenance.get(COMPANION):
        raise CaseError(
            f"grid.spacing: {1e9 * max(contact.grid.spacing):.4g} nm is too coarse for the range "
            f'of the attraction; adhesion = "cohesive" needs {1e9 * needed_spacing(contact):.4g} '
            "nm or less (0.3 times the smaller of E* z0^2/w and sqrt(R* z0), with the work of "
            "adhesion w and the equilibrium separation z0)"
        )


def solve_cohesive(
    contact: Contact,
    indentation: float,
    box: Box,
    *,
    p: Array,
    u: Array | None = None,
    limit: Array | float,
    history: State | None,
    residual: float,
) -> CohesiveState:
    """Find an equilibrium on `box`, by descending from the pressure `p` to lower energies.

    `u` is the displacement due to `p`; None to compute it. `limit` is the largest pressure (Pa),
    a number or an array of the shape of the grid. The plastic work and the work error of the result
    are copied from `history` (zero if None), and its adhesive work is zero. The caller updates all
    three. Raises `NotConvergedError`, and `DomainError` if the pressure in a periodic contact
    without yield exceeds E*.
    """
    K = _operator(contact, box)
    before = np.zeros(contact.grid.nodes) if history is None else history.plastic_displacement
    upper = limit[box] if isinstance(limit, np.ndarray) else limit
    law = BoundedLaw(contact, _base(contact, indentation, box, before), upper)
    z0 = contact.equilibrium_separation
    found = minimise_locally(
        K,
        law,
        p=p,
        u=K(p) if u is None else u,
        length=0.5 * z0,
        tolerance=max(_TOLERANCE * residual, _LEAST_TOLERANCE) * z0,
        zero_mean=contact.periodic,
    )
    if not found.converged:
        raise NotConvergedError(
            f"the cohesive solve at an indentation of {1e9 * indentation:.6g} nm stopped at a "
            f"residual of {found.residual / z0:.1e} times the equilibrium separation after "
            f"{found.steps} steps; refine the grid"
        )
    yielded = law.beyond(found.u)
    if contact.periodic and not law.yields and yielded.any():
        raise DomainError(
            f"indentation: at {1e9 * indentation:.6g} nm the pressure exceeds E* "
            f"({contact.pair.contact_modulus:.4g} Pa); use a smaller indentation, or give a "
            "yield_pressure"
        )
    plastic = before
    if law.yields and yielded.any():
        plastic = before.copy()
        plastic[box] += yielded
    gap = np.maximum(law.base + found.u, law.least)
    area = contact.grid.cell_area
    far_force, far_energy = _far(contact, indentation, box)
    energy = float(np.sum(law_of(contact).energy(gap))) * area
    if not law.yields:
        # Below the gap `law.least`, the law of elastic bodies is continued linearly. Add the energy
        # of this continuation.
        energy += float(np.sum(law.continuation(found.u))) * area
    return CohesiveState(
        contact,
        indentation,
        box,
        freeze(found.p),
        freeze(found.u),
        freeze(plastic),
        limit,
        plastic_work=0.0 if history is None else history.plastic_work,
        adhesive_work=0.0,
        work_error=0.0 if history is None else history.work_error,
        residual=found.residual / contact.residual_length(indentation),
        convolutions=K.count,
        is_first_loading=history is None or history.is_first_loading,
        interaction_energy=energy + far_energy,
        far_force=far_force,
        smallest_gap=float(gap.min(initial=math.inf)),
    )


def rigid_start(contact: Contact, *, limit: Array | float, residual: float) -> CohesiveState:
    """Return the first state of a loading path, with the bodies far apart.

    At this and every larger distance the equilibrium is unique. So the approach up to this state
    dissipates no energy.
    """
    z0 = contact.equilibrium_separation
    gap, convolutions = 2 * z0, 0
    while True:
        indentation = z0 - gap
        box = interacting_box(contact, indentation)
        p = rigid_pressure(contact, indentation, box)
        state = solve_cohesive(
            contact, indentation, box, p=p, limit=limit, history=None, residual=residual
        )
        convolutions += state.convolutions
        if is_unique(state):
            return with_interaction(replace(state, convolutions=convolutions))
        gap *= 1.5


def rigid_pressure(contact: Contact, indentation: float, box: Box) -> Array:
    """Pressure (Pa) of the interface law between rigid bodies.

    It is set to zero at nodes whose gap is below the gap at which the attraction is largest.
    """
    gap = _base(contact, indentation, box, None)
    least = float(law_of(contact).gap_of_largest_traction)
    return np.where(gap > least, -law_of(contact).traction(np.maximum(gap, least)), 0.0)


def with_interaction(state: CohesiveState) -> CohesiveState:
    """Set the adhesive work of `state` from its interaction energy and its adhesive loss."""
    return replace(state, adhesive_work=-state.interaction_energy - state.adhesive_loss)


def interacting_box(contact: Contact, indentation: float, history: State | None = None) -> Box:
    """Return the box of all nodes whose gap is small enough for the attraction to deform them."""
    if contact.periodic:
        return whole_grid(contact)
    reach = _REACH * contact.equilibrium_separation + contact.adhesive_length
    gap = contact.gap if history is None else contact.gap + history.plastic_displacement
    box = bounding_box(gap < max(indentation + reach, reach * 1e-3))
    if box is None:  # the bodies are far apart: use the nodes with the smallest gaps
        box = bounding_box(gap <= gap.min() + reach)
        assert box is not None
    return box


def on_box(state: CohesiveState, box: Box, *, residual: float) -> CohesiveState:
    """Solve `state` again on a larger box."""
    contact, indentation = state.contact, state.indentation
    inside = reframe(np.ones(shape_of(state.box), dtype=bool), state.box, box)
    p = np.where(
        inside,
        reframe(state.box_pressure, state.box, box),
        rigid_pressure(contact, indentation, box),
    )
    new = solve_cohesive(
        contact, indentation, box, p=p, limit=state.bound, history=state, residual=residual
    )
    return with_interaction(
        replace(
            new,
            adhesive_loss=state.adhesive_loss,
            jumps=state.jumps,
            unaccounted=state.unaccounted,
        )
    )


def is_unique(state: CohesiveState) -> bool:
    """Whether the equilibrium is unique at this distance of the bodies and at every larger one.

    The equilibrium is unique if the spectral radius of the matrix K diag(max(−φ″, 0)) is below 1.
    K is the operator from pressure to elastic displacement, and φ the interaction energy per area
    as a function of the gap. The largest row sum of the matrix is an upper bound of the spectral
    radius.

    In a periodic contact the row sums of K vanish and give no bound. There, the bound is
    (λ/(πE*)) max(−φ″). λ/(πE*) is the compliance under a pressure wave of the longest wavelength λ.
    The maximum is taken over the present smallest gap and all larger gaps.
    """
    contact = state.contact
    if contact.periodic:
        compliance = max(contact.grid.size) / (math.pi * contact.pair.contact_modulus)
        return compliance * largest_softening(contact, state.smallest_gap) < _UNIQUE
    x = contact.equilibrium_separation / box_gap(state)
    softening = np.maximum(-stiffness(contact, x), 0.0)
    K = _operator(contact, state.box)
    return float(K(softening).max()) < _UNIQUE


def _operator(contact: Contact, box: Box) -> Convolution:
    """Make the operator from pressure to displacement on `box`.

    It is always on the CPU, because this solver needs NumPy arrays.
    """
    build = periodic_half_space if contact.periodic else half_space
    with on_device(CPU):
        return build(shape_of(box), contact.grid.spacing, contact.pair.contact_modulus)


def _base(contact: Contact, indentation: float, box: Box, plastic: Array | None) -> Array:
    """Gap (m) between the surfaces on `box` before elastic displacement."""
    base: Array = contact.gap[box] + (contact.equilibrium_separation - indentation)
    if plastic is not None:
        base += plastic[box]
    return base


def _far(contact: Contact, indentation: float, box: Box) -> tuple[float, float]:
    """Force (N) and energy (J) of the nodes outside `box` and of the bodies outside the grid.

    These parts of the bodies are treated as rigid.
    """
    if contact.periodic:
        return 0.0, 0.0
    law, grid, (rows, columns) = law_of(contact), contact.grid, box
    z0, everything = contact.equilibrium_separation, slice(None)
    outside: tuple[Box, ...] = (
        (slice(0, rows.start), everything),
        (slice(rows.stop, None), everything),
        (rows, slice(0, columns.start)),
        (rows, slice(columns.stop, None)),
    )
    force = energy = 0.0
    for part in outside:
        gap = np.maximum(contact.gap[part] + (z0 - indentation), 1.2 * z0)
        force -= float(np.sum(law.traction(gap))) * grid.cell_area
        energy += float(np.sum(law.energy(gap))) * grid.cell_area
    # Outside the grid, each body is replaced by its smooth mean surface (`Contact.mean_offset`).
    # Force and energy are integrated outside a circle that has the area of the grid.
    R, (wide, long) = contact.pair.radius, grid.size
    edge = wide * long / (2 * math.pi * R) + contact.mean_offset + z0 - indentation
    edge = max(edge, 2 * z0)
    return (
        force + float(law.rigid_sphere_force(edge, R)),
        energy + float(law.rigid_sphere_energy(edge, R)),
    )
