"""Closed forms for the smooth bodies of a stored run, drawn beside the computed curves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from restitution.theory import JKR, AdhesiveThorntonNing, Hertz, ThorntonNing

Array = NDArray[np.float64]

_JKR = "JKR, smooth elastic"
_THORNTON_NING = "smooth, Thornton–Ning (truncated pressure)"


@dataclass(frozen=True, eq=False)
class Reference:
    """Values `y` of a closed form at `x` (SI units), and whether the form includes yielding."""

    label: str
    x: Array
    y: Array
    yields: bool


def force_references(results: xr.Dataset) -> list[Reference]:
    """Closed forms of the force (N) against indentation (m): elastic and, if bodies yield, plastic.

    They begin below the smallest indentation with a force.
    """
    R, E_star, p_y, w = _parameters(results)
    deepest = float(results["indentation"].max())
    indentation = np.geomspace(0.7 * least_indentation(results), deepest, 400)
    references = [
        Reference("Hertz, smooth", indentation, Hertz(R, E_star).force(indentation), False)
    ]
    if w > 0:
        jkr = JKR(R, E_star, w)
        reach = np.append(np.linspace(float(jkr.break_indentation), 0, 60), indentation)
        references = [Reference(_JKR, reach, jkr.force(reach), False)]
    if np.isfinite(p_y):
        force = ThorntonNing(R, E_star, p_y).loading_force(indentation)
        references.append(Reference(_THORNTON_NING, indentation, force, True))
    return references


def restitution_references_by_indentation(results: xr.Dataset) -> list[Reference]:
    """Closed forms of COR against the largest indentation (m)."""
    R, E_star, p_y, w = _parameters(results)
    laws: dict[str, ThorntonNing | JKR] = {}
    if np.isfinite(p_y):
        laws[_THORNTON_NING] = ThorntonNing(R, E_star, p_y)
    if w > 0:
        laws[_JKR] = JKR(R, E_star, w)
    fine = _between(results["indentation"].values)
    return [
        Reference(label, fine, law.restitution_at_indentation(fine), label == _THORNTON_NING)
        for label, law in laws.items()
    ]


def restitution_references_by_velocity(results: xr.Dataset) -> list[Reference]:
    """Closed forms of COR against impact velocity (m/s); NaN where a closed form has no value."""
    R, E_star, p_y, w = _parameters(results)
    velocity, mass = results["impact_velocity"].values, results.attrs["derived_reduced_mass_kg"]
    fine, m = _between(velocity), float(mass)
    if w > 0 and np.isfinite(p_y):
        # This law is NaN where the losses by adhesion and by yield are not additive.
        cor = AdhesiveThorntonNing(R, E_star, p_y, w).restitution(fine, m)
        return [Reference("smooth, Thornton–Ning with adhesion", fine, cor, True)]
    if w > 0:
        return [Reference(_JKR, fine, JKR(R, E_star, w).restitution(fine, m), False)]
    if np.isfinite(p_y):
        cor = ThorntonNing(R, E_star, p_y).restitution(fine, m)
        return [Reference(_THORNTON_NING, fine, cor, True)]
    return []


def least_indentation(results: xr.Dataset) -> float:
    """The smallest positive indentation (m) with a stored force, on loading or on unloading."""
    least = [float(results["indentation"].min())]
    for k in range(results.sizes.get("unloading", 0)):
        force = results["unloading_force"][k].values
        depths = results["unloading_indentation"][k].values[force > 0]
        least.append(float(min(depths[depths > 0], default=math.inf)))
    return min(least)


def _parameters(results: xr.Dataset) -> tuple[float, float, float, float]:
    """R* (m), E* (Pa), yield pressure (Pa; inf if elastic), work of adhesion (J/m²)."""
    p_y = results.attrs["derived_yield_pressure_Pa"]
    return (
        float(results.attrs["derived_reduced_radius_m"]),
        float(results.attrs["derived_contact_modulus_Pa"]),
        math.inf if p_y == "None" else float(p_y),
        float(results.attrs.get("derived_work_of_adhesion_J_per_m2", 0.0)),
    )


def _between(values: Array) -> Array:
    values = values[values > 0]
    return np.geomspace(values.min(), values.max(), 300)
