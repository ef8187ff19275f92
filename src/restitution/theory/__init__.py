"""Closed forms for smooth spheres, one law a module; each module states where it holds.

A law is a frozen object: its parameters are fields, checked once when it is made, and its
quantities are properties and methods, `Hertz(radius, contact_modulus).force(indentation)`. Laws of
an impact follow `ImpactLaw`: `restitution(velocity, mass)`.

Shared by every law of this room:

- **Units** SI throughout: m, Pa, N, J, kg, m/s. `radius` is the reduced radius R*,
  `contact_modulus` E*, `mass` the reduced mass m*: 1/R* = 1/R₁ + 1/R₂, 1/m* = 1/m₁ + 1/m₂,
  1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. Indentation (the rigid approach δ) closes the contact when
  positive and is zero at first touch.
- **Shapes** Any argument may be a number or an array; they broadcast, and the result has the
  broadcast shape (a NumPy scalar where every argument is a number).
- **No contact is an answer** Where indentation, force or velocity is zero or negative nothing
  touches: every force, pressure, length, area and energy is 0 and every restitution 1. A contact
  that adheres holds on at negative indentation; nothing touches below its break. Spheres that
  touch and stick have restitution 0. NaN stays NaN.
- **No answer is NaN** Where a formula has no answer for bodies and states that can be, the result
  is NaN there, and the method says where that is.
- **No body is an error** A radius, modulus, pressure, strength or mass that is not positive and
  finite raises `CaseError` (a `ValueError`) naming the argument.
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
from .luding import Luding
from .mdr import MDR
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
    "Luding",
    "ThorntonNing",
    "WaltonBraun",
    "yield_coefficient",
]
