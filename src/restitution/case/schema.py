"""Tables of the case file: the base class, and tables for the grid, loading and unloading."""

from __future__ import annotations

import math
from functools import cache
from typing import Annotated, Any, ClassVar, Generic, Literal, Self, TypeVar, cast

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    model_validator,
)

from restitution.case.quantities import ImpactAngle, Length, Spin, Velocity
from restitution.case.rulebook import Input, Key, Rule, key, rules
from restitution.collision import UnloadingMethod
from restitution.contact.models import RESTITUTION_ERROR
from restitution.errors import shown
from restitution.numerics.grid import Grid
from restitution.surfaces.refine import FACTORS

# Largest number of nodes of a grid. More nodes do not fit into the memory of common machines.
MOST_NODES = 2**27
MOST_STEPS = 10_000  # largest number of depths (states of loading) of a curve
_SAME = 1e-9  # largest relative difference of normal velocities that count as equal


class Table(BaseModel):
    """Base class of tables: rejects unknown keys, values of a wrong type, keys without effect."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, populate_by_name=True)

    @model_validator(mode="after")
    def _have_effect(self) -> Self:
        for rule in _conditional(type(self)):
            value, (other, *allowed) = getattr(self, rule.attribute), rule.key.only
            if value != rule.field.default and (getattr(self, other) or "") not in allowed:
                raise ValueError(rule.key.otherwise.format(value=value))
        return self


@cache
def _conditional(table: type[Table]) -> tuple[Rule, ...]:
    return tuple(rule for rule in rules(table) if rule.key.otherwise)


def _two(value: Any) -> Any:
    if not isinstance(value, list):
        return value, value
    if len(value) != 2:
        raise ValueError(f"{shown(value)} should be one value, or a list of two (for x and y)")
    return tuple(value)


Nodes = Annotated[int, Field(gt=0)]
PairOf = BeforeValidator(_two)


def _few_enough(nodes: tuple[int, int]) -> tuple[int, int]:
    if nodes[0] * nodes[1] > MOST_NODES:
        raise ValueError(
            f"{shown(nodes[0])} x {shown(nodes[1])} nodes are more than a grid may have "
            f"({MOST_NODES} in all); give fewer nodes, and a larger spacing if needed"
        )
    return nodes


def _factors(value: Any) -> int | tuple[int, ...] | str:
    values = value if isinstance(value, list | tuple) else [value]
    known = values and all(type(one) is int and one in FACTORS for one in values)
    if value == "auto" or known:
        return tuple(value) if isinstance(value, list) else value
    numbers = ", ".join(map(str, FACTORS[:-1]))
    raise ValueError(
        f"{shown(value)} should be {numbers} or {FACTORS[-1]}, a list of these (one for each "
        'depth), or "auto"'
    )


class GridTable(Table):
    """The table `[grid]`. `nodes` and `spacing` may be omitted if a scan defines the grid."""

    nodes: Annotated[tuple[Nodes, Nodes], PairOf, AfterValidator(_few_enough)] | None = key(
        None,
        "number of nodes along each axis: one value, or two for x and y; at most 2²⁷ nodes in "
        "all; powers of two are not required",
        default="required",
        page=Input("Nodes", hint="along each edge", slider=(64, 1024), logarithmic=True),
    )
    spacing: Annotated[tuple[Length, Length], PairOf] | None = key(
        None,
        "distance between nodes: one value, or two for x and y",
        default="required",
        page=Input("Spacing", slider=(1e-9, 1e-5)),
    )
    refine: Annotated[int | tuple[int, ...] | Literal["auto"], PlainValidator(_factors)] = key(
        1,
        "1, 2, 4, 8 … 64: every cell is divided into this many cells along x and along y, see "
        'below. `"auto"` chooses for each depth the coarsest grid that [resolves](resolution.md) '
        "its contact and its [adhesion](adhesion.md#grid), up to 2²⁴ nodes (2²² with an attraction "
        "of finite range), so that one run covers three or four decades of velocity. A list gives "
        "one value for each depth",
        page=Input("Refine", hint='1, 2, 4, …, or "auto"'),
    )
    periodic: bool = key(
        False,
        "`true`: two flat bodies with a periodic surface, see [periodic contacts](periodic.md)."
        " Such a case has no restitution. `refine` must be one number. A case with adhesion "
        'must use `adhesion = "cohesive"` and `[indentation]`. `realisations`, `[impact]` and '
        "`[unloading]` are refused",
    )

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if (self.nodes is None) != (self.spacing is None):
            missing = "nodes" if self.nodes is None else "spacing"
            raise ValueError(f'the key "{missing}" is missing; nodes and spacing belong together')
        if self.nodes is not None:
            _few_enough((self.factor * self.nodes[0], self.factor * self.nodes[1]))
        return self

    @property
    def factor(self) -> int:
        """Parts into which a cell is divided along each axis (deepest depth); 1 for "auto"."""
        if isinstance(self.refine, tuple):
            return self.refine[-1]
        return 1 if self.refine == "auto" else self.refine

    def grid(self) -> Grid | None:
        """The grid before refinement; None if the scan defines the grid."""
        return Grid(self.nodes, self.spacing) if self.nodes and self.spacing else None


Quantity = TypeVar("Quantity")
VALUES = Key(
    "a list of 1 to 10 000 values, instead of `from`, `to` and `steps` (in `[impact]`, the key is "
    "`velocity`)",
    default="–",
    page=Input(
        "Values", hint='separated by commas; used instead of "from", "to" and "Steps"', more=True
    ),
)


class Series(Table, Generic[Quantity]):
    """A table that prescribes the depths (states of loading), such as `[load]`."""

    # The page writes the `label` of the table for {}, and takes its sliders and initial values.
    from_: Annotated[Quantity | None, Field(alias="from")] = key(
        None, "first value", default="–", page=Input("{} from")
    )
    to: Quantity | None = key(
        None, "last value, larger than `from`", default="–", page=Input("{} to")
    )
    steps: Annotated[int, Field(gt=0, le=MOST_STEPS)] | None = key(
        None,
        "number of values, including both ends; at least 2",
        default="–",
        page=Input("Steps", slider=(2, 48), initial=24),
    )
    scale: Literal["log", "linear"] = key(
        "log",
        "spacing of the values",
        page=Input("Spacing of the steps", more=True, empty="logarithmic"),
    )
    values: Annotated[list[Quantity], Field(min_length=1, max_length=MOST_STEPS)] | None = key(
        None, VALUES
    )

    list_key: ClassVar[str] = "values"

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        span = (self.from_, self.to, self.steps)
        if self.values is not None:
            if span != (None, None, None):
                raise ValueError(
                    f"give either `{self.list_key}`, or `from`, `to` and `steps`, but not both"
                )
        elif None in span:
            raise ValueError(f"give `from`, `to` and `steps` (or `{self.list_key} = [...]`)")
        elif self.from_ == self.to:
            raise ValueError(
                f"`from` and `to` are equal; for a single value use `{self.list_key} = [...]`"
            )
        elif not cast(float, self.from_) < cast(float, self.to):
            raise ValueError("`from` must be smaller than `to`")
        elif self.steps == 1:
            raise ValueError(
                f"`steps` must be at least 2; for a single value use `{self.list_key} = [...]`"
            )
        return self

    def series(self) -> list[float]:
        """The prescribed values in SI units, in increasing order."""
        if self.values is not None:
            return sorted(cast(set[float], set(self.values)))
        space = np.geomspace if self.scale == "log" else np.linspace
        first, last = cast(float, self.from_), cast(float, self.to)
        return cast(list[float], space(first, last, cast(int, self.steps)).tolist())


_Listed = BeforeValidator(lambda value: value if isinstance(value, list) else [value])
_Many = Field(min_length=1, max_length=MOST_STEPS)


class ImpactTable(Series[Velocity]):
    """The table `[impact]`. With `angle` or `spin`, it also prescribes oblique impacts."""

    values: Annotated[
        list[Velocity] | None, _Listed, Field(alias="velocity", min_length=1, max_length=MOST_STEPS)
    ] = key(None, VALUES)
    angle: Annotated[list[ImpactAngle] | None, _Listed, _Many] = key(
        None,
        "one angle of impact from the normal (from 0 to below 90°), or a list",
        page=Input(
            "Angles of impact",
            hint="from the normal, separated by commas; adds depths for the normal velocities V "
            "cos θ",
            more=True,
        ),
    )
    spin: Annotated[list[Spin] | None, _Listed, _Many] = key(
        None,
        "spin of the first body before the impact, or a list of two values, one for each body; "
        "positive in the sense in which friction turns a body without spin; not in Hz. With a "
        "spin and no angle the impacts are head-on",
        default='`"0 rad/s"`',
        page=Input(
            "Spin before impact",
            hint="one value for the first body, or two values for both bodies",
            more=True,
        ),
    )

    list_key: ClassVar[str] = "velocity"

    @model_validator(mode="after")
    def _few_enough(self) -> Self:
        if self.spin is not None and len(self.spin) > 2:
            raise ValueError(
                f"spin: {len(self.spin)} values for two bodies; give one value (for the "
                "first body), or two"
            )
        impacts = len(self.velocities()) * len(self.angles())
        if impacts > MOST_STEPS:
            raise ValueError(
                f"angle: {impacts} impacts (velocities times angles) are more than {MOST_STEPS}; "
                "give fewer"
            )
        return self

    @property
    def oblique(self) -> bool:
        """Whether there are oblique impacts."""
        return self.angle is not None or self.spin is not None

    def angles(self) -> list[float]:
        """Angles of impact from the normal (rad), increasing; empty without oblique impacts."""
        return sorted(set(self.angle or [0.0])) if self.oblique else []

    def spins(self) -> tuple[float, float]:
        """Spins of the two bodies before an impact (rad/s)."""
        first, second = [*(self.spin or []), 0.0, 0.0][:2]
        return first, second

    def velocities(self) -> list[float]:
        """The prescribed velocities of the centres (m/s), in increasing order."""
        return super().series()

    def series(self) -> list[float]:
        """Normal velocities of all head-on and oblique impacts (m/s), in increasing order."""
        listed = self.velocities()
        normal = [V * math.cos(angle) for V in listed for angle in self.angles()]
        distinct: list[float] = []
        for V in sorted({*listed, *normal}):
            if not distinct or V / distinct[-1] - 1 >= _SAME:
                distinct.append(V)
            elif V in listed:
                distinct[-1] = V
        return distinct


class UnloadingTable(Table):
    """The table `[unloading]`: how many curves are written, and how unloading is computed."""

    curves: Annotated[int, Field(ge=0, le=MOST_STEPS)] = key(
        3,
        "number of depths from which the contact is unloaded step by step, including the "
        "deepest. If the case has fewer depths, the contact is unloaded from all of them",
        page=Input("Unloading curves", slider=(0, 24)),
    )
    steps: Annotated[int, Field(ge=4, le=MOST_STEPS)] = key(
        16,
        "number of steps of each unloading curve without adhesion",
        page=Input("Steps of each curve", slider=(4, 64)),
    )
    method: UnloadingMethod = key(
        "path",
        'with adhesion: `"path"` computes the unloading step by step, `"energy-estimate"` '
        "estimates its work ([adhesion](adhesion.md))",
        page=Input("Unloading with adhesion", empty="path"),
    )
    restitution_error: Annotated[float, Field(gt=0, lt=1)] = key(
        RESTITUTION_ERROR,
        "with adhesion: target for the error of COR; it determines the number of steps",
    )
