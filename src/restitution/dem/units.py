"""The units of LAMMPS, and laws of coarse-grained particles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from restitution.errors import CaseError, not_one_of
from restitution.laws.law import FittedLaw, Law, LawPoint
from restitution.laws.particle import Particle

# Exponents of length, mass and time.
_EXPONENTS = {
    "m": (1, 0, 0),
    "s": (0, 0, 1),
    "1/s": (0, 0, -1),
    "m/s": (1, 0, -1),
    "m/s^2": (1, 0, -2),
    "kg": (0, 1, 0),
    "kg/s": (0, 1, -1),
    "kg/m^3": (-3, 1, 0),
    "N": (1, 1, -2),
    "N/m": (0, 1, -2),
    "J": (2, 1, -2),
    "Pa": (-1, 1, -2),
    "1/(m s)": (-1, 0, -1),
    "1/m": (-1, 0, 0),
}


@dataclass(frozen=True)
class Units:
    """A system of units: its units of length (m), mass (kg) and time (s), and their names."""

    name: str
    length: float
    mass: float
    time: float
    names: str

    def of(self, value: float, unit: str) -> float:
        """The number in these units of `value`, given in the SI unit `unit`."""
        length, mass, time = _EXPONENTS[unit]
        return float(value / (self.length**length * self.mass**mass * self.time**time))


SI = Units("si", 1.0, 1.0, 1.0, "SI units")
_LAMMPS = (
    SI,
    Units("cgs", 1e-2, 1e-3, 1.0, "cm, g, s"),
    Units("micro", 1e-6, 1e-15, 1e-6, "um, pg, us"),
)
NAMES = tuple(units.name for units in _LAMMPS)
"""The unit systems to which laws are exported, by LAMMPS' names."""


def units_of(name: str) -> Units:
    """The units that LAMMPS calls `name`. Raises `CaseError`."""
    for units in _LAMMPS:
        if units.name == name:
            return units
    raise CaseError(f"units={not_one_of(name, NAMES)}")


# The SI units of the fields; those of a fitted law end the names of its parameters.
_PARTICLE = {"radius": "m"}
_POINT = {
    "loading_work": "J",
    "indentation": "m",
    "force": "N",
    "pull_off_force": "N",
    "pull_off_error": "N",
    "separation": "m",
}
_LAW = {"radius": "m", "mass": "kg", "work_of_adhesion": "N/m"}
_PARAMETERS = {
    "_N_per_m": "N/m",
    "_J_per_m2": "N/m",
    "_per_m": "1/m",
    "_N": "N",
}


def coarse_grained(law: Law, size: float) -> Law:
    """`law` for particles `size` times as large of the same material.

    All lengths grow with `size`, forces with its square, masses and energies with its cube;
    velocities, stresses and e(V) stay.
    """
    grown = Units("", 1 / size, 1 / size**3, 1 / size, "")
    return replace(
        law,
        **_changes(law, _LAW, grown),
        first=replace(law.first, **_changes(law.first, _PARTICLE, grown)),
        second=replace(law.second, **_changes(law.second, _PARTICLE, grown)),
        points=tuple(replace(p, **_changes(p, _POINT, grown)) for p in law.points),
        run_in=(),
        laws=tuple(_fit(fit, grown, size) for fit in law.laws),
    )


def _changes(record: Law | LawPoint | Particle, units: Mapping[str, str], to: Units) -> Any:
    known = {key: getattr(record, key) for key in units}
    return {key: to.of(value, units[key]) for key, value in known.items() if value is not None}


def _fit(fit: FittedLaw, to: Units, size: float) -> FittedLaw:
    def scaled(name: str, value: float) -> float:
        if name.endswith("_N_per_m_n"):
            return float(value * size ** (2 - fit.parameters["exponent"]))
        unit = next((unit for end, unit in _PARAMETERS.items() if name.endswith(end)), None)
        return value if unit is None else to.of(value, unit)

    return replace(fit, parameters={key: scaled(key, x) for key, x in fit.parameters.items()})
