"""How much each value of the material library contributes to the material error of a run.

The companion curves of the material error move values of one kind together. They also give the
contribution of one value:

* Young's moduli and Poisson's ratios act through the contact modulus E*. The change of COR is
  interpolated linearly in ln E* between the run and the end of the spread.
* Only the softer body yields, so one strength usually moves the yield model as all of them do.
* A density changes the loading work at the velocity of the run, which shifts the curve.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from restitution.case.materials import Property
from restitution.curve.columns import Array
from restitution.runs.companions import ENDS, Companions, moved
from restitution.runs.material_advice import MaterialPart

_ELASTIC = ("youngs_modulus", "poissons_ratio")
_STRENGTHS = ("yield_strength", "hardness")


def material_parts(companions: Companions, work: Array) -> list[MaterialPart]:
    """Contributions of all library values with a spread, at the loading work `work` (J)."""
    case = companions.case
    tables = {"first": case.first} | ({"second": case.second} if case.second else {})
    parts = [
        _part(f"{body}.{key}", table.material or body, known, _change(companions, work, body, key))
        for body, table in tables.items()
        for key, known in table.from_library().items()
        if known.low != known.high
    ]
    if (w := case.library_adhesion()) is not None:
        pair = " on ".join(str(table.material) for table in case.bodies().values())
        here = _reference(companions, work)
        ends = [companions.curve(contact).at(work) - here for contact in companions.adhesion_ends]
        parts.append(_part("interface.work_of_adhesion", pair, w, np.max(np.abs(ends), axis=0)))
    return parts


def _part(key: str, material: str, known: Property[Any], change: Array) -> MaterialPart:
    finite = change[np.isfinite(change)]
    error = float(finite.max()) if finite.size else 0.0
    return MaterialPart(key, material, float(known.low), float(known.high), error)


def _change(companions: Companions, work: Array, body: str, key: str) -> Array:
    changes = list(_changes(companions, work, body, key))
    return np.asarray(np.max(np.abs(changes), axis=0))


def _changes(companions: Companions, work: Array, body: str, key: str) -> Iterator[Array]:
    coarse = companions.coarse
    for end in ENDS:
        case = moved(companions.case, end, body, key)
        mass, own_mass = case.pair().mass, coarse.pair.mass
        if key in _ELASTIC:
            yield _elastic_change(companions, work, case.pair().contact_modulus)
        elif key in _STRENGTHS:
            weaker = companions.curve(companions.with_yield_of(case))
            yield weaker.at(work) - _reference(companions, work)
        elif mass is not None and own_mass is not None:
            own = companions.own
            yield own.at(work * mass / own_mass) - own.at(work)
        else:
            yield np.zeros(work.size)


def _elastic_change(companions: Companions, work: Array, contact_modulus: float) -> Array:
    """Change of COR at another contact modulus (Pa) within the spread."""
    own = companions.coarse.pair.contact_modulus
    low, high = companions.stiffness_ends
    end = high if contact_modulus > own else low
    span = math.log(end.pair.contact_modulus / own)
    if span == 0:
        return np.zeros(work.size)
    share = math.log(contact_modulus / own) / span
    change = companions.curve(end).at(work) - _reference(companions, work)
    return np.asarray(share * change)


def _reference(companions: Companions, work: Array) -> Array:
    return companions.curve(companions.of_materials).at(work)
