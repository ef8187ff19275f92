"""The plastic work under a bound that changes with the indentation, summed over increments."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from restitution.contact.models import Load, Plasticity
from restitution.contact.state import Array, State
from restitution.numerics.box import Box, shape_of
from restitution.numerics.growing_bound import step_sums

# In each step, the pressure bound of a node grows. The error of the plastic work is a fraction of
# this growth times the plastic displacement of the step. The fraction is _RULE_ERROR for nodes that
# had yielded before the step, and _NEW_ERROR for nodes that begin to yield in the step. Both
# fractions come from a comparison with steps that are 11 times finer. At nodes that begin to yield,
# the mean of the bound during yielding is the bound before the step plus _NEW times the growth.
_RULE_ERROR, _NEW, _NEW_ERROR = 0.1, 0.8, 0.25
# Factor of this error if the bound falls where patches merge (evidence/size_effect).
_OF_MERGING = 3.0
# The plastic work is a sum over depths. The first depth is _SHALLOW times the indentation, and each
# further depth is at most _RATIO times the one before, because the error of a step holds up to this
# ratio.
_RATIO, _SHALLOW = 1.42, 0.2


class ChangingBound(Plasticity):
    """A bound of the pressure that is a function of the indentation."""

    grows = True
    for_periodic = False

    def begun(self, after: State) -> Array | float:
        """Bound (Pa) from which that of the first step, to `after`, has grown."""
        return after.contact.first_yield_pressure

    def work(self, before: State | None, after: State) -> tuple[float, float]:
        """Plastic work (J) of a step to at most 1.42 times the depth, and its error (J).

        Where nodes had yielded before, the plastic displacement is taken as linear in the
        indentation δ and the bound as linear in ln δ. The work per area of the displacement Δu is
        then Δu [b₁ + (b₂ − b₁) (δ₂/(δ₂ − δ₁) − 1/ln(δ₂/δ₁))].
        """
        contact, box, ratio = after.contact, after.box, math.inf
        begun, old = _on(self.begun(after), box), _on(0.0, box)
        if before is not None:
            begun, old = _on(before.bound, box), before.plastic_displacement[box]
            if before.indentation > 0:
                ratio = after.indentation / before.indentation
        given = after.plastic_displacement[box]
        whole, on, new = step_sums(given, old, begun, _on(after.bound, box))
        share = ratio / (ratio - 1) - 1 / math.log(ratio) if 1 < ratio < math.inf else 0.5
        work, error = share * on + _NEW * new, _RULE_ERROR * abs(on) + _NEW_ERROR * abs(new)
        error *= _OF_MERGING if self.size_effect else 1.0
        return (whole + work) * contact.grid.cell_area, error * contact.grid.cell_area

    def with_loading_work(self, state: State, start: State | None, load: Load) -> State:
        contact, indentation = state.contact, state.indentation
        if not state.plastic_displacement[state.box].any():
            return state
        first = _SHALLOW * indentation if start is None else start.indentation
        steps = max(1, math.ceil(math.log(indentation / first) / math.log(_RATIO) - 1e-9))
        depths = first * (indentation / first) ** (np.arange(steps) / steps)
        work, error, convolutions, before = 0.0, 0.0, 0, start
        if start is not None:
            work, error, depths = start.plastic_work, start.work_error, depths[1:]
        for depth in (*map(float, depths), indentation):
            now = state if depth == indentation else load(contact, depth, None)
            convolutions += now.convolutions
            increment, increment_error = self.work(before, now)
            work, error, before = work + increment, error + increment_error, now
        return replace(state, plastic_work=work, work_error=error, convolutions=convolutions)


def _on(bound: Array | float, box: Box) -> Array:
    if isinstance(bound, np.ndarray):
        return bound[box]
    shape = shape_of(box)
    return np.broadcast_to(np.full(shape[1], bound), shape)  # rows, as compiled loops need them
