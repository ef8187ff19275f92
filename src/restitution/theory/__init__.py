"""Closed-form contact laws, most of them for smooth spheres; one law per class.

A law is a frozen object: its parameters are fields, checked on construction, and its quantities are
properties and methods: `Hertz(radius, contact_modulus).force(indentation)`. Laws that predict an
impact follow `ImpactLaw`, except `Brilliantov`, whose parameter includes the mass. These
conventions hold for every law:

- **Shapes**: every argument and field may be a number or an array. They broadcast, and the result
  has the broadcast shape (a NumPy scalar if all are numbers).
- **Separated spheres**: if the indentation, force or velocity is zero or negative, every force,
  pressure, length, area and energy is 0, and the restitution is 1. Adhesive contacts are an
  exception: they also exist at negative indentation, down to the point where they break. Spheres
  that stick have restitution 0. NaN arguments give NaN.
- **Out of range**: where a formula has no solution, the result is NaN.
- **Invalid parameters**: a parameter outside its range raises `CaseError` (a `ValueError`) that
  names the argument. A radius, modulus, pressure, strength or mass must be positive and finite.
- **Units** are SI. `radius` is the reduced radius R*, 1/R* = 1/R₁ + 1/R₂, and `contact_modulus`
  E*, 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. Only `MDR` takes the radius and mass of one sphere.

Arguments of the methods, where the method does not say otherwise:

- `indentation`: approach δ of the rigid bodies (m), zero at first touch, positive in compression.
- `maximum_indentation`: indentation δ_max at which unloading began (m).
- `contact_radius`: radius a of the contact area (m).
- `radial_distance`: distance r from the axis (m).
- `gap`: smallest gap g between the surfaces (m), positive.
- `radius`: reduced radius R* (m).
- `contact_modulus`: contact modulus E* (Pa).
- `force`: normal force F (N), positive in compression.
- `energy`: elastic energy W (J).
- `pressure`: nominal pressure p (Pa).
- `velocity`: relative normal impact velocity V (m/s).
- `mass`: reduced mass m* (kg), 1/m* = 1/m₁ + 1/m₂.
"""

from .brilliantov import Brilliantov
from .eepa import EEPA
from .hertz import Hertz
from .jackson_green import JacksonGreen
from .jkr import JKR, Kendall
from .johnson import Johnson
from .law import ImpactLaw
from .lennard_jones import LennardJones
from .luding import Luding
from .maugis_dugdale import MaugisDugdale
from .mdr import MDR
from .persson import Persson
from .thornton_ning import AdhesiveThorntonNing, ThorntonNing
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
