"""Tangential contact at a fixed normal pressure: stick, slip and friction loss at every node.

The bodies move relative to each other by U along x, and the traction q along x moves their surfaces
by C q. The slip of a node is s = U − C q. From one state to the next, the traction minimises

    ½ qᵀC q − qᵀ(U − s₀)   subject to   −µ p ≤ q ≤ µ p,

where s₀ is the slip before the step. Like Cattaneo (1938) and Mindlin (1949), this neglects the
traction along y and the influence of traction on pressure and yield.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.contact.equilibrium import MAX_ITERATIONS, RESIDUAL, require_converged
from restitution.contact.influence import inverse_half_space, shear_half_space
from restitution.contact.state import Array, State
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import CaseError
from restitution.numerics.box import NOWHERE, Box, bounding_box, reframe, shape_of, union
from restitution.numerics.convolution.device import current
from restitution.numerics.quadratic.minimise import BoundedQuadratic, minimise_quadratic
from restitution.numerics.read_only import freeze, read_only


@dataclass(frozen=True, eq=False)
class TangentialState:
    """A contact in tangential equilibrium.

    Attributes:
        normal: Normal state, whose pressure limits the traction.
        friction: Coefficient of friction µ (dimensionless).
        displacement: Tangential displacement U of the bodies (m).
        box: Block of the grid outside of which the traction is zero.
        box_traction: Traction along x (Pa) on `box`.
        box_displacement: Displacement C q along x of the two surfaces relative to each other (m) on
            `box`.
        friction_loss: Energy lost to friction so far (J).
        residual: Largest violation of the conditions of stick and slip (dimensionless), relative to
            the largest displacement.
        convolutions: Number of convolutions computed in the solve.
    """

    normal: State
    friction: float
    displacement: float
    box: Box
    box_traction: Array
    box_displacement: Array
    friction_loss: float
    residual: float
    convolutions: int

    def __post_init__(self) -> None:
        for name in ("box_traction", "box_displacement"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def force(self) -> float:
        """Tangential force (N), the sum of the traction over all nodes times the cell area."""
        return float(self.box_traction.sum()) * self.normal.contact.grid.cell_area

    @property
    def stored_energy(self) -> float:
        """Elastic energy (J) due to the traction: ½ ∫ traction × `box_displacement` dA."""
        twice = float(np.einsum("ij,ij->", self.box_traction, self.box_displacement))
        return 0.5 * twice * self.normal.contact.grid.cell_area

    @property
    def slip(self) -> Array:
        """Slip (m) on `box`: `displacement` of the bodies minus elastic `box_displacement`."""
        return self.displacement - self.box_displacement

    @property
    def sticking(self) -> NDArray[np.bool_]:
        """Whether each node of `box` sticks (bool), with a traction below Coulomb's limit."""
        return np.abs(self.box_traction) < _limit(self.normal, self.friction, self.box)

    def _summary(self) -> list[str]:
        nodes = int(self.sticking.sum())
        return [
            f"displacement {quantity(self.displacement, 'm')}, force {quantity(self.force, 'N')}",
            f"{nodes} of {self.normal.contact_nodes} nodes in contact stick",
            f"stored energy {quantity(self.stored_energy, 'J')}, "
            f"friction loss {quantity(self.friction_loss, 'J')}",
        ]

    __repr__ = summary_text
    _repr_html_ = summary_html


def shear(
    normal: State,
    displacement: float,
    friction: float,
    *,
    history: TangentialState | None = None,
    residual: float = RESIDUAL,
) -> TangentialState:
    """Move the bodies of a contact along x, to a prescribed tangential displacement.

    The energy lost to friction is the slip in this step times the mean of the tractions before and
    after the step. With the mean tangential force, the work is exactly the change of the stored
    energy plus the loss.

    Args:
        normal: Normal state after the step, without adhesion.
        displacement: Tangential displacement U after the step (m).
        friction: Coefficient of friction µ (dimensionless), not negative.
        history: State before the step, on the same grid. None means U = 0 without tangential
            traction.
        residual: Tolerance on the violation of the conditions of stick and slip (dimensionless),
            relative to the largest displacement.

    Returns:
        State at `displacement`.

    Raises:
        CaseError: An argument lies outside its range, the contact is adhesive, or `history` is on
            another grid.
        NotConvergedError: The tolerance was not reached.
    """
    contact = normal.contact
    if not (math.isfinite(friction) and friction >= 0):
        raise CaseError(f"friction: {friction} is not a coefficient of friction; give 0 or more")
    if not math.isfinite(displacement):
        raise CaseError(f"displacement: {displacement} m is not a finite length")
    if contact.adhesive:
        raise CaseError(
            "normal: this contact is adhesive; Coulomb's law is solved only without adhesion"
        )
    if history is not None and history.normal.contact.grid != contact.grid:
        raise CaseError("history: is on another grid; give a state on the grid of this contact")
    box = union(
        bounding_box(normal.box_pressure > 0, normal.box),
        None if history is None else bounding_box(history.box_traction != 0, history.box),
    )
    loss = 0.0 if history is None else history.friction_loss
    if box is None:
        nothing = freeze(np.zeros((0, 0)))
        return TangentialState(
            normal, friction, displacement, NOWHERE, nothing, nothing, loss, 0.0, 0
        )
    device, shape = current(), shape_of(box)
    K = shear_half_space(shape, contact.grid.spacing, contact.pair.shear_compliances)
    before, moved, motion = np.zeros(shape), np.zeros(shape), displacement
    if history is not None:
        before = reframe(history.box_traction, history.box, box)
        moved, motion = device.get(K(device.put(before))), displacement - history.displacement
    limit, target = _limit(normal, friction, box), motion + moved
    scale = float(np.abs(target).max())
    upper = device.put(limit)
    solved = minimise_quadratic(
        BoundedQuadratic(K, device.put(target), -upper, upper, K.single_precision),
        start=device.put(before.copy()),  # the solver overwrites its start
        precondition=inverse_half_space(
            shape, contact.grid.spacing, contact.pair.tangential_modulus
        ),
        tolerance=residual * scale,
        max_iterations=MAX_ITERATIONS,
    )
    reached = solved.residual / scale if scale > 0 else 0.0
    require_converged(
        solved,
        f"the tangential solve at a displacement of {1e9 * displacement:.6g} nm",
        residual,
        reached,
    )
    traction, gradient = device.get(solved.point), device.get(solved.gradient)
    twice = float(np.einsum("ij,ij->", before + traction, gradient))
    return TangentialState(
        normal=normal,
        friction=friction,
        displacement=displacement,
        box=box,
        box_traction=freeze(traction),
        box_displacement=freeze(gradient + target),
        friction_loss=loss - 0.5 * twice * contact.grid.cell_area,
        residual=reached,
        convolutions=K.count,
    )


def _limit(normal: State, friction: float, box: Box) -> Array:
    return friction * normal.pressure_on(box)
