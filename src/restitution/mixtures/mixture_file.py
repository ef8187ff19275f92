"""The mixture file: materials with their sizes, walls, and settings of single pairs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError, model_validator

from restitution.case.bodies import BodyTable
from restitution.case.case_file import in_words, naming, parse_toml, read_text
from restitution.case.impacts import ImpactsTable
from restitution.case.interface import InterfaceTable
from restitution.case.materials import LIBRARY
from restitution.case.quantities import Length
from restitution.case.roughness import Roughness
from restitution.case.schema import GridTable, ImpactTable, PairOf, Table
from restitution.display import quantity
from restitution.errors import CaseError

MOST_SIZES = 50  # largest number of sizes of one material
_FRACTIONS = ("mass_fractions", "number_fractions")
# Largest allowed deviation of the sum of fractions from 1. Given fractions are often rounded.
_OFF = 0.02
_T = TypeVar("_T", bound=Table)


class Sizes(Table):
    """A table `radius` of a material: bins with edges, or a distribution divided into bins.

    The radius of a bin is the geometric mean of its edges or, of a distribution, its median; all
    bins of a distribution hold the same number of particles.
    """

    edges: Annotated[list[Length] | None, Field(min_length=2, max_length=MOST_SIZES + 1)] = None
    bins: list[Annotated[tuple[Length, Length], PairOf]] | None = None
    median: Length | None = None
    geometric_std: Annotated[float | None, Field(gt=1)] = None
    count: Annotated[int, Field(gt=0, le=MOST_SIZES)] = 4

    @model_validator(mode="after")
    def _one_way(self) -> Sizes:
        lognormal = (self.median, self.geometric_std)
        given = [self.edges is not None, self.bins is not None, lognormal != (None, None)]
        if sum(given) != 1 or (given[2] and None in lognormal):
            raise ValueError("give edges, or bins, or median and geometric_std (log-normal)")
        if self.edges is not None and not (np.diff(self.edges) > 0).all():
            raise ValueError("edges: must increase")
        for low, high in self.bins or []:
            if not low < high:
                raise ValueError("bins: the lower edge of each bin must be below its upper edge")
        for (_, high), (low, _) in itertools.pairwise(sorted(self.bins or [])):
            if low < high * (1 - 1e-9):
                raise ValueError(
                    f"bins: overlap between {quantity(low, 'm')} and {quantity(high, 'm')}; let "
                    "each bin begin where the previous bin ends"
                )
        return self

    def radii(self) -> list[float]:
        """The radius of each bin (m), in the order of the file."""
        if self.median is not None and self.geometric_std is not None:
            from scipy.special import ndtri

            middles = ndtri((np.arange(self.count) + 0.5) / self.count)
            return [self.median * self.geometric_std ** float(z) for z in middles]
        bins = self.bins or list(itertools.pairwise(self.edges or []))
        return [math.sqrt(low * high) for low, high in bins]


@dataclass(frozen=True)
class Component:
    """A material with its sizes, or a wall.

    `body` is a body table of a case without `radius`, as written, and `material` its checked
    values. `radii` (m, increasing) and `fractions` (by number, sum 1) are empty for a wall.
    """

    name: str
    body: dict[str, Any]
    material: BodyTable
    roughness: list[dict[str, Any]]
    radii: tuple[float, ...]
    fractions: tuple[float, ...]

    @property
    def wall(self) -> bool:
        """Whether the component is a wall."""
        return not self.radii


def _with_some_adhesion(value: Any) -> Any:
    """Replace "library", which only the case of a pair can resolve, so that the rest is checked."""
    if isinstance(value, dict) and value.get("work_of_adhesion") == LIBRARY:
        return {**value, "work_of_adhesion": "0.05 J/m^2"}
    return value


_Interface = Annotated[InterfaceTable, BeforeValidator(_with_some_adhesion)]


class _File(Table):
    title: str = ""
    interpolation_error: Annotated[float, Field(gt=0, lt=1)] = 0.01
    interface: _Interface = InterfaceTable()
    pairs: dict[str, _Interface] = Field(default_factory=dict)
    grid: GridTable | None = None
    impact: ImpactTable
    impacts: ImpactsTable | None = None


@dataclass(frozen=True)
class Mixture:
    """A checked mixture file.

    `grid` and `impacts` are the tables as written, and `coverage` is the one of the laws (None: the
    first impact). `interfaces` maps the names of two components to the table
    `[interface]` of their pairs, and `frozenset()` to that of all other pairs.
    """

    title: str
    text: str
    components: tuple[Component, ...]
    interfaces: dict[frozenset[str], dict[str, Any]]
    grid: dict[str, Any] | None
    velocities: tuple[float, ...]
    interpolation_error: float
    impacts: dict[str, Any] | None = None
    coverage: float | None = None

    def interface(self, first: Component, second: Component) -> dict[str, Any]:
        """The table `[interface]` of the pair of components `first` and `second`."""
        names = frozenset((first.name, second.name))
        return self.interfaces.get(names, self.interfaces[frozenset()])


def read_mixture(path: Path) -> Mixture:
    """Read and check a mixture file. Raises a `CaseError` that names the file and the key."""
    text = read_text(path)
    with naming(path):
        return parse_mixture(text)


def parse_mixture(text: str) -> Mixture:
    """Check the text of a mixture file. Raises a `CaseError` that names the key."""
    content = parse_toml(text)
    materials, walls = content.pop("materials", None), content.pop("walls", {})
    if not isinstance(materials, dict) or not materials:
        raise CaseError("materials: is missing; write a table [materials.NAME] for each material")
    if not isinstance(walls, dict):
        raise CaseError("walls: should be tables [walls.NAME]")
    file = _validated(_File, content)
    components = [_component(f"materials.{name}", name, table) for name, table in materials.items()]
    for name, table in walls.items():
        if name in materials:
            raise CaseError(f"walls.{name}: is also the name of a material; rename the wall")
        components.append(_component(f"walls.{name}", name, table))
    if file.impact.oblique:
        key = "spin" if file.impact.angle is None else "angle"
        raise CaseError(
            f"impact.{key}: a mixture has laws of head-on impacts only; remove this key"
        )
    names = [component.name for component in components]
    interface = content.get("interface", {})
    interfaces = {frozenset[str](): interface}
    for key, table in content.get("pairs", {}).items():
        pair = _names_of(key, names)
        if pair in interfaces:
            raise CaseError(f"pairs.{key}: is given twice")
        interfaces[pair] = {**interface, **table}
    return Mixture(
        file.title,
        text,
        tuple(components),
        interfaces,
        content.get("grid"),
        tuple(file.impact.series()),
        file.interpolation_error,
        content.get("impacts"),
        _coverage(file.impacts),
    )


def _coverage(impacts: ImpactsTable | None) -> float | None:
    if impacts is None:
        return None
    if impacts.rough is not None:
        raise CaseError(
            "impacts.rough: the tables roughness of the materials say who is rough; remove this key"
        )
    if impacts.coverage is None:
        raise CaseError("impacts.count: a mixture needs coverage instead, such as coverage = 3")
    return max(impacts.coverage)


def _names_of(key: str, names: list[str]) -> frozenset[str]:
    for first, second in itertools.product(names, repeat=2):
        if key == f"{first}+{second}":
            return frozenset((first, second))
    raise CaseError(
        f'pairs."{key}": is not a pair of this mixture; write [pairs."FIRST+SECOND"] with two of '
        f"{', '.join(names)}"
    )


def _component(key: str, name: str, table: Any) -> Component:
    if not isinstance(table, dict):
        raise CaseError(f"{key}: should be a table")
    body = dict(table)
    rough = body.pop("roughness", [])
    rough = rough if isinstance(rough, list) else [rough]
    _validated(_Rough, {"roughness": rough}, key)
    sizes = body.pop("radius", None)
    radii: tuple[float, ...] = ()
    if key.startswith("walls."):
        if sizes not in (None, "flat"):
            raise CaseError(f"{key}.radius: a wall is flat; remove this key")
    elif sizes is None:
        raise CaseError(f"{key}.radius: is missing; give one or more radii, or size bins")
    else:
        radii = _radii(key, sizes)
    fractions = _number_fractions(key, body, sizes, radii)
    material = _validated(BodyTable, {**body, "radius": "flat"}, key)
    if material.relaxation_time is not None:
        raise CaseError(
            f"{key}.relaxation_time: is not used in a mixture, whose pairs share curves at equal "
            "energy; give loss_tangent"
        )
    if radii and material.thickness is not None:
        raise CaseError(f"{key}.thickness: belongs to a wall; remove this key")
    if radii and material.density is None:
        raise CaseError(
            f"{key}.density: is missing; give it, because the impact energy depends on it"
        )
    order = sorted(range(len(radii)), key=radii.__getitem__)
    increasing, shares = (tuple(values[k] for k in order) for values in (radii, fractions))
    return Component(name, body, material, rough, increasing, shares)


class _Rough(Table):
    roughness: list[Roughness]


class _Radii(Table):
    radius: Annotated[list[Length], Field(min_length=1, max_length=MOST_SIZES)]


def _radii(key: str, sizes: Any) -> tuple[float, ...]:
    if isinstance(sizes, dict):
        return tuple(_validated(Sizes, sizes, f"{key}.radius").radii())
    listed = sizes if isinstance(sizes, list) else [sizes]
    radii = _validated(_Radii, {"radius": listed}, key).radius
    if len(set(radii)) < len(radii):
        raise CaseError(f"{key}.radius: a radius is given twice")
    return tuple(radii)


def _validated(model: type[_T], table: dict[str, Any], key: str = "") -> _T:
    try:
        return model.model_validate(table)
    except ValidationError as error:
        raise CaseError(in_words(error, model, key)) from None


def _number_fractions(
    key: str, table: dict[str, Any], sizes: object, radii: Sequence[float]
) -> tuple[float, ...]:
    """Take the fractions from the `table` of a material; return fractions by number, sum 1.

    All sizes have the same density, so a mass fraction is proportional to number times radius
    cubed. `sizes` is the key `radius`, and `radii` (m) what it means; without fractions, all sizes
    are equal. Raises a `CaseError` that names `key`.
    """
    given = [name for name in _FRACTIONS if name in table]
    if len(given) > 1:
        raise CaseError(f"{key}: give {_FRACTIONS[0]} or {_FRACTIONS[1]}, not both")
    if not given:
        return tuple(1 / len(radii) for _ in radii)
    where = f"{key}.{given[0]}"
    if not radii:
        raise CaseError(f"{where}: a wall has no sizes; remove this key")
    if isinstance(sizes, dict) and "median" in sizes:
        raise CaseError(
            f"{where}: the bins of a log-normal distribution always hold equal numbers of "
            "particles; remove this key, or give edges or bins instead of median and geometric_std"
        )
    fractions = _checked_fractions(where, table.pop(given[0]), len(radii))
    power = 3 if given[0] == "mass_fractions" else 0
    numbers = [share / R**power for share, R in zip(fractions, radii, strict=True)]
    return tuple(number / math.fsum(numbers) for number in numbers)


def _checked_fractions(where: str, values: Any, count: int) -> list[float]:
    if not isinstance(values, list):
        raise CaseError(f"{where}: should be a list with a fraction for each size")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise CaseError(f"{where}: {value!r} should be a number without a unit, such as 0.25")
        if not 0 < value <= 1:
            raise CaseError(f"{where}: {value:g} should be above 0 and at most 1")
    if len(values) != count:
        raise CaseError(f"{where}: has {len(values)} values for {count} sizes")
    total = math.fsum(values)
    if abs(total - 1) > _OFF:
        raise CaseError(f"{where}: the sum is {total:g}, but should be 1")
    return [float(value) for value in values]
