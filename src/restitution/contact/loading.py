"""Loading the undeformed bodies to one indentation, and the work that takes.

Under the yield bound the state of a monotonic loading does not depend on its path, so one solve
from the undeformed bodies is enough. Without adhesion the work is then W = E_el + p_y V_p; with a
cut pressure (`truncated`) or with adhesion on approach it is the integral of the force.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from restitution.contact.adhesion import grow_contact, unload_adhesive
from restitution.contact.cavity import yield_bound
from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import (
    RESIDUAL,
    candidate_box,
    separated_state,
    solve_pressure,
)
from restitution.contact.influence import half_space
from restitution.contact.state import State
from restitution.errors import CaseError
from restitution.numerics.box import Box, bounding_box, shape_of
from restitution.numerics.quadrature import integrate_adaptively
from restitution.numerics.read_only import freeze

Array = NDArray[np.float64]

PULL_INCREMENT = 1e-10  # m: the pull after each loading increment (Ghanbarzadeh et al. 2019, §2.2)
_TRUNCATION_TOLERANCE = 3e-5  # of force times indentation, where the work needs quadrature
_TRUNCATION_MARGIN = 10.0  # tolerances that are added to the error of that quadrature
_TRUNCATION_PANELS = 4  # the force cut off is zero up to first yield, wherever that is
# The force of an adhesive contact jumps as asperities come in: more is asked of it in vain. 1.5e-3
# of the work is at most 0.00075 in restitution.
_ADHESIVE_TOLERANCE = 1.5e-3
_ADHESIVE_HALVINGS = 5
# Nodes come in one after the other, and which of them do depends on the steps: against 240 steps
# from first touch, the work of blind contacts was off by up to this share of w times the area (93 %
# of 29 contacts with `equilibrium`, all of 11 with `pull-increments`), whatever the quadrature.
_PINNING = {"equilibrium": 0.02, "pull-increments": 0.006, "hertzian": 0.0}
# Depths between which the plastic work is summed grow by this ratio at most; from this part of the
# indentation on. Errors are parts of what the growth of the bound adds to the work of a step, for
# nodes that had yielded before it and for those that begin to (against 11 times as many depths).
_RATIO, _SHALLOW = 1.42, 0.2
_RULE_ERROR, _NEW, _NEW_ERROR = 0.1, 0.8, 0.25
_WORK_RESIDUAL = 1e-6  # of the solves in between, whose force errors stay well below that


def solve(
    contact: Contact, indentation: float, *, start: State | None = None, residual: float = RESIDUAL
) -> State:
    """Load the undeformed bodies to `indentation` (m) in one solve and return the state there.

    `start`, a shallower state of the same contact, serves as the point from which the work is
    integrated where it has to be (`truncated`, or adhesion on approach; else that is first touch),
    and with adhesion on approach as first guess. Raises `CaseError` for an indentation that is not
    positive or a start on another grid, `NotConvergedError` when `residual` is not reached, and
    `DomainError` when the contact reaches the edge of the grid.
    """
    if not 0 < indentation < math.inf:
        raise CaseError(f"indentation: {indentation} m is not a positive depth")
    if start is not None and start.contact.grid != contact.grid:
        raise CaseError("start: a state on another grid cannot start this contact")
    state = solve_without_work(contact, indentation, start=start, residual=residual)
    state = with_work(state, start)
    require_inside_grid(state)
    return state


def step(state: State, indentation: float, *, residual: float = RESIDUAL) -> State:
    """Move a deformed contact to another `indentation` (m), deeper or shallower.

    What has yielded stays yielded, and what adheres lets go only where it has to. Raises as
    `solve`, and `CaseError` for deeper loading of a `truncated` contact, which has no law for
    loading a deformed surface.
    """
    contact = state.contact
    if not math.isfinite(indentation):
        raise CaseError(f"indentation: {indentation} m is not a depth")
    if contact.plasticity == "truncated" and indentation > state.indentation:
        raise CaseError("a truncated contact can only be unloaded; use solve for a deeper one")
    if contact.adhesive:
        new = unload_adhesive(state, indentation, residual=residual)
    else:
        limit, convolutions = state.bound, 0
        if contact.grows and indentation > state.indentation:
            grown, convolutions = yield_bound(contact, indentation, residual)
            limit = freeze(np.maximum(limit, grown))
        new = solve_nonadhesive(contact, indentation, limit, residual, history=state)
        if contact.grows:
            work, _ = _plastic_work(state, new)
            new = replace(
                new,
                plastic_work=state.plastic_work + work,
                convolutions=new.convolutions + convolutions,
            )
    require_inside_grid(new)
    return replace(new, is_first_loading=False)


def solve_without_work(
    contact: Contact, indentation: float, *, start: State | None, residual: float
) -> State:
    """`solve` without its work, and letting contact at the edge of the grid pass."""
    limit, convolutions = _limit_at(contact, indentation, residual)
    if contact.adhesive and contact.approach == "equilibrium":
        shallower = start if start is not None and start.indentation <= indentation else None
        if shallower is None:
            held = contact.gap <= indentation
            box = bounding_box(held)
            assert box is not None  # the gap is zero at first touch
            held = held[box]
        else:
            box, held = shallower.box, shallower.box_pressure != 0
        state = grow_contact(
            contact,
            indentation,
            box,
            held,
            limit=limit,
            first_guess=None if start is None else start.pressure_on(box),
            residual=residual,
        )
    elif contact.adhesive and contact.approach == "pull-increments":
        # The pull may let go of everything: the state is then parted, with zero force.
        pressed = solve_nonadhesive(contact, indentation + PULL_INCREMENT, limit, residual)
        state = unload_adhesive(pressed, indentation, residual=residual)
        state = replace(state, adhesive_work=0.0, is_first_loading=True)
    else:
        state = solve_nonadhesive(contact, indentation, limit, residual)
    if contact.truncates:
        state = truncate_pressure(state)
    return replace(state, convolutions=state.convolutions + convolutions)


def _limit_at(contact: Contact, indentation: float, residual: float) -> tuple[Array | float, int]:
    """The pressure bound of the solve, Pa, and the convolutions that finding it took.

    It is infinite where the pressure is truncated afterwards.
    """
    if contact.grows:
        return yield_bound(contact, max(indentation, 0.0), residual)
    return (math.inf if contact.truncates else contact.yield_pressure), 0


def solve_nonadhesive(
    contact: Contact,
    indentation: float,
    limit: Array | float,
    residual: float,
    history: State | None = None,
) -> State:
    """The contact without adhesion, always from nothing: coarser grids beat any earlier state."""
    box = candidate_box(contact, indentation, history)
    if box is None:
        return separated_state(contact, indentation, history)
    return solve_pressure(
        contact, indentation, box, limit=limit, history=history, residual=residual
    )


def truncate_pressure(elastic: State) -> State:
    """Truncate the elastic pressure at p_y; the rest of the contact does not take up what is cut.

    Force and area are then those of Thornton and Ning (1998). The plastic displacement is what the
    cut pressure leaves of the interference (next to the contact too), so that unloading starts from
    the cut pressure.
    """
    contact, indentation, box = elastic.contact, elastic.indentation, elastic.box
    pressure = np.minimum(elastic.box_pressure, contact.yield_pressure)
    K = half_space(shape_of(box), contact.grid.spacing, contact.pair.contact_modulus)
    displacement = K(pressure)
    plastic = np.zeros(contact.grid.nodes)
    plastic[box] = np.maximum(indentation - contact.gap[box] - displacement, 0.0)
    return replace(
        elastic,
        box_pressure=freeze(pressure),
        plastic_displacement=freeze(plastic),
        bound=contact.yield_pressure,
        box_displacement=freeze(displacement),
        convolutions=elastic.convolutions + 1,
    )


def work_is_integrated(contact: Contact) -> bool:
    """Whether the loading work of `contact` is an integral, with an error."""
    if contact.truncates or contact.grows:
        return True
    return contact.adhesive and contact.approach != "hertzian"


def with_work(state: State, start: State | None) -> State:
    """A state of `solve_without_work` with its work: from `start` or first touch if it is ∫F dδ."""
    contact, indentation = state.contact, state.indentation
    if not work_is_integrated(contact):
        return state
    if start is None or not start.is_first_loading or start.indentation >= indentation:
        start = None
    gain = contact.work_of_adhesion * state.contact_area
    if contact.grows:
        plastic, error, convolutions = _work_by_increments(state, start)
        convolutions += state.convolutions
        state = replace(state, plastic_work=plastic, convolutions=convolutions)
        if not contact.adhesive or contact.approach == "hertzian":
            return replace(state, work_error=error)
    known = state.stored_energy + state.plastic_work
    if _gain_hardly_matters(state):
        # Integrated works were between 0.37 and 0.93 of w times the area, most of them above 0.7.
        return replace(state, adhesive_work=gain, work_error=0.5 * gain)
    if contact.adhesive and contact.approach != "hertzian":
        work, error, convolutions = _work_by_force(state, start)
    else:
        work, error, convolutions = _work_by_truncation(state, start)
    convolutions += state.convolutions
    if contact.plasticity == "truncated":
        # The cut pressure's plastic work is what is left of the work; it has no formula of its own.
        return replace(
            state,
            plastic_work=work - state.stored_energy,
            adhesive_work=0.0,
            work_error=error,
            convolutions=convolutions,
        )
    return replace(state, adhesive_work=known - work, work_error=error, convolutions=convolutions)


def _gain_hardly_matters(state: State) -> bool:
    """Whether all that adhesion can have done on approach is within the tolerance of the work."""
    contact = state.contact
    if not contact.adhesive or contact.approach != "equilibrium":
        return False
    if contact.truncates or contact.grows:
        return False
    gain = contact.work_of_adhesion * state.contact_area
    return gain <= 2 * _ADHESIVE_TOLERANCE * (state.stored_energy + state.plastic_work)


def _work_by_force(state: State, start: State | None) -> tuple[float, float, int]:
    """Work, its error and the convolutions it took, by quadrature of the force."""
    contact, indentation = state.contact, state.indentation
    guess, convolutions = start, 0

    def force_at(depth: float) -> float:
        nonlocal guess, convolutions
        guess = solve_without_work(contact, depth, start=guess, residual=_WORK_RESIDUAL)
        convolutions += guess.convolutions
        return guess.force

    first, first_force, work, error = 0.0, 0.0, 0.0, 0.0
    if start is not None:
        first, first_force = start.indentation, start.force
        work, error = start.loading_work, start.work_error - _pinning_error(start)
    elif contact.approach == "equilibrium":
        first_force = force_at(0.0)  # jump-in
    scale = abs(work) + 0.5 * (abs(first_force) + abs(state.force)) * (indentation - first)
    increment, its_error = integrate_adaptively(
        force_at,
        first,
        indentation,
        first_force,
        state.force,
        _ADHESIVE_TOLERANCE * scale,
        depth=_ADHESIVE_HALVINGS,
    )
    return work + increment, error + its_error + _pinning_error(state), convolutions


def _work_by_increments(state: State, start: State | None) -> tuple[float, float, int]:
    """Plastic work under a bound that grows, its error, and the convolutions it took.

    It is summed over depths that grow by `_RATIO` at most, from `start` or from where nearly
    nothing has yielded.
    """
    contact, indentation = state.contact, state.indentation
    first = _SHALLOW * indentation if start is None else start.indentation
    steps = max(1, math.ceil(math.log(indentation / first) / math.log(_RATIO) - 1e-9))
    depths = first * (indentation / first) ** (np.arange(steps) / steps)
    work, error, convolutions, before = 0.0, 0.0, 0, start
    if start is not None:
        work, error, depths = start.plastic_work, start.work_error, depths[1:]
    for depth in (*map(float, depths), indentation):
        now = state
        if depth != indentation:
            now = solve_without_work(contact, depth, start=None, residual=_WORK_RESIDUAL)
            convolutions += now.convolutions
        increment, its_error = _plastic_work(before, now)
        work, error, before = work + increment, error + its_error, now
    return work, error, convolutions


def _plastic_work(before: State | None, after: State) -> tuple[float, float]:
    """Work (J) of yielding from one state to the next, at most `_RATIO` as deep, and its error.

    Each node yields by Δu under bounds that grow from b₁ to b₂. With u linear in the indentation
    δ, and b in its logarithm, its work is Δu [b₁ + (b₂ − b₁) (δ₂/(δ₂ − δ₁) − 1/ln(δ₂/δ₁))]. A node
    that begins to yield in this step does so under bounds nearer to b₂: the share of b₂ − b₁ is
    `_NEW`. The error is a part of what b₂ − b₁ adds, `_RULE_ERROR` or `_NEW_ERROR`.
    """
    contact, box = after.contact, after.box
    given, begun = after.plastic_displacement[box], np.asarray(contact.first_yield_pressure)
    old, ratio = np.zeros(1, dtype=bool), math.inf
    if before is not None:
        begun = _on(before.bound, box)
        old = before.plastic_displacement[box] > 0
        given = given - before.plastic_displacement[box]
        if before.indentation > 0:
            ratio = after.indentation / before.indentation
    share = ratio / (ratio - 1) - 1 / math.log(ratio) if 1 < ratio < math.inf else 0.5
    area = contact.grid.cell_area
    whole = float(np.sum(given * begun)) * area
    growth = given * (_on(after.bound, box) - begun)
    on, new = (float(np.sum(growth, where=nodes)) * area for nodes in (old, ~old))
    return whole + share * on + _NEW * new, _RULE_ERROR * abs(on) + _NEW_ERROR * abs(new)


def _on(bound: Array | float, box: Box) -> Array:
    """A bound of each node, or one for all, on a box of the grid."""
    return np.asarray(bound) if np.ndim(bound) == 0 else np.asarray(bound)[box]


def _pinning_error(state: State) -> float:
    """Error of the work (J) because the grid holds the edge of the contact between its nodes."""
    contact = state.contact
    return _PINNING[contact.approach] * contact.work_of_adhesion * state.contact_area


def _work_by_truncation(state: State, start: State | None) -> tuple[float, float, int]:
    """The same for a cut pressure without adhesion on approach.

    What the cut takes away integrates to the elastic energy less the work: exact below yield, and
    the better of the two integrals until it takes more than it leaves.
    """
    contact, indentation = state.contact, state.indentation
    p_y, area = contact.yield_pressure, contact.grid.cell_area
    convolutions = 0

    def elastic(depth: float, residual: float) -> State:
        nonlocal convolutions
        state = solve_nonadhesive(contact, depth, math.inf, residual)
        convolutions += state.convolutions
        return state

    def truncated_force(whole: State) -> float:
        return float(np.minimum(whole.box_pressure, p_y).sum()) * area

    end = solve_nonadhesive(contact, indentation, math.inf, RESIDUAL)
    by_excess = end.force < 2 * truncated_force(end)

    def integrand(whole: State) -> float:
        truncated = truncated_force(whole)
        return whole.force - truncated if by_excess else truncated

    first, value, energy, work, error = 0.0, 0.0, 0.0, 0.0, 0.0
    if start is not None:
        begin = elastic(start.indentation, RESIDUAL)
        first, value, energy = start.indentation, integrand(begin), begin.stored_energy
        work, error = start.loading_work, start.work_error
    increment, its_error = 0.0, 0.0
    if integrand(end) > 0:
        tolerance = _TRUNCATION_TOLERANCE * truncated_force(end) * indentation
        increment, its_error = integrate_adaptively(
            lambda depth: integrand(elastic(depth, _WORK_RESIDUAL)),
            first,
            indentation,
            value,
            integrand(end),
            tolerance,
            panels=_TRUNCATION_PANELS,
        )
        # Nodes yield one after the other, so the force has many small kinks, between which the
        # two rules may agree by chance: blind contacts were off by up to nine tolerances.
        its_error += _TRUNCATION_MARGIN * tolerance
    if by_excess:
        increment = end.stored_energy - energy - increment
    return work + increment, error + its_error, convolutions + end.convolutions
