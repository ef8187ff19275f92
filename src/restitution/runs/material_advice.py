"""Which value of the material library widens the error of a run most, in data and in words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from restitution.case.bodies import FROM_LIBRARY
from restitution.display import quantity

_NAMES = {
    "youngs_modulus": "Young's modulus",
    "poissons_ratio": "Poisson's ratio",
    "density": "density",
    "yield_strength": "yield strength",
    "hardness": "hardness",
    "work_of_adhesion": "work of adhesion",
}
_EXAMPLES = {
    "youngs_modulus": '"... GPa"',
    "poissons_ratio": "...",
    "density": '"... kg/m^3"',
    "yield_strength": '"... MPa"',
    "hardness": '"... MPa"',
    "work_of_adhesion": '"... J/m^2"',
}
# Smallest share of the largest contribution that the advice mentions.
_MENTIONED = 0.3


@dataclass(frozen=True)
class MaterialPart:
    """Largest change of COR due to the spread of one library value, over the points of a run.

    `key` is the key of the case file, such as "first.hardness"; `low` and `high` are in SI units.
    """

    key: str
    material: str
    low: float
    high: float
    error: float

    @property
    def name(self) -> str:
        """The value in words, with its spread."""
        quantity_name = self.key.split(".")[1]
        unit = {**FROM_LIBRARY, "work_of_adhesion": "J/m^2"}[quantity_name]
        low, high = (
            quantity(end, unit) if unit in ("Pa", "J/m^2") else f"{end:g} {unit}".strip()
            for end in (self.low, self.high)
        )
        return f"{_NAMES[quantity_name]} of {self.material} ({low} to {high})"


def largest_parts(parts: Iterable[MaterialPart]) -> list[MaterialPart]:
    """One contribution for each key, the largest over the grids of a run, in decreasing order."""
    largest: dict[str, MaterialPart] = {}
    for part in parts:
        if part.error > 0 and part.error >= largest.get(part.key, part).error:
            largest[part.key] = part
    return sorted(largest.values(), key=lambda part: -part.error)


def as_rows(parts: Iterable[MaterialPart]) -> list[dict[str, Any]]:
    return [asdict(part) for part in largest_parts(parts)]


def advice(rows: Iterable[Mapping[str, Any]]) -> str:
    """Name the library values, stored as `as_rows` does, whose spread widens the error most."""
    parts = [MaterialPart(**row) for row in rows]
    if not parts:
        return ""
    worst, *others = parts
    also = [part for part in others if part.error >= _MENTIONED * worst.error]
    rest = f", then the {', the '.join(map(_sized, also))}" if also else ""
    table, key = worst.key.split(".")
    return (
        f"most of it comes from the {_sized(worst)}{rest}; measure it and write {key} = "
        f"{_EXAMPLES[key]} in [{table}]"
    )


def _sized(part: MaterialPart) -> str:
    return f"{part.name}: ±{part.error:.2g}"
