"""The elastic pressure truncated at the yield pressure (Thornton and Ning 1998)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from restitution.arguments import typed
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import RESIDUAL, solve_nonadhesive
from restitution.contact.influence import half_space
from restitution.contact.models import WORK_RESIDUAL, Load, Plasticity, set_field
from restitution.contact.state import Array, State
from restitution.display import quantity
from restitution.errors import CaseError
from restitution.numerics.box import shape_of
from restitution.numerics.convolution.device import current
from restitution.numerics.quadrature import integrate_adaptively
from restitution.numerics.read_only import freeze

# Quadrature of the force. The tolerance is a fraction of the product of force and indentation. The
# margin is a multiple of the tolerance and is added to the error. If the integrand is the force
# that truncation removes, it is zero up to first yield. A single initial interval might then
# contain only one sampled depth above first yield, the last one. The quadrature therefore begins
# with several intervals (panels).
_TOLERANCE, _MARGIN, _PANELS = 3e-5, 10.0, 4

# Largest relative difference of COR from finite elements (docs/validation.md), at the values of the
# COR due to plasticity alone.
_RESTITUTION = (0.26, 0.45, 0.48, 0.53, 0.595, 0.61, 0.69, 0.72, 0.8, 0.9999, 1.0)
_DIFFERENCE = (0.3, 0.65, 0.65, 0.55, 0.45, 0.37, 0.3, 0.18, 0.17, 0.11, 0.07)


@typed
@dataclass(frozen=True)
class Truncated(Plasticity):
    """The elastic pressure is truncated at the yield pressure, without redistributing the excess.

    Attributes:
        yield_pressure: Pressure (Pa) at which the surface yields.

    Raises:
        CaseError: The yield pressure is not positive.

    Source:
        C. Thornton, Z. Ning, Powder Technol. 99 (1998) 154–162.
    """

    yield_pressure: float

    label = "truncated"
    bounds_solve = False
    for_periodic = False
    strengths = ("yield_pressure",)

    def __post_init__(self) -> None:
        set_field(self, "yield_pressure", "Pa")

    @property
    def hardness(self) -> float:
        """Yield pressure (Pa)."""
        return self.yield_pressure

    def describe(self) -> str:
        return f"yield pressure {quantity(self.yield_pressure, 'Pa')} ({self.label})"

    def bound(
        self, contact: Contact, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        return np.inf, 0

    def require_step(self, state: State, indentation: float) -> None:
        if indentation > state.indentation:
            raise CaseError(
                'indentation: a contact with plasticity "truncated" can only be unloaded; for a '
                "larger indentation, solve it anew from the undeformed bodies"
            )

    def finish(self, state: State) -> State:
        """Truncate the elastic pressure.

        The truncated pressure deforms the bodies less, so their surfaces overlap in the contact and
        beside it. This overlap becomes the plastic displacement, so that unloading starts from the
        truncated pressure.
        """
        contact, indentation, box = state.contact, state.indentation, state.box
        pressure = np.minimum(state.box_pressure, self.yield_pressure)
        K = half_space(shape_of(box), contact.grid.spacing, contact.pair.contact_modulus)
        device = current()
        displacement = device.get(K(device.put(pressure)))
        plastic = np.zeros(contact.grid.nodes)
        plastic[box] = np.maximum(indentation - contact.gap[box] - displacement, 0.0)
        return replace(
            state,
            box_pressure=freeze(pressure),
            plastic_displacement=freeze(plastic),
            bound=self.yield_pressure,
            box_displacement=freeze(displacement),
            convolutions=state.convolutions + 1,
        )

    def with_loading_work(self, state: State, start: State | None, load: Load) -> State:
        """Integrate the truncated force, without adhesion; the plastic work is what remains.

        While the force that truncation removes is smaller than the remaining force, the removed
        force is integrated and subtracted from the elastic energy, which is more accurate.
        """
        contact, indentation = state.contact, state.indentation
        convolutions = 0

        def elastic(depth: float, residual: float) -> State:
            nonlocal convolutions
            solved = solve_nonadhesive(contact, depth, np.inf, residual)
            convolutions += solved.convolutions
            return solved

        end = solve_nonadhesive(contact, indentation, np.inf, RESIDUAL)
        by_excess = end.force < 2 * self._force(end)

        def integrand(whole: State) -> float:
            truncated = self._force(whole)
            return whole.force - truncated if by_excess else truncated

        first, value, energy, work, error = 0.0, 0.0, 0.0, 0.0, 0.0
        if start is not None:
            begin = elastic(start.indentation, RESIDUAL)
            first, value, energy = start.indentation, integrand(begin), begin.stored_energy
            work, error = start.loading_work, start.work_error
        increment, increment_error = 0.0, 0.0
        if integrand(end) > 0:
            tolerance = _TOLERANCE * self._force(end) * indentation
            increment, increment_error = integrate_adaptively(
                lambda depth: integrand(elastic(depth, WORK_RESIDUAL)),
                first,
                indentation,
                value,
                integrand(end),
                tolerance,
                panels=_PANELS,
            )
            # The quadrature compares two rules to estimate its error. Nodes yield one after the
            # other, so the force has many small kinks, and the rules can agree by chance. In
            # validation contacts, errors reached nine times the tolerance.
            increment_error += _MARGIN * tolerance
        if by_excess:
            increment = end.stored_energy - energy - increment
        return replace(
            state,
            plastic_work=work + increment - state.stored_energy,
            adhesive_work=0.0,
            work_error=error + increment_error,
            convolutions=convolutions + end.convolutions + state.convolutions,
        )

    def _force(self, elastic: State) -> float:
        """Truncated force (N)."""
        truncated = np.minimum(elastic.box_pressure, self.yield_pressure)
        return float(truncated.sum()) * elastic.contact.grid.cell_area

    def difference(self, contact: Contact, restitution: float) -> float:
        return float(np.interp(restitution, _RESTITUTION, _DIFFERENCE))
