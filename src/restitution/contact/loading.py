"""Load the undeformed bodies to one indentation, and compute the loading work.

The state of monotonic loading under a pressure bound does not depend on the path, so one solve from
the undeformed bodies is enough. (Cohesive contacts follow the whole loading path.) The computation
of the loading work depends on the models:

* Constant pressure bound, no adhesion on approach: the loading work is the elastic energy plus the
  bound times the plastic volume.
* Plasticity `truncated`, or adhesion on approach: the force is integrated over the indentation.
* Growing pressure bound (`expanding-cavity`): the plastic work is summed over increments of the
  indentation.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from restitution.arguments import typed
from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.cohesive.equilibrium import CohesiveState
from restitution.contact.cohesive.path import load_cohesive, step_cohesive
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import (
    RESIDUAL,
    candidate_box,
    separated_state,
    solve_pressure,
)
from restitution.contact.influence import half_space
from restitution.contact.jkr.area import balances_are_reliable, grow_contact, unload_adhesive
from restitution.contact.jkr.loading_work import pinning_error, work_by_balance, work_by_force
from restitution.contact.plasticity.cavity import bound_after, pressure_bound
from restitution.contact.plasticity.plastic_work import plastic_work
from restitution.contact.state import Array, State
from restitution.errors import CaseError
from restitution.numerics.box import bounding_box, shape_of
from restitution.numerics.convolution.device import current
from restitution.numerics.quadrature import integrate_adaptively
from restitution.numerics.read_only import freeze

# Retraction after each loading increment (m) (Ghanbarzadeh et al. 2019, §2.2).
PULL_INCREMENT = 1e-10
# Quadrature of the force of a truncated contact. The tolerance is a fraction of the product of
# force and indentation. The margin is a multiple of the tolerance and is added to the error. If the
# integrand is the force that truncation removes, it is zero up to first yield. A single initial
# interval might then contain only one sampled depth above first yield, the last one. The quadrature
# therefore begins with several intervals (panels).
_TRUNCATION_TOLERANCE, _TRUNCATION_MARGIN, _TRUNCATION_PANELS = 3e-5, 10.0, 4
# Relative tolerance of the integral of an adhesive force. The force jumps as asperities attach,
# which limits the accuracy. A relative error of 1.5e-3 of the loading work changes COR by at most
# 0.00075.
_ADHESIVE_TOLERANCE = 1.5e-3
# If the pressure bound grows with deformation, the plastic work is a sum over depths. The first
# depth is _SHALLOW times the indentation, and each further depth is at most _RATIO times the one
# before, because the error estimate of `plastic_work` holds up to this ratio.
_RATIO, _SHALLOW = 1.42, 0.2
_WORK_RESIDUAL = 1e-6  # tolerance of intermediate solves; the force is far more accurate than this


@typed
def solve(
    contact: Contact, indentation: float, *, start: State | None = None, residual: float = RESIDUAL
) -> State:
    """Load the undeformed bodies to `indentation` in one solve.

    Args:
        contact: Contact to load.
        indentation: Approach of the bodies (m), positive.
        start: Shallower state of the same contact. If the work is integrated (`expanding-cavity`,
            `truncated`, or adhesion on approach), the integral starts from this state instead of
            first touch. With adhesion on approach this state is also the first guess.
        residual: Tolerance on the violation of the contact conditions (dimensionless), relative to
            the largest overlap of the undeformed surfaces or, with adhesion, to
            `Contact.residual_length`.

    Returns:
        State at `indentation`.

    Raises:
        CaseError: The indentation is not positive, or `start` is on another grid.
        NotConvergedError: The tolerance was not reached.
        DomainError: The contact reaches the edge of the grid.
    """
    if not 0 < indentation < math.inf:
        raise CaseError(f"indentation: {indentation} m is not a positive depth")
    if start is not None and start.contact.grid != contact.grid:
        raise CaseError("start: is on another grid; give a state on the grid of this contact")
    state = with_work(
        solve_without_work(contact, indentation, start=start, residual=residual), start
    )
    require_inside_grid(state)
    return state


@typed
def step(state: State, indentation: float, *, residual: float = RESIDUAL) -> State:
    """Move a deformed contact to another indentation, deeper or shallower.

    Plastic displacement is permanent, and adhering nodes stay in contact until the detachment
    criterion releases them.

    Args:
        state: State to start from.
        indentation: New approach of the bodies (m).
        residual: Tolerance on the violation of the contact conditions (dimensionless), as in
            `solve`.

    Returns:
        State at `indentation`.

    Raises:
        CaseError: The indentation is not finite, or a `truncated` contact would be loaded deeper.
            (This model does not define further loading of deformed surfaces.)
        NotConvergedError: The tolerance was not reached.
        DomainError: The contact reaches the edge of the grid.
    """
    contact = state.contact
    if not math.isfinite(indentation):
        raise CaseError(f"indentation: {indentation} m is not a finite depth")
    if contact.plasticity == "truncated" and indentation > state.indentation:
        raise CaseError(
            'indentation: a contact with plasticity "truncated" can only be unloaded; for a larger '
            "indentation, solve it anew from the undeformed bodies"
        )
    if isinstance(state, CohesiveState):
        return step_cohesive(state, indentation, residual=residual)
    if contact.adhesive:
        new = unload_adhesive(state, indentation, residual=residual)
    else:
        limit, convolutions = bound_after(state, indentation, residual)
        new = solve_nonadhesive(contact, indentation, limit, residual, history=state)
        if contact.grows:
            work, _ = plastic_work(state, new)
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
    """Do the same as `solve`, but leave out the loading work and the check of the grid edge.

    The state of a cohesive contact contains its work in any case, because the whole loading path is
    followed to find this state.
    """
    if contact.cohesive:
        return load_cohesive(contact, indentation, start=start, residual=residual)
    limit, convolutions = pressure_bound(contact, indentation, residual)
    if contact.truncates:
        limit = math.inf  # the pressure is truncated after the solve
    if contact.adhesive and contact.approach == "equilibrium":
        shallower = start if start is not None and start.indentation <= indentation else None
        if shallower is not None and contact.detachment == "pohrt-popov":
            box, held = shallower.box, shallower.box_pressure != 0
        else:
            # A contact that grows from a smaller one can stop growing too early, before the energy
            # release rate along its edge has fallen to the work of adhesion. So the search starts
            # from all nodes that overlap at this indentation, and then releases nodes.
            inside = contact.gap <= indentation
            if shallower is not None:
                inside[shallower.box] |= shallower.box_pressure != 0
            found = bounding_box(inside)
            assert found is not None  # the gap is zero at the node that touches first
            box, held = found, inside[found]
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
        # If the retraction releases all nodes, the result is a state out of contact, not an error.
        pressed = solve_nonadhesive(contact, indentation + PULL_INCREMENT, limit, residual)
        state = unload_adhesive(pressed, indentation, residual=residual)
        state = replace(state, adhesive_work=0.0, is_first_loading=True)
    else:
        state = solve_nonadhesive(contact, indentation, limit, residual)
    if contact.truncates:
        state = truncate_pressure(state)
    return replace(state, convolutions=state.convolutions + convolutions)


def solve_nonadhesive(
    contact: Contact,
    indentation: float,
    limit: Array | float,
    residual: float,
    history: State | None = None,
) -> State:
    """Solve the contact without adhesion.

    The first guess is the solution on coarser grids. It is nearer to the result than the pressure
    of an earlier state would be.
    """
    box = candidate_box(contact, indentation, history)
    if box is None:
        return separated_state(contact, indentation, history)
    return solve_pressure(
        contact, indentation, box, limit=limit, history=history, residual=residual
    )


def truncate_pressure(elastic: State) -> State:
    """Truncate the elastic pressure at the yield pressure, without redistributing the excess.

    Force and area are then those of Thornton and Ning (1998). The truncated pressure deforms the
    bodies less, so their surfaces overlap in the contact and beside it. This overlap becomes the
    plastic displacement, so that unloading starts from the truncated pressure.
    """
    contact, indentation, box = elastic.contact, elastic.indentation, elastic.box
    pressure = np.minimum(elastic.box_pressure, contact.yield_pressure)
    K = half_space(shape_of(box), contact.grid.spacing, contact.pair.contact_modulus)
    device = current()
    displacement = device.get(K(device.put(pressure)))
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
    """Whether the loading work of `contact` is integrated numerically and so has an error."""
    return contact.truncates or contact.grows or _adheres_on_approach(contact)


def _adheres_on_approach(contact: Contact) -> bool:
    return contact.adhesive and contact.approach != "hertzian"


def with_work(state: State, start: State | None) -> State:
    """Add the loading work to a `state` that `solve_without_work` has returned.

    If the work has to be integrated, the integral begins at `start` or, if None, at first touch.
    """
    contact, indentation = state.contact, state.indentation
    if contact.cohesive or not work_is_integrated(contact):
        return state
    if start is None or not start.is_first_loading or start.indentation >= indentation:
        start = None
    gain = contact.work_of_adhesion * state.contact_area
    if contact.grows:
        state = _with_increments(state, start)
        if not _adheres_on_approach(contact):
            return state
    if _adhesive_work_is_negligible(state):
        # The adhesive work is set to its largest possible value, the work of adhesion times the
        # contact area. In contacts for which it was integrated, it was 0.37 to 0.93 times this
        # value, and above 0.7 times in most of them. The error covers this range.
        return replace(state, adhesive_work=gain, work_error=0.65 * gain)
    if _adheres_on_approach(contact):
        balanced = contact.approach == "equilibrium" and balances_are_reliable(state)
        if balanced and not contact.truncates:
            work, error, convolutions = work_by_balance(
                state, start, _intermediate, _ADHESIVE_TOLERANCE
            )
            if start is not None:
                error += start.work_error - pinning_error(start)
            error += pinning_error(state)
        else:
            work, error, convolutions = work_by_force(
                state, start, _intermediate, _ADHESIVE_TOLERANCE
            )
    else:
        work, error, convolutions = _work_by_truncation(state, start)
    convolutions += state.convolutions
    if contact.plasticity == "truncated":
        # There is no formula for the plastic work of a truncated pressure. It is computed as the
        # integrated work minus the elastic energy.
        return replace(
            state,
            plastic_work=work - state.stored_energy,
            adhesive_work=0.0,
            work_error=error,
            convolutions=convolutions,
        )
    adhesive_work = state.stored_energy + state.plastic_work - work
    return replace(state, adhesive_work=adhesive_work, work_error=error, convolutions=convolutions)


def _adhesive_work_is_negligible(state: State) -> bool:
    """Whether the work of adhesion times contact area is small compared with the mechanical work.

    The mechanical work is elastic energy plus plastic work. If the result is true, the adhesive
    work on approach is not integrated.
    """
    contact = state.contact
    if contact.approach != "equilibrium" or contact.truncates or contact.grows:
        return False
    gain = contact.work_of_adhesion * state.contact_area
    return contact.adhesive and gain <= 2 * _ADHESIVE_TOLERANCE * (
        state.stored_energy + state.plastic_work
    )


def _intermediate(contact: Contact, depth: float, start: State | None = None) -> State:
    return solve_without_work(contact, depth, start=start, residual=_WORK_RESIDUAL)


def _with_increments(state: State, start: State | None) -> State:
    """Add the plastic work under a growing bound, and the error of this work.

    The work is a sum over increasing depths, beginning at `start` or, if None, at `_SHALLOW` times
    the indentation, where little has yielded.
    """
    contact, indentation = state.contact, state.indentation
    first = _SHALLOW * indentation if start is None else start.indentation
    steps = max(1, math.ceil(math.log(indentation / first) / math.log(_RATIO) - 1e-9))
    depths = first * (indentation / first) ** (np.arange(steps) / steps)
    work, error, convolutions, before = 0.0, 0.0, 0, start
    if start is not None:
        work, error, depths = start.plastic_work, start.work_error, depths[1:]
    for depth in (*map(float, depths), indentation):
        now = state if depth == indentation else _intermediate(contact, depth)
        convolutions += now.convolutions
        increment, its_error = plastic_work(before, now)
        work, error, before = work + increment, error + its_error, now
    return replace(state, plastic_work=work, work_error=error, convolutions=convolutions)


def _work_by_truncation(state: State, start: State | None) -> tuple[float, float, int]:
    """Return work, error and convolutions, as `work_by_force` does, for truncated pressures.

    The approach must have no adhesion. The work is computed in one of two ways. The first
    integrates the truncated force. The second integrates the force that truncation removes, and
    subtracts this integral from the energy of the elastic contact. The second integrand is zero
    below first yield. The second way is used while the removed force is smaller than the remaining
    force, because it is then more accurate.
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
        # The quadrature compares two rules to estimate its error. Nodes yield one after the other,
        # so the force has many small kinks, and the rules can agree by chance. In validation
        # contacts, errors reached nine times the tolerance.
        its_error += _TRUNCATION_MARGIN * tolerance
    if by_excess:
        increment = end.stored_energy - energy - increment
    return work + increment, error + its_error, convolutions + end.convolutions
