"""The table `[impacts]`: many impacts one after the other, before COR is measured again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from restitution.case.quantities import Velocity
from restitution.case.rulebook import Input, key
from restitution.case.schema import Table
from restitution.contact.bodies import Pair
from restitution.display import quantity
from restitution.errors import CaseError
from restitution.numerics.grid import Grid
from restitution.repeated.run_in import Place, nominal_area
from restitution.repeated.velocities import drawn, in_turn, rayleigh

MOST_IMPACTS = 100_000
MOST_PLACES = 10_000
# Smallest width of a grid with [impacts], in diameters of the contact of smooth bodies.
_WIDEST = 1.6

_Listed = BeforeValidator(lambda value: value if isinstance(value, list) else [value])
Rough = Literal["first", "second", "both"]
Coverage = Annotated[float, Field(gt=0)]


class ImpactsTable(Table):
    """How the surfaces are run in, and where COR is measured."""

    count: Annotated[int, Field(gt=0, le=MOST_IMPACTS)] | None = key(
        None, "number of impacts, instead of `coverage`", default="–"
    )
    coverage: Annotated[list[Coverage] | None, _Listed, Field(min_length=1, max_length=20)] = key(
        None,
        "one coverage or a list, at which COR is measured: number of impacts times the contact "
        "area of smooth bodies, divided by the area of the grid",
        default="required, or `count`",
        page=Input(
            "Coverage",
            "How many times earlier impacts have covered the surface, such as 3; empty: the first "
            "impact only.",
        ),
    )
    place: Place = key(
        "random",
        'where the bodies are hit: `"random"`: both at new places; `"same"`: both at one place; '
        '`"track"`: a wall at one place, and the sphere at new ones',
    )
    rough: Annotated[list[Rough] | None, _Listed, Field(min_length=1, max_length=100)] = key(
        None,
        'the body that has the roughness; `"both"`: each has a part of it, of several tables '
        '`[[roughness]]` the first body the first one; a list such as `["first", "second"]`: the '
        "body of each table `[[roughness]]`",
        default='`"both"` for two equal bodies, or else the body that yields',
    )
    seed: Annotated[int, Field(ge=0, lt=2**32)] = key(0, "seed of the places and velocities")
    places: Annotated[int, Field(ge=2, le=MOST_PLACES)] = key(
        32, "number of places at which COR is measured at each coverage, as mean and distribution"
    )
    velocity: Annotated[list[Velocity] | None, _Listed, Field(min_length=1, max_length=10_000)] = (
        key(
            None,
            "velocity of the impacts that run the surfaces in; the velocities of a list take turns",
            default="each velocity of `[impact]` has surfaces of its own",
        )
    )
    weights: list[float] | None = key(
        None,
        "a weight for each `velocity`: the impacts then have random velocities of this "
        "distribution",
        default="none",
    )
    distribution: Literal["rayleigh"] | None = key(
        None,
        '`"rayleigh"`: random velocities with the mean `velocity`, as in a gas with the velocity '
        "distribution of Maxwell",
        default="none",
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if (self.count is None) == (self.coverage is None):
            raise ValueError("give either count or coverage, such as coverage = 3")
        if self.rough is not None and len(self.rough) > 1 and "both" in self.rough:
            raise ValueError(
                'rough: a list has "first" or "second" for each table [[roughness]], and no "both"'
            )
        if self.weights is not None:
            self._check_weights(self.weights)
        if self.distribution is not None and (self.velocity is None or len(self.velocity) != 1):
            raise ValueError(
                f'distribution: "{self.distribution}" needs one velocity, its mean; give '
                'velocity = "0.05 m/s"'
            )
        if self.distribution is not None and self.weights is not None:
            raise ValueError("weights: is a distribution already; remove weights or distribution")
        return self

    def _check_weights(self, weights: list[float]) -> None:
        if self.velocity is None or len(self.velocity) != len(weights):
            count = 0 if self.velocity is None else len(self.velocity)
            raise ValueError(
                f"weights: {len(weights)} weights for {count} velocities; give one for each "
                "velocity of [impacts]"
            )
        for value in weights:
            if not value >= 0:
                raise ValueError(
                    f"weights: {value:g} is not 0 or a positive number; a distribution of "
                    "velocities is never negative"
                )
        if not sum(weights) > 0:
            raise ValueError("weights: are all 0; give at least one positive weight")

    @property
    def own_surfaces(self) -> bool:
        """Whether each velocity of `[impact]` runs in surfaces of its own."""
        return self.velocity is None

    def velocities(self, own: float, seed: int) -> Iterator[float]:
        """Velocities (m/s) of the impacts, without end; `own` if the table has none."""
        listed = self.velocity or [own]
        if self.distribution is not None:
            return rayleigh(listed[0], seed)
        if self.weights is not None:
            return drawn(listed, self.weights, seed)
        return in_turn(listed)

    def require_possible(
        self, grid: Grid, velocities: Sequence[float], pair: Pair, hardness: float
    ) -> None:
        """Raise `CaseError` if a contact is as large as `grid`, or a coverage is not possible.

        Args:
            grid: The grid of the surfaces.
            velocities: Those of [impact] (m/s).
            pair: The bodies.
            hardness: Pressure of a fully plastic contact of smooth bodies (Pa).
        """
        for V in velocities:
            run_in = self.velocity or [V]
            areas = [nominal_area(pair, hardness, v) for v in (V, *run_in)]
            _require_wide(grid, max(areas), max(V, *run_in))
            if self.coverage is not None:
                one = sum(areas[1:]) / len(run_in) / math.prod(grid.size)
                _require_count(min(self.coverage), max(self.coverage), one, V)


def _require_count(least: float, most: float, one: float, velocity: float) -> None:
    """Raise `CaseError` for coverages that take no impact of coverage `one`, or too many."""
    if round(least / one) < 1:
        raise CaseError(
            f"impacts.coverage: {least:g} is less than one contact at {velocity:.4g} m/s, which "
            f"covers {one:.3g} of the surface; give at least {1.01 * one:.2g}, or a larger grid"
        )
    if (count := round(most / one)) > MOST_IMPACTS:
        raise CaseError(
            f"impacts.coverage: {most:g} takes {count} impacts at {velocity:.4g} m/s, more than "
            f"{MOST_IMPACTS}; give less coverage, a smaller grid, or higher velocities"
        )


def _require_wide(grid: Grid, area: float, velocity: float) -> None:
    """Raise `CaseError` if a contact of this area (m²) covers most of `grid`."""
    wide = _WIDEST * 2 * math.sqrt(area / math.pi)
    if wide <= min(grid.size):
        return
    nodes = math.ceil(wide / min(grid.spacing))
    raise CaseError(
        f"grid.nodes: the grid of {quantity(min(grid.size), 'm')} is too small for [impacts] at "
        f"{velocity:.4g} m/s, where the contact is {quantity(wide / _WIDEST, 'm')} wide; give at "
        f"least {nodes} nodes, or lower velocities"
    )
