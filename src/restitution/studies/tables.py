"""The tables of a case file, each checked by itself and turned into what it describes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Generic, Literal, Self, TypeVar, cast

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    model_validator,
)

from restitution.collision import UnloadingMethod
from restitution.contact.separation import RESTITUTION_ERROR
from restitution.errors import shown
from restitution.numerics.grid import Grid
from restitution.studies import needs
from restitution.studies.quantities import (
    Angle,
    Length,
    Position,
    Velocity,
)
from restitution.studies.table import Table
from restitution.surfaces import (
    Surface,
    crop,
    extend,
    generate_surface,
    level,
    place_on_grid,
    read_surface,
    refine,
    remove_outliers,
)
from restitution.surfaces.cache import kept
from restitution.surfaces.extend import Extension
from restitution.surfaces.generate import RoughnessKind
from restitution.surfaces.refine import divided
from restitution.surfaces.shift import place_of

MOST_NODES = 2**27  # of a grid: more do not fit into the memory of common machines
MOST_STEPS = 10_000  # of a curve
MOST_REALISATIONS = 1000
MOST_PLACES = 10_000  # of a scan


def _two(value: Any) -> Any:
    """One value for both axes, or a list of two."""
    if not isinstance(value, list):
        return value, value
    if len(value) != 2:
        raise ValueError(f"{shown(value)} should be one value, or a list of two (for x and y)")
    return tuple(value)


Nodes = Annotated[int, Field(gt=0)]
PairOf = BeforeValidator(_two)


def _range(value: Any) -> Any:
    """A list of two positions, the second above the first."""
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError(f"{shown(value)} should be a list of two positions")
    return tuple(value)


def _ascending(value: tuple[float, float]) -> tuple[float, float]:
    if not value[0] < value[1]:
        raise ValueError("the first of the two positions must be below the second")
    return value


Range = Annotated[tuple[Position, Position], BeforeValidator(_range), AfterValidator(_ascending)]


def _few_enough(nodes: tuple[int, int]) -> tuple[int, int]:
    if nodes[0] * nodes[1] > MOST_NODES:
        raise ValueError(
            f"{shown(nodes[0])} x {shown(nodes[1])} nodes are more than a grid may have "
            f"({MOST_NODES} in all); give fewer, or a larger spacing"
        )
    return nodes


Realisations = Annotated[int, Field(ge=1, le=MOST_REALISATIONS)]
Seed = Annotated[int, Field(ge=0, lt=2**63)]


class GeneratedRoughness(Table):
    """`[roughness]` with `kind` exponential, gaussian or self-affine."""

    kind: RoughnessKind
    rms: Length
    seed: Seed
    realisations: Realisations = 1
    correlation_length: Annotated[tuple[Length, Length], PairOf] | None = None
    lay: Angle = 0.0
    hurst: float | None = None
    rolloff: Length | None = None
    shortest: Length | None = None
    skewness: float = 0.0
    kurtosis: float = 3.0
    periodic: bool = True

    def variant(self, number: int) -> Self:
        """Another surface of the same statistics; 0 is the surface itself."""
        return self.model_copy(update={"seed": self.seed + number})

    def surface(self, grid: Grid, _: Path, factor: int = 1) -> Surface:
        """The roughness of `grid`, its waves continued on cells `factor` times as small."""
        fine = divided(grid, factor)
        normal = (self.skewness, self.kurtosis) == (0.0, 3.0)
        made = needs.generated_bytes(grid, normal=normal, periodic=self.periodic)
        needs.require(max(made, needs.generated_bytes(fine, normal=True, periodic=True)), fine)
        asked = self.model_dump(exclude={"realisations"})
        return kept(
            {"generated": asked, "nodes": grid.nodes, "spacing": grid.spacing, "refine": factor},
            lambda: refine(generate_surface(grid, **asked), factor),
        )


class CropTable(Table):
    """`roughness.crop`: what part of a scan is used."""

    x: Range | None = None
    y: Range | None = None


class MeasuredRoughness(Table):
    """`[roughness]` with `kind = "measured"`."""

    kind: Literal["measured"]
    file: Annotated[str, Field(min_length=1)]
    channel: Annotated[int, Field(ge=0)] | None = None
    size: Annotated[tuple[Length, Length], PairOf] | None = None
    undefined: Literal["error", "interpolate"] = "error"
    crop: CropTable = CropTable()
    outliers: Annotated[float, Field(gt=0)] | None = None
    detrend: Literal["none", "center", "tilt", "curvature"] = "none"
    extend: Extension | None = None
    seed: Seed | None = None
    place: Annotated[int, Field(ge=0, le=MOST_PLACES)] = 0
    realisations: Realisations = 1

    @model_validator(mode="after")
    def _twins(self) -> Self:
        if self.extend == "twin" and self.seed is None:
            raise ValueError('extend = "twin" draws a random surface and needs a seed; give one')
        if self.seed is not None and self.extend != "twin":
            raise ValueError(
                'seed belongs to extend = "twin"; a scan is one surface, and has places: leave '
                "seed out, or give place"
            )
        if self.place and self.extend == "twin":
            raise ValueError("place belongs to a scan; a twin has a seed instead: leave place out")
        return self

    def variant(self, number: int) -> Self:
        """Another twin, or another place of the scan; 0 is the surface itself."""
        if self.extend == "twin":
            assert self.seed is not None  # _twins
            return self.model_copy(update={"seed": self.seed + number})
        return self.model_copy(update={"place": self.place + number})

    def scan(self, folder: Path) -> Surface:
        """What was measured, cleaned and levelled; `file` is relative to `folder`."""
        scan = read_surface(
            folder / self.file, channel=self.channel, size=self.size, undefined=self.undefined
        )
        if self.crop != CropTable():
            scan = crop(scan, x=self.crop.x, y=self.crop.y)
        if self.outliers is not None:
            scan = remove_outliers(scan, self.outliers)
        # Levelled as a whole before a grid's part is cut out: the form belongs to the scan.
        return place_of(level(scan, self.detrend), self.place)

    def surface(self, grid: Grid | None, folder: Path, factor: int = 1) -> Surface:
        """The roughness on cells `factor` times as small as those of `grid`, or as the pixels.

        Smaller cells get the scan's shorter waves, down to its pixel; below, no waves are added.
        """
        scan = self.scan(folder)
        grid = grid or scan.grid
        whole = divided(grid, factor)
        needs.require(needs.measured_bytes(whole, scan.grid, twin=self.extend == "twin"), whole)
        asked = {
            "measured": self.model_dump(exclude={"realisations"}),
            "path": str(folder / self.file),
            "sha256": scan.provenance["file_sha256"],
            "nodes": grid.nodes,
            "spacing": grid.spacing,
            "refine": factor,
        }
        return kept(asked, lambda: self._placed(scan, grid, factor))

    def _placed(self, scan: Surface, grid: Grid, factor: int) -> Surface:
        """The `scan`, continued if asked for, on cells `factor` times as small as `grid`'s."""
        if self.extend == "twin":
            # The waves of a twin have no nodes to continue them from: all grids are alike.
            placed, steps = extend(scan, divided(grid, factor), "twin", seed=self.seed), factor
        else:
            steps = self._steps_to_pixel(grid, scan.grid, factor)
            fine = divided(grid, steps)
            placed = extend(scan, fine, self.extend) if self.extend else place_on_grid(scan, fine)
        if factor == 1:
            return placed
        finer = refine(placed, factor // steps)
        how = f"placed on cells {steps} times as small"
        if factor > steps:
            how += f", then {finer.provenance['refinement']}"
        return replace(finer, provenance={**finer.provenance, "refined": factor, "refinement": how})

    def _steps_to_pixel(self, grid: Grid, pixels: Grid, factor: int) -> int:
        """The part of `factor` after which cells of `grid` are no longer larger than the pixel."""
        steps = 1
        while factor % (2 * steps) == 0 and any(
            h / steps > pixel * (1 + 1e-9)
            for h, pixel in zip(grid.spacing, pixels.spacing, strict=True)
        ):
            steps *= 2
        return steps


Roughness = Annotated[GeneratedRoughness | MeasuredRoughness, Field(discriminator="kind")]


class GridTable(Table):
    """`[grid]`; `nodes` and `spacing` may be omitted for a scan, which brings its own."""

    nodes: Annotated[tuple[Nodes, Nodes], PairOf, AfterValidator(_few_enough)] | None = None
    spacing: Annotated[tuple[Length, Length], PairOf] | None = None
    refine: Literal[1, 2, 4, 8, 16, "auto"] = 1

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
        """Cells along x and y that one is divided into; 1 where that is still to be found."""
        return 1 if self.refine == "auto" else self.refine

    def grid(self) -> Grid | None:
        """The grid before it is refined, None if it is that of the scan."""
        if self.nodes is None or self.spacing is None:
            return None
        return Grid(self.nodes, self.spacing)


Quantity = TypeVar("Quantity")


class Series(Table, Generic[Quantity]):
    """`[indentation]`, `[load]` and `[impact]`: a span with steps, or a list of values."""

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
                raise ValueError(f"give either {self.list_key} or from, to and steps, not both")
        elif None in span:
            raise ValueError(f"give from, to and steps (or {self.list_key} = [...])")
        elif self.from_ == self.to:
            raise ValueError(
                f"from and to are the same; for a single one use {self.list_key} = [...]"
            )
        elif not cast(float, self.from_) < cast(float, self.to):
            raise ValueError("from must be smaller than to")
        elif self.steps == 1:
            raise ValueError(
                "steps = 1 does not reach from one to the other; give at least 2, or for a single "
                f"one use {self.list_key} = [...]"
            )
        return self

    def series(self) -> list[float]:
        """The values asked for, in SI units, increasing."""
        if self.values is not None:
            return sorted(cast(set[float], set(self.values)))
        space = np.geomspace if self.scale == "log" else np.linspace
        first, last = cast(float, self.from_), cast(float, self.to)
        return [float(v) for v in space(first, last, cast(int, self.steps))]


class ImpactTable(Series[Velocity]):
    """`[impact]`: a span of velocities with steps, or the list `velocity`."""

    values: Annotated[
        list[Velocity] | None,
        BeforeValidator(lambda value: value if isinstance(value, list) else [value]),
        Field(alias="velocity", min_length=1, max_length=MOST_STEPS),
    ] = None

    list_key: ClassVar[str] = "velocity"


class UnloadingTable(Table):
    """`[unloading]`: which curves are written, and how unloading is computed."""

    curves: Annotated[int, Field(ge=0, le=MOST_STEPS)] = 3
    steps: Annotated[int, Field(ge=4, le=MOST_STEPS)] = 16
    method: UnloadingMethod = "path"
    restitution_error: Annotated[float, Field(gt=0, lt=1)] = RESTITUTION_ERROR
