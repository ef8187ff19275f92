"""Thornton & Ning (1998): elastic, perfectly plastic spheres with adhesion.

C. Thornton, Z. Ning, Powder Technology 99 (1998) 154–162. With the impact velocity V, the sticking
velocity V_s of `JKR`, the yield velocity V_y of `FirstYield` and the restitution e_p of
`ThorntonNing` (without adhesion):

    V ≤ V_y    e² = 1 − (V_s/V)²        elastic and adhesive, 0 for V ≤ V_s: the spheres stick
    V > V_y    e² = e_p² − (V_s/V)²     plastic and adhesive losses added

e is continuous at V_y, where e_p = 1. It rises from 0 at V_s to a peak above V_y and then falls.

The sum of the two losses is an assumption: each loss is computed as if the other were absent. The
adhesive loss is computed with the undeformed radius R*. But yielding flattens the surfaces to a
reduced radius R_p > R*, and detaching the flatter contact takes more work (∝ R_p^{4/3}).
Yielding caused by adhesion alone is neglected. So e is an upper estimate, accurate if the adhesive
loss is small at first yield (V_s ≪ V_y).

If V_s > V_y, the pair yields below its sticking velocity and the formula fails. Such a pair sticks
up to V_y (e = 0); above V_y the result is NaN. An example is a sphere of ammonium fluorescein
(radius 2.45 μm, density 1350 kg/m³, E = 1.2 GPa, w = 0.2 J/m², p_y = 35.3 MPa) on a wall with
E = 182 GPa (ν = 0.3 for both bodies): V_s = 0.567 m/s, V_y = 0.183 m/s.

Like `ThorntonNing` and `JKR`, the law requires quasi-static normal impacts of smooth spheres. Like
`JKR`, it requires a large Tabor parameter.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import Array, PositiveFields, Values, scalar_or_array, touching
from .jkr import JKR
from .thornton_ning import ThorntonNing


@dataclass(frozen=True, eq=False)
class AdhesiveThorntonNing(PositiveFields):
    """Impact of elastic, perfectly plastic spheres with adhesion.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        yield_pressure: Contact pressure p_y at yield (Pa), not the yield strength of a tensile
            test.
        work_of_adhesion: Work of adhesion w (J/m²).

    Raises:
        CaseError: A field is not positive and finite.

    Source:
        C. Thornton, Z. Ning, Powder Technology 99 (1998) 154–162.
    """

    radius: Values
    contact_modulus: Values
    yield_pressure: Values
    work_of_adhesion: Values

    @cached_property
    def elastic(self) -> JKR:
        """Adhesive contact without yield."""
        return JKR(self.radius, self.contact_modulus, self.work_of_adhesion)

    @cached_property
    def plastic(self) -> ThorntonNing:
        """Elastic-plastic contact without adhesion."""
        return ThorntonNing(self.radius, self.contact_modulus, self.yield_pressure)

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution after an impact.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Coefficient of restitution e (dimensionless); 0 if the spheres stick, 1 at zero or
            negative velocity. If the sticking velocity exceeds the yield velocity, the formula
            fails and e is NaN above the yield velocity.

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        V, V_y = touching(velocity), self.plastic.first_yield.velocity(mass)
        V_s = self.elastic.sticking_velocity(mass)
        e2 = self.plastic.restitution(velocity, mass) ** 2 - (V_s / np.maximum(V, V_y)) ** 2
        plastic = np.where(V_s > V_y, np.nan, np.maximum(e2, 0.0) ** 0.5)
        return scalar_or_array(np.where(V_y < V, plastic, self.elastic.restitution(velocity, mass)))
