"""Tables of the case file: the base class, and tables for the grid, loading and unloading."""

from __future__ import annotations

import math
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
    """Base class of tables: rejects unknown keys and values of a wrong type."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, populate_by_name=True)


def _two(value: Any) -> Any:
    """Make a tuple for the two axes from one value or a list of two values."""
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
    """Check `refine`: a refinement factor, a list with a factor for each depth, or "auto"."""
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

    nodes: Annotated[tuple[Nodes, Nodes], PairOf, AfterValidator(_few_enough)] | None = None
    spacing: Annotated[tuple[Length, Length], PairOf] | None = None
    refine: Annotated[int | tuple[int, ...] | Literal["auto"], PlainValidator(_factors)] = 1
    periodic: bool = False

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
        """Refinement factor of the grid; 1 for "auto".

        The factor is the number of parts into which a cell is divided along each axis. If `refine`
        contains a factor for each depth, the factor of the deepest depth is returned.
        """
        if isinstance(self.refine, tuple):
            return self.refine[-1]
        return 1 if self.refine == "auto" else self.refine

    def grid(self) -> Grid | None:
        """The grid before refinement; None if the scan defines the grid."""
        return Grid(self.nodes, self.spacing) if self.nodes and self.spacing else None


Quantity = TypeVar("Quantity")


class Series(Table, Generic[Quantity]):
    """A table that prescribes the depths (states of loading), such as `[load]`.

    The prescribed values are given as a range with steps or as a list.
    """

    from_: Annotated[Quantity | None, Field(alias="from")] = None
    to: Quantity | None = None
    steps: Annotated[int, Field(gt=0, le=MOST_STEPS)] | None = None
    scale: Literal["log", "linear"] = "log"
    values: Annotated[list[Quantity], Field(min_length=1, max_length=MOST_STEPS)] | None = None

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
    """The table `[impact]`: a range of velocities with steps, or the list `velocity`.

    If `angle` or `spin` is given, oblique impacts are computed, too. Each combination of a velocity
    and an angle defines an oblique impact. The velocity is the relative velocity of the centres,
    and the angle is measured from the normal. `spin` lists the spin of the first body, or the spins
    of both bodies.
    """

    values: Annotated[
        list[Velocity] | None,
        _Listed,
        Field(alias="velocity", min_length=1, max_length=MOST_STEPS),
    ] = None
    angle: Annotated[list[ImpactAngle] | None, _Listed, _Many] = None
    spin: Annotated[list[Spin] | None, _Listed, _Many] = None

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
        found: list[float] = []
        for V in sorted({*listed, *normal}):
            if not found or V / found[-1] - 1 >= _SAME:
                found.append(V)
            elif V in listed:
                found[-1] = V
        return found


class UnloadingTable(Table):
    """The table `[unloading]`: how many curves are written, and how unloading is computed."""

    curves: Annotated[int, Field(ge=0, le=MOST_STEPS)] = 3
    steps: Annotated[int, Field(ge=4, le=MOST_STEPS)] = 16
    method: UnloadingMethod = "path"
    restitution_error: Annotated[float, Field(gt=0, lt=1)] = RESTITUTION_ERROR
