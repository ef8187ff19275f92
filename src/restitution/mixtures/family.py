"""Families: all pairs of particles from two components of a mixture.

Smooth spheres without adhesion scale: their contact depends only on W/R*³ = ½ κ V², κ = m*/R*³,
with the loading work W. Roughness and adhesion have lengths that do not scale, so COR of a family
is one function of W/R*³ and R*.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import tomli_w

from restitution.case.case import Case
from restitution.case.case_file import parse_case
from restitution.case.derived import deepest_indentation
from restitution.contact.bodies import Body, Pair
from restitution.contact.checks.resolution import predicted_radius
from restitution.display import quantity
from restitution.errors import CaseError, RestitutionError
from restitution.laws.particle import Particle
from restitution.mixtures.mixture_file import Component, Mixture

_WIDTH = 2.8  # grid width divided by the upper estimate of the contact radius (`_half_width`)
_PEAKS = 4.0  # height of the highest peaks, in units of the rms height
_NODES = 256  # smallest number of nodes along the edge of the grid
_MOST_NODES = 1024  # largest number of nodes along the edge of the grid
_PER_WAVE = 5  # number of nodes per correlation length, or per shortest wavelength


@dataclass(frozen=True)
class ParticlePair:
    """Two particles that can meet, with R* (m) and m* (kg)."""

    first: Particle
    second: Particle
    radius: float
    mass: float

    @property
    def kappa(self) -> float:
        """κ = m*/R*³ (kg/m³)."""
        return self.mass / self.radius**3


@dataclass(frozen=True)
class Family:
    """All pairs of one particle of the component `first` and one of the component `second`."""

    mixture: Mixture
    first: Component
    second: Component

    @property
    def name(self) -> str:
        """The names of both components, as in a key of the table [pairs]."""
        return f"{self.first.name}+{self.second.name}"

    @cached_property
    def pairs(self) -> tuple[ParticlePair, ...]:
        """Each pair of a particle of `first` and one of `second`, once."""
        ours, theirs = _particles(self.first), _particles(self.second)
        if self.second is self.first:
            return tuple(itertools.starmap(_pair, itertools.combinations_with_replacement(ours, 2)))
        return tuple(itertools.starmap(_pair, itertools.product(ours, theirs)))

    @cached_property
    def radii(self) -> tuple[float, ...]:
        """The reduced radii (m) of all pairs, increasing; within 1e-9 they count as one."""
        radii: list[float] = []
        for radius in sorted(pair.radius for pair in self.pairs):
            if not radii or radius > radii[-1] * (1 + 1e-9):
                radii.append(radius)
        return tuple(radii)

    def case(self, radius: float) -> str:
        """The text of the case for the reduced `radius` R* (m).

        Its velocities cover the range of W/R*³ of every pair.
        """
        return tomli_w.dumps(self._content(radius, self._grid))

    @cached_property
    def _grid(self) -> dict[str, Any]:
        """The same for all reduced radii, and so is the surface."""
        if self.mixture.grid is not None:
            return {"refine": self._refine, **self.mixture.grid}
        probe = {"nodes": 64, "spacing": "1 um"}
        ends = self.radii[0], self.radii[-1]
        cases = [self._parsed(radius, probe, sized=False) for radius in ends]
        width = _WIDTH * max(_half_width(case) for case in cases)
        spacing = min(width / _NODES, *(_spacing(part) for part in cases[0].roughness), math.inf)
        nodes = 2 * math.ceil(0.5 * width / spacing)
        if nodes > _MOST_NODES:
            raise CaseError(
                f"grid: the pair {self.name} needs {nodes} nodes per edge, but at most "
                f"{_MOST_NODES} are allowed (spacing {quantity(spacing, 'm')} for the roughness, "
                f"grid width {quantity(width, 'm')} for the contact); give the table [grid], lower "
                "velocities, or smaller radii"
            )
        return {"nodes": nodes, "spacing": f"{spacing!r} m", "refine": self._refine}

    @property
    def _refine(self) -> int | str:
        return "auto" if self.mixture.impacts is None else 1

    def _parsed(self, radius: float, grid: dict[str, Any], *, sized: bool = True) -> Case:
        """The case on `grid`; without `sized`, the grid need not hold the contacts of [impacts]."""
        try:
            return parse_case(tomli_w.dumps(self._content(radius, grid, sized=sized)))
        except RestitutionError as error:
            raise CaseError(f"in the pair {self.name}: {error}") from None

    def _content(
        self, radius: float, grid: dict[str, Any], *, sized: bool = True
    ) -> dict[str, Any]:
        flat = self.second.wall
        own = f"{radius if flat else 2 * radius!r} m"
        rough = [*self.first.roughness]
        for table in self.second.roughness:
            rough.append(_another(table, rough))
        return {
            "title": f"{self.name}, R* = {1e6 * radius:.6g} um",
            "first": {**self.first.body, "radius": own},
            "second": {**self.second.body, "radius": "flat" if flat else own},
            "interface": self.mixture.interface(self.first, self.second),
            **({"roughness": rough} if rough else {}),
            "grid": grid,
            "impact": {"velocity": [f"{V!r} m/s" for V in self._velocities(radius)]},
            "unloading": {"curves": 1},
            **({"impacts": self._impacts} if self.mixture.impacts and sized else {}),
        }

    @property
    def _impacts(self) -> dict[str, Any]:
        owners = ["first"] * len(self.first.roughness) + ["second"] * len(self.second.roughness)
        return {**(self.mixture.impacts or {}), **({"rough": owners} if owners else {})}

    def _velocities(self, radius: float) -> list[float]:
        """Those of the mixture, and lower and higher ones until W/R*³ of every pair is covered."""
        given = self.mixture.velocities
        own = _particle(self.first, radius if self.second.wall else 2 * radius)
        other = _particle(self.second, None if self.second.wall else 2 * radius)
        kappa = _pair(own, other).kappa
        scales = [math.sqrt(pair.kappa / kappa) for pair in self.pairs]
        low, high = given[0] * min(scales), given[-1] * max(scales)
        count = len(given) - 1
        step = (given[-1] / given[0]) ** (1 / count) if count else 1.5
        below = _steps(given[0], low, 1 / step)
        return [*below[::-1], *given, *_steps(given[-1], high, step)]


def families(mixture: Mixture) -> list[Family]:
    """The families of a mixture. Raises `CaseError` if the case of a family is invalid."""
    pairs = itertools.combinations_with_replacement(mixture.components, 2)
    # `mixture.components` lists walls after materials, so a wall is always the second of a pair.
    pairings = [Family(mixture, first, second) for first, second in pairs if not first.wall]
    for family in pairings:
        for radius in (family.radii[0], family.radii[-1]):
            family._parsed(radius, family._grid)
    _check_size_effect(mixture, pairings)
    return pairings


def _check_size_effect(mixture: Mixture, pairings: list[Family]) -> None:
    """Raise `CaseError` if one h* would be that of several materials."""
    common = mixture.interfaces[frozenset()]
    if "size_effect" not in common or {"yield_pressure", "yield_strength"} & common.keys():
        return
    soft: dict[str, str] = {}
    for family in pairings:
        interface = mixture.interface(family.first, family.second)
        case = family._parsed(family.radii[0], family._grid)
        if case.interface.size_effect and interface["size_effect"] == common["size_effect"]:
            body = family.second if case.yielding().yields == "second" else family.first
            soft.setdefault(body.name, family.name)
    if len(soft) > 1:
        tables = " and ".join(f'[pairs."{name}"]' for name in soft.values())
        raise CaseError(
            f"interface.size_effect: h* is that of one material, but {', '.join(soft)} yield; give "
            f'each in the tables of their pairs, such as {tables}, or size_effect = "0 um" there'
        )


def _steps(start: float, end: float, step: float) -> list[float]:
    """Velocities from `start` (excluded) to `end`, each about `step` times the one before."""
    distance = math.log(end / start) / math.log(step)
    if distance < 1e-6:
        return []
    count = max(1, round(distance))
    return [start * (end / start) ** (k / count) for k in range(1, count + 1)]


def _another(table: dict[str, Any], others: list[dict[str, Any]]) -> dict[str, Any]:
    """A roughness like `table`, independent of `others`.

    With the same seed, two surfaces would have the same phases, and their waves would add up.
    """
    random = table.get("kind") != "measured" or table.get("extend") == "twin"
    key = "seed" if random else "place"
    taken = {other.get(key, 0) for other in others}
    free = (n for n in itertools.count(table.get(key, 0) + 1) if n not in taken)
    return {**table, key: next(free)}


def _particle(
    component: Component, radius: float | None, number_fraction: float | None = None
) -> Particle:
    return Particle(
        name=component.name,
        radius=radius,
        youngs_modulus=component.material.youngs_modulus,
        poissons_ratio=component.material.poissons_ratio,
        density=component.material.density,
        yield_strength=component.material.yield_strength,
        hardness=component.material.hardness,
        number_fraction=number_fraction,
    )


def _particles(component: Component) -> list[Particle]:
    if component.wall:
        return [_particle(component, None)]
    return [
        _particle(component, radius, fraction)
        for radius, fraction in zip(component.radii, component.fractions, strict=True)
    ]


def _pair(first: Particle, second: Particle) -> ParticlePair:
    bodies = (
        Body(body.radius or math.inf, body.youngs_modulus, body.poissons_ratio, body.density)
        for body in (first, second)
    )
    pair = Pair(*bodies)
    assert pair.mass is not None  # `parse_mixture` requires the density of every material
    return ParticlePair(first, second, pair.radius, pair.mass)


def _half_width(case: Case) -> float:
    """Upper estimate of the contact radius (m) at the deepest indentation of `case`."""
    pair, depth = case.pair(), deepest_indentation(case)
    rms = math.hypot(*(getattr(part, "rms", 0.0) for part in case.roughness))
    rough = math.sqrt(2 * pair.radius * (0.5 * depth + _PEAKS * rms))
    return max(predicted_radius(pair, depth, case.yielding().hardness), rough)


def _spacing(part: Any) -> float:
    waves = [getattr(part, name, None) for name in ("correlation_length", "shortest")]
    lengths = [min(wave) if isinstance(wave, tuple) else wave for wave in waves]
    return min((length / _PER_WAVE for length in lengths if length), default=math.inf)
