"""Contact with an attraction of finite range: one solve, and the state that it returns.

At a prescribed indentation δ, the displacement u is a local minimum of

    ½ uᵀK⁻¹u + Σ φ(g),   g = z₀ + h₀ + u_p − δ + u,

where φ is the energy of the traction law, K the operator from pressure to elastic displacement, h₀
the initial gap and u_p the plastic displacement. Where an equilibrium ceases to exist, the solve
descends to another one. Where the pressure of the law would exceed the bound of the material, it
stays at this bound, and further approach becomes plastic displacement. The nodes outside the box,
and the paraboloid outside the grid, attract but are rigid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from restitution.contact.cohesive.bounded_law import BoundedLaw, law_of, nodes_of
from restitution.contact.contact import Contact, whole_grid
from restitution.contact.influence import approximate_half_space, half_space, periodic_half_space
from restitution.contact.state import Array, State
from restitution.errors import DomainError, NotConvergedError
from restitution.numerics.box import Box, bounding_box, reframe, shape_of
from restitution.numerics.convolution.device import CPU, on_device
from restitution.numerics.convolution.operators import Convolution
from restitution.numerics.read_only import freeze
from restitution.numerics.truncated_newton import minimise_locally

# A solve includes all nodes at which the attraction matters. At these nodes the gap before elastic
# deformation is below about _REACH z₀ + L, where L is `Adhesion.length`.
_REACH = 12.0
# The tolerance of the displacement is z₀ times the `residual` of a solve times _TOLERANCE. Because
# of rounding, it is at least z₀ times _LEAST_TOLERANCE.
_TOLERANCE, _LEAST_TOLERANCE = 100.0, 1e-7
# An equilibrium counts as unique if the bound that `is_unique` computes is below this value.
_UNIQUE = 0.7


class FarEquilibriumError(Exception):
    """No equilibrium within the reach of a solve, which took `convolutions`."""

    def __init__(self, convolutions: int) -> None:
        super().__init__(convolutions)
        self.convolutions = convolutions


@dataclass(frozen=True, eq=False, repr=False)
class CohesiveState(State):
    """A state with an attraction of finite range.

    Attributes:
        interaction_energy: Energy of the traction law (J); 0 for bodies far apart.
        far_force: Normal force (N) outside `box`, the part of the grid that is solved.
        jumps: Number of jumps between equilibria so far.
        unaccounted: Work of the force minus the change of energy (J), summed over all steps without
            a jump so far. It differs from zero only by the error of integration.
        smallest_gap: Smallest gap between the surfaces (m).
        before: The state before on the same branch of equilibria; None at its beginning.
    """

    interaction_energy: float = 0.0
    far_force: float = 0.0
    jumps: int = 0
    unaccounted: float = 0.0
    smallest_gap: float = math.inf
    before: CohesiveState | None = field(default=None, repr=False)

    @property
    def force(self) -> float:
        return super().force + self.far_force

    @property
    def box_touching(self) -> NDArray[np.bool_]:
        """Whether the gap of each node is below that of the largest attraction (bool)."""
        return np.asarray(box_gap(self) < nodes_of(self.contact, self.box).gap_of_largest_traction)

    @property
    def mean_gap(self) -> float:
        """Mean gap (m) of a periodic contact. For flat surfaces at zero force it is z₀."""
        return super().mean_gap + law_of(self.contact).equilibrium_separation

    @property
    def jump_error(self) -> float:
        """The part of `work_error` (J) that is not `unaccounted`."""
        return self.work_error - abs(self.unaccounted)

    @property
    def potential_energy(self) -> float:
        return self.stored_energy + self.interaction_energy


def box_gap(state: State) -> Array:
    base = _base(state.contact, state.indentation, state.box, state.plastic_displacement)
    return base + state.box_displacement


def solve_cohesive(
    contact: Contact,
    indentation: float,
    box: Box,
    *,
    start: tuple[Array, Array | None],
    limit: Array | float,
    history: State | None,
    residual: float,
    reach: float = math.inf,
) -> CohesiveState:
    """Find an equilibrium on `box`, by descending from the pressure of `start` to lower energies.

    `start` has also the displacement due to the pressure; None to compute it. The caller updates
    works and losses. Raises `FarEquilibriumError` if the displacement of a node would change by
    more than `reach` (m), `NotConvergedError`, and `DomainError` if the pressure of elastic
    periodic bodies exceeds E*.
    """
    K = _operator(contact, box)
    parts = None if contact.periodic else PartOperators(contact)
    before = np.zeros(contact.grid.nodes) if history is None else history.plastic_displacement
    upper = limit[box] if isinstance(limit, np.ndarray) else limit
    law = BoundedLaw(contact, _base(contact, indentation, box, before), upper, box)
    z0 = law_of(contact).equilibrium_separation
    p, begin = start[0], K(start[0]) if start[1] is None else start[1]

    def near(u: Array) -> tuple[Array, Array, Array]:
        if float(np.abs(u - begin).max()) > reach:
            raise FarEquilibriumError(K.count + (parts.count if parts else 0))
        return law(u)

    solved = minimise_locally(
        K,
        near if reach < math.inf else law,
        start=(p, begin),
        length=0.5 * z0,
        tolerance=max(_TOLERANCE * residual, _LEAST_TOLERANCE) * z0,
        zero_mean=contact.periodic,
        secant=law.secant if law.steep else None,
        operator_of=parts,
    )
    if not solved.converged:
        raise NotConvergedError(
            f"the cohesive solve at an indentation of {1e9 * indentation:.6g} nm stopped at a "
            f"residual of {solved.residual / z0:.1e} times the equilibrium separation after "
            f"{solved.steps} steps; refine the grid"
        )
    yielded = law.beyond(solved.u)
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
    gap = np.maximum(law.base + solved.u, law.least)
    area = contact.grid.cell_area
    far_force, far_energy = _far(contact, indentation, box)
    energy = float(nodes_of(contact, box).potential(gap)[0].sum()) * area
    if not law.yields:
        # Below the gap `law.least`, the law of elastic bodies is continued linearly. Add the energy
        # of this continuation.
        energy += float(np.sum(law.continuation(solved.u))) * area
    return CohesiveState(
        contact=contact,
        indentation=indentation,
        box=box,
        box_pressure=freeze(solved.p),
        box_displacement=freeze(solved.u),
        plastic_displacement=freeze(plastic),
        bound=limit,
        plastic_work=0.0 if history is None else history.plastic_work,
        adhesive_work=0.0,
        work_error=0.0 if history is None else history.work_error,
        residual=solved.residual / law_of(contact).residual_length(contact.pair, indentation),
        convolutions=K.count + (parts.count if parts else 0),
        is_first_loading=history is None or history.is_first_loading,
        interaction_energy=energy + far_energy,
        far_force=far_force,
        smallest_gap=float(gap.min(initial=math.inf)),
    )


def rigid_start(contact: Contact, *, limit: Array | float, residual: float) -> CohesiveState:
    """First state of a loading path, so far apart that the approach has dissipated no energy."""
    z0 = law_of(contact).equilibrium_separation
    gap, convolutions = 2 * z0, 0
    while contact.periodic and not _is_unique_gap(contact, gap):
        gap *= 1.5  # bodies that deform are closer still
    while True:
        indentation = z0 - gap
        box = interacting_box(contact, indentation)
        p = rigid_pressure(contact, indentation, box)
        state = solve_cohesive(
            contact, indentation, box, start=(p, None), limit=limit, history=None, residual=residual
        )
        convolutions += state.convolutions
        if is_unique(state):
            return with_interaction(replace(state, convolutions=convolutions))
        gap *= 1.5


def rigid_pressure(contact: Contact, indentation: float, box: Box) -> Array:
    """Pressure (Pa) between rigid bodies, but zero below the gap of the largest attraction."""
    law, gap = nodes_of(contact, box), _base(contact, indentation, box, None)
    least = law.gap_of_largest_traction
    return np.where(gap > least, -law.traction(np.maximum(gap, least)), 0.0)


def with_interaction(state: CohesiveState) -> CohesiveState:
    """Set the adhesive work of `state` from its interaction energy and its adhesive loss."""
    return replace(state, adhesive_work=-state.interaction_energy - state.adhesive_loss)


def interacting_box(contact: Contact, indentation: float, history: State | None = None) -> Box:
    """Box of all nodes whose gap is small enough for the attraction to deform them."""
    if contact.periodic:
        return whole_grid(contact)
    law = law_of(contact)
    reach = _REACH * law.equilibrium_separation + law.length(contact.pair)
    gap = contact.gap if history is None else contact.gap + history.plastic_displacement
    box = bounding_box(gap < max(indentation + reach, reach * 1e-3))
    if box is None:  # the bodies are far apart: use the nodes with the smallest gaps
        box = bounding_box(gap <= gap.min() + reach)
        assert box is not None
    return box


def with_losses_of(state: CohesiveState, new: CohesiveState) -> CohesiveState:
    """`new`, an equilibrium on the branch of `state`, with the losses of `state`."""
    return with_interaction(
        replace(
            new,
            adhesive_loss=state.adhesive_loss,
            jumps=state.jumps,
            unaccounted=state.unaccounted,
        )
    )


def on_box(state: CohesiveState, box: Box, *, residual: float) -> CohesiveState:
    contact, indentation = state.contact, state.indentation
    inside = reframe(np.ones(shape_of(state.box), dtype=bool), state.box, box)
    p = np.where(
        inside,
        reframe(state.box_pressure, state.box, box),
        rigid_pressure(contact, indentation, box),
    )
    new = solve_cohesive(
        contact,
        indentation,
        box,
        start=(p, None),
        limit=state.bound,
        history=state,
        residual=residual,
    )
    plastic, error = contact.plasticity.work(state, new)
    return replace(
        with_losses_of(state, new),
        before=state.before,
        plastic_work=state.plastic_work + plastic,
        work_error=state.work_error + error,
    )


def is_unique(state: CohesiveState) -> bool:
    """Whether the equilibrium is unique at this distance of the bodies and at every larger one.

    That is so if the spectral radius of the matrix K diag(max(−φ″, 0)) is below 1; its largest row
    sum is a bound. In a periodic contact the row sums of K vanish, and the bound is the compliance
    λ/(πE*) under the longest wave times max(−φ″).
    """
    contact = state.contact
    if contact.periodic:
        return _is_unique_gap(contact, state.smallest_gap)
    softening = np.maximum(-nodes_of(contact, state.box).stiffness(box_gap(state)), 0.0)
    K = _operator(contact, state.box)
    return float(K(softening).max()) < _UNIQUE


def _is_unique_gap(contact: Contact, smallest_gap: float) -> bool:
    compliance = max(contact.grid.size) / (math.pi * contact.pair.contact_modulus)
    return compliance * law_of(contact).largest_softening(smallest_gap) < _UNIQUE


def _operator(contact: Contact, box: Box) -> Convolution:
    """Operator from pressure to displacement, on the CPU because this solver needs NumPy arrays."""
    build = periodic_half_space if contact.periodic else half_space
    with on_device(CPU):
        return build(shape_of(box), contact.grid.spacing, contact.pair.contact_modulus)


class PartOperators:
    """Approximate operators from pressure to displacement on parts of the grid of a contact."""

    def __init__(self, contact: Contact) -> None:
        self._grid, self._modulus = contact.grid, contact.pair.contact_modulus
        self._known: dict[tuple[int, int], Convolution] = {}

    def __call__(self, shape: tuple[int, int]) -> Convolution:
        if shape not in self._known:
            with on_device(CPU):
                self._known[shape] = approximate_half_space(
                    shape, self._grid.spacing, self._modulus
                )
        return self._known[shape]

    @property
    def count(self) -> int:
        return sum(K.count for K in self._known.values())


def _base(contact: Contact, indentation: float, box: Box, plastic: Array | None) -> Array:
    base: Array = contact.gap[box] + (law_of(contact).equilibrium_separation - indentation)
    if plastic is not None:
        base += plastic[box]
    return base


def _far(contact: Contact, indentation: float, box: Box) -> tuple[float, float]:
    if contact.periodic:
        return 0.0, 0.0
    law, grid, (rows, columns) = law_of(contact), contact.grid, box
    z0, everything = law.equilibrium_separation, slice(None)
    outside: tuple[Box, ...] = (
        (slice(0, rows.start), everything),
        (slice(rows.stop, None), everything),
        (rows, slice(0, columns.start)),
        (rows, slice(columns.stop, None)),
    )
    force = energy = 0.0
    for part in outside:
        energies, tractions = law.totals(contact.gap[part], z0 - indentation, 1.2 * z0)
        force -= tractions * grid.cell_area
        energy += energies * grid.cell_area
    # Outside the grid, each body is replaced by its smooth mean surface (`Contact.mean_offset`).
    # Force and energy are integrated outside a circle that has the area of the grid.
    R, (wide, long) = contact.pair.radius, grid.size
    edge = wide * long / (2 * math.pi * R) + contact.mean_offset + z0 - indentation
    edge = max(edge, 2 * z0)
    return (
        force + float(law.rigid_sphere_force(edge, R)),
        energy + float(law.rigid_sphere_energy(edge, R)),
    )
