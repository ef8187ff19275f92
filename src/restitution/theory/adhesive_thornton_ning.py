"""Thornton & Ning (1998): elastic, then perfectly plastic spheres with adhesion, losses added.

C. Thornton, Z. Ning, Powder Technology 99 (1998) 154–162. With e_p that of `ThorntonNing`, V_s
that of `JKR` and V_y that of `FirstYield`:

    V ≤ V_y    e² = 1 − (V_s/V)²        elastic and adhesive, 0 for V ≤ V_s: the spheres stick
    V > V_y    e² = e_p² − (V_s/V)²     plastic and adhesive losses added

Continuous at V_y, where e_p = 1: e rises from 0 at V_s to a peak above V_y and falls beyond.

Additivity is assumed, not derived: each loss is taken as if the other were absent. The tear-off is
that of the unflattened R*, though yielding flattens the contact to R_p > R*, which takes more to
tear off (as R_p^{4/3}); and adhesion is taken to yield nothing by itself. So e is an upper
estimate, good where adhesion loses little by the time anything yields, V_s ≪ V_y.

Where V_s > V_y the pair yields before it could rebound at all, and the formula fails: at and below
V_y such a pair sticks, e = 0; above V_y there is no answer, NaN. Ammonium fluorescein is such a
pair (radius 2.45 μm, 1350 kg/m³, E = 1.2 GPa, w = 0.2 J/m², p_y = 35.3 MPa, on a wall of 182 GPa;
both ν = 0.3): V_s = 0.567 m/s, V_y = 0.183 m/s.

The ranges of `ThorntonNing` and `JKR` apply too: quasi-static normal impacts of smooth
spheres, a large Tabor parameter.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import Array, Values, keep_positive, scalar_or_array, touching
from .jkr import JKR
from .thornton_ning import ThorntonNing


@dataclass(frozen=True, eq=False)
class AdhesiveThorntonNing:
    """Spheres that yield at `yield_pressure` p_y (Pa) and have `work_of_adhesion` w (J/m²).

    `radius` is R* (m), `contact_modulus` E* (Pa).
    """

    radius: Values
    contact_modulus: Values
    yield_pressure: Values
    work_of_adhesion: Values

    def __post_init__(self) -> None:
        keep_positive(self, "radius", "contact_modulus", "yield_pressure", "work_of_adhesion")

    @cached_property
    def elastic(self) -> JKR:
        """The contact if nothing yielded."""
        return JKR(self.radius, self.contact_modulus, self.work_of_adhesion)

    @cached_property
    def plastic(self) -> ThorntonNing:
        """The contact without adhesion."""
        return ThorntonNing(self.radius, self.contact_modulus, self.yield_pressure)

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e after an impact at relative normal `velocity` (m/s).

        0 where the spheres stick; NaN for V > V_y where V_s > V_y, outside the range; 1 at and
        below zero velocity, where none approaches.
        """
        V, V_y = touching(velocity), self.plastic.first_yield.velocity(mass)
        V_s = self.elastic.sticking_velocity(mass)
        e2 = self.plastic.restitution(velocity, mass) ** 2 - (V_s / np.maximum(V, V_y)) ** 2
        plastic = np.where(V_s > V_y, np.nan, np.maximum(e2, 0.0) ** 0.5)
        return scalar_or_array(np.where(V_y < V, plastic, self.elastic.restitution(velocity, mass)))
