"""Closed-form contact laws, most of them for smooth spheres; one law per module.

Each module states the range of validity of its law.

A law is a frozen object. Its parameters are fields, checked on construction, and its quantities are
properties and methods: `Hertz(radius, contact_modulus).force(indentation)`. Laws that predict an
impact follow `ImpactLaw`: `restitution(velocity, mass)`. The one exception is
`Brilliantov.restitution`, which takes no mass: the dissipation parameter of this law already
includes the mass.

These conventions hold for every law:

- **Units** are SI: m, Pa, N, J, kg, m/s. `radius` is the reduced radius R*, `contact_modulus` is
  E*, and `mass` is the reduced mass m*. For two bodies with the indices 1 and 2,
  1/R* = 1/R₁ + 1/R₂, 1/m* = 1/m₁ + 1/m₂ and 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. Only `MDR` uses the
  radius and mass of one sphere. The indentation δ is the rigid-body approach, zero at first touch
  and positive when the contact is compressed.
- **Shapes**: every argument and field may be a number or an array. They broadcast, and the result
  has the broadcast shape (a NumPy scalar if all are numbers).
- **Separated spheres**: if the indentation, force or velocity is zero or negative, every force,
  pressure, length, area and energy is 0, and the restitution is 1. Adhesive contacts are an
  exception: they also exist at negative indentation, down to the point where they break. Spheres
  that stick have restitution 0. NaN arguments give NaN.
- **Out of range**: where a formula has no solution, the result is NaN. The docstring of the method
  names these cases.
- **Invalid parameters**: a radius, modulus, pressure, strength or mass that is not positive and
  finite raises `CaseError` (a `ValueError`) that names the argument.
"""

from .adhesive_thornton_ning import AdhesiveThorntonNing
from .brilliantov import Brilliantov
from .eepa import EEPA
from .hertz import Hertz
from .jackson_green import JacksonGreen
from .jkr import JKR
from .johnson import Johnson
from .kendall import Kendall
from .law import ImpactLaw
from .lennard_jones import LennardJones
from .luding import Luding
from .maugis_dugdale import MaugisDugdale
from .mdr import MDR
from .persson import Persson
from .thornton_ning import ThorntonNing
from .walton_braun import WaltonBraun
from .yielding import FirstYield, yield_coefficient

__all__ = [
    "EEPA",
    "JKR",
    "MDR",
    "AdhesiveThorntonNing",
    "Brilliantov",
    "FirstYield",
    "Hertz",
    "ImpactLaw",
    "JacksonGreen",
    "Johnson",
    "Kendall",
    "LennardJones",
    "Luding",
    "MaugisDugdale",
    "Persson",
    "ThorntonNing",
    "WaltonBraun",
    "yield_coefficient",
]
