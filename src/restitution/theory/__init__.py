"""Closed forms for smooth spheres, one module a theory; each module states where it holds.

Shared by every function of this room:

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
  is NaN there, and the function says where that is.
- **No body is an error** A radius, modulus, pressure, strength or mass that is not positive and
  finite raises `CaseError` (a `ValueError`) naming the argument.
"""

from . import (
    adhesive_thornton_ning,
    brilliantov,
    eepa,
    hertz,
    jackson_green,
    jkr,
    johnson,
    kendall,
    luding,
    mdr,
    sticking,
    thornton_ning,
    walton_braun,
    yielding,
)

__all__ = [
    "adhesive_thornton_ning",
    "brilliantov",
    "eepa",
    "hertz",
    "jackson_green",
    "jkr",
    "johnson",
    "kendall",
    "luding",
    "mdr",
    "sticking",
    "thornton_ning",
    "walton_braun",
    "yielding",
]
