"""The table `[roughness]` of a scan to read and place on the grid."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from restitution.case import needs
from restitution.case.quantities import Length, Position
from restitution.case.roughness_keys import (
    BELOW_GRID,
    PATCH_SEED,
    REALISATIONS,
    SPLIT,
    BelowGrid,
    Realisations,
    Seed,
    Stamp,
    naming,
)
from restitution.case.rulebook import Input, key
from restitution.case.schema import PairOf, Table
from restitution.errors import shown
from restitution.numerics.grid import Grid
from restitution.surfaces import (
    Surface,
    extend,
    level,
    place_on_grid,
    read_surface,
    refine,
    remove_outliers,
)
from restitution.surfaces.cache import kept
from restitution.surfaces.defects import noted
from restitution.surfaces.extend import Extension
from restitution.surfaces.level import Levelling
from restitution.surfaces.reading.scan import UNITS, in_metres
from restitution.surfaces.refine import divided
from restitution.surfaces.shift import note_mirrored_part, place_of
from restitution.surfaces.split import long_waves
from restitution.surfaces.surface import Array

# Largest value of the key `place`. It is the number of a point in a fixed sequence (see
# `surfaces.shift`). The scan is moved so that this point is in the middle.
MOST_PLACES = 10_000
# Key of the case file for each argument of `crop` and `remove_outliers`.
_CLEANING_KEYS = {
    "x": "roughness.crop.x",
    "y": "roughness.crop.y",
    "threshold": "roughness.outliers",
}


def _range(value: Any) -> Any:
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError(f"{shown(value)} should be a list of two positions")
    return tuple(value)


def _ascending(value: tuple[float, float]) -> tuple[float, float]:
    if not value[0] < value[1]:
        raise ValueError("the first of the two positions must be smaller than the second")
    return value


Range = Annotated[tuple[Position, Position], BeforeValidator(_range), AfterValidator(_ascending)]


def unit_of_length(value: str) -> str:
    """`value`, which must be a unit of length."""
    if in_metres(1.0, value) is None:
        raise ValueError(f"{shown(value)} is not a unit of length; give {UNITS}")
    return value


class CropTable(Table):
    """The table `roughness.crop`: the part of a scan that is used."""

    x: Range | None = None
    y: Range | None = None


class MeasuredRoughness(Table):
    """The table `[roughness]` with `kind = "measured"`."""

    kind: Literal["measured"] = key(
        ..., "a scan", page=Input("", choices=lambda: {"measured": "measured: a scan"})
    )
    file: Annotated[str, Field(min_length=1)] = key(
        ..., "topography file", page=Input("Scan", hint="drop a file onto the page")
    )
    channel: Annotated[int, Field(ge=0)] | None = key(
        None,
        "number of the height channel",
        default="the reader's default",
        page=Input("Channel of the file", more=True),
    )
    size: Annotated[tuple[Length, Length], PairOf] | None = key(
        None,
        "edge lengths in x and y (or one for both); they replace those in the file, with a "
        "warning if these differ",
        default="from the file",
        page=Input("Edge lengths", hint="if the file lacks them, or is wrong", more=True),
    )
    height_unit: Annotated[str, AfterValidator(unit_of_length)] | None = key(
        None,
        'unit of the heights: `"m"`, `"mm"`, `"um"`, `"nm"` or `"pm"`; it replaces the unit in '
        "the file, with a warning if this differs",
        default="from the file, or m",
        page=Input(
            "Unit of the heights",
            more=True,
            empty="as in the file, or m",
            choices=lambda: {unit: unit for unit in ("um", "nm", "mm", "m", "pm")},
        ),
    )
    undefined: Literal["error", "interpolate"] = key(
        "error",
        '`"interpolate"` fills undefined pixels harmonically, up to 20 % of the part that '
        "`crop` selects",
        page=Input("Missing pixels", more=True, empty="refuse"),
    )
    crop: CropTable = key(
        CropTable(),
        '`{ x = ["-4 um", "5 um"], y = [...] }`: the part of the scan that is used, from a '
        "first to a last `x` and `y` (`x` or `y` may be left out). The coordinates are those "
        "of the map that `restitution surface` draws of the scan without `crop` (0 in the "
        "middle of the scan). A range must not extend beyond the scan",
        default="all",
    )
    outliers: Annotated[float, Field(gt=0)] | None = key(
        None,
        "pixels whose height above a fitted paraboloid differs from the median of the 5 × 5 "
        "pixels around them by more than this number of robust standard deviations are "
        "replaced harmonically; 6 to 10 removes spikes and dust of up to 3 × 3 pixels, and up "
        "to two slipped lines side by side",
        page=Input(
            "Outlier threshold",
            hint="in standard deviations",
            slider=(3, 30),
            logarithmic=True,
            more=True,
        ),
    )
    detrend: Levelling = key(
        "none",
        "what is subtracted: the mean, a plane or a paraboloid, fitted to the part of the scan "
        "that is used",
        page=Input("Subtract", initial="curvature", empty="nothing"),
    )
    extend: Extension | None = key(
        None,
        "for a grid larger than the scan, see below",
        page=Input("Extend the scan", more=True, empty="no"),
    )
    seed: Seed | None = key(
        None,
        "seed of the random numbers",
        default="required for a twin",
        only=("extend", "twin"),
        otherwise='seed applies only to extend = "twin"; remove seed, or set place to select '
        "another part of the scan",
        page=Input("Seed of the twin", slider=(0, 100), initial=1),
    )
    place: Annotated[int, Field(ge=0, le=MOST_PLACES)] = key(
        0,
        "number of the point of the scan that lies in the middle of the contact. 0 is the "
        "centre of the scan; the points 1, 2 … are distributed evenly over the scan. If the "
        "grid extends beyond an edge of the scan, the mirror image of the scan continues it "
        "there, and a warning says so",
        only=("extend", "", "mirror"),
        otherwise='place does not apply to extend = "twin"; remove place, or vary seed',
    )
    realisations: Realisations = key(1, REALISATIONS)

    @model_validator(mode="after")
    def _seeded(self) -> Self:
        if self.extend == "twin" and self.seed is None:
            raise ValueError('extend = "twin" makes a random surface and needs a seed; give a seed')
        return self

    below_grid: BelowGrid | None = key(None, BELOW_GRID)
    split: Length | None = key(None, SPLIT)

    def variant(self, number: int) -> Self:
        """The table of a single surface: `number` is added to the seed of a twin, or to `place`."""
        if self.seed is None:  # the surface is not a twin
            return self.model_copy(update={"place": self.place + number, "realisations": 1})
        return self.model_copy(update={"seed": self.seed + number, "realisations": 1})

    def scan(self, folder: Path) -> Surface:
        """Read, clean and level the scan, and move it to its `place`; `folder` holds the file."""
        with naming(_CLEANING_KEYS):
            scan = read_surface(
                folder / self.file,
                channel=self.channel,
                size=self.size,
                height_unit=self.height_unit,
                undefined=self.undefined,
                within=(self.crop.x, self.crop.y),
            )
            if self.outliers is not None:
                scan = remove_outliers(scan, self.outliers)
        # Level the scan before cutting out the part that the grid covers, because tilt and form are
        # properties of the whole scan.
        return place_of(noted(level(scan, self.detrend)), self.place)

    @property
    def is_normal(self) -> bool:
        """True: patches have the heights of the scan."""
        return True

    def needs_patches(self, grid: Grid) -> bool:
        """False: without patches, the waves below `grid` are left out."""
        return False

    def shortest_wave(self, grid: Grid, folder: Path) -> float:
        """Length (m) of the shortest wave of the scan."""
        return 2 * self.patch_cell(grid, folder)

    def patch_cell(self, grid: Grid, folder: Path) -> float:
        """The smaller edge (m) of a pixel."""
        return min(self._unmoved(folder).grid.spacing)

    def rms_height(self, folder: Path) -> float:
        """Rms height (m) of the whole scan."""
        return float(self._unmoved(folder).height.std())

    @property
    def number(self) -> int:
        """Number of the surface among those of its kind."""
        return self.place if self.seed is None else self.seed

    def of_patches(self) -> Self:
        """The table whose patches all surfaces of this kind share."""
        seed = None if self.seed is None else PATCH_SEED
        return self.model_copy(update={"seed": seed, "place": 0, "realisations": 1})

    def stamp(self, folder: Path) -> Stamp:
        """Time and size of the file; None if it is missing, which whoever reads it says."""
        with suppress(OSError, ValueError):  # a name may contain a null character
            stat = (folder / self.file).stat()
            return stat.st_mtime_ns, stat.st_size
        return None

    def patch_room(self, folder: Path) -> float:
        """Edge (m) of the largest square window with short waves."""
        return min(self._unmoved(folder).grid.size) if self.extend is None else math.inf

    def short_waves(self, window: Grid, wavelength: float, grid: Grid, folder: Path) -> Array:
        """Heights (m) of the waves shorter than `wavelength` (m) on `window`."""
        whole = self.surface(window, folder)
        return whole.height - long_waves(whole, wavelength).height

    def _unmoved(self, folder: Path) -> Surface:
        alike = self.model_copy(update={"seed": None, "place": 0})
        return _scan_of(alike, str(folder), self.stamp(folder))

    def surface(
        self, grid: Grid | None, folder: Path, factor: int = 1, *, patches: bool = False
    ) -> Surface:
        """Make the roughness on cells `factor` times smaller than those of `grid` or the scan."""
        scan = self.scan(folder)
        grid = grid or scan.grid
        whole = divided(grid, factor)
        needs.require(needs.measured_bytes(whole, scan.grid, twin=self.extend == "twin"), whole)
        made_from = {
            "measured": self.model_dump(exclude={"realisations", "below_grid", "split"}),
            "path": str(folder / self.file),
            "sha256": scan.provenance["file_sha256"],
            "nodes": grid.nodes,
            "spacing": grid.spacing,
            "refine": factor,
        }
        with naming({}):
            return kept(made_from, lambda: self._placed(scan, grid, factor))

    def _placed(self, scan: Surface, grid: Grid, factor: int) -> Surface:
        """Place the scan, extended if `extend` is given, on cells `factor` times smaller."""
        if self.extend == "twin":
            # A twin is a random surface with the statistics of the scan. Its waves do not depend on
            # the grid, so evaluate them on the fine grid.
            placed, steps = extend(scan, divided(grid, factor), "twin", seed=self.seed), factor
        else:
            steps = self._steps_to_pixel(grid, scan.grid, factor)
            fine = divided(grid, steps)
            placed = extend(scan, fine, self.extend) if self.extend else place_on_grid(scan, fine)
            placed = note_mirrored_part(placed)
        if factor == 1:
            return placed
        finer = refine(placed, factor // steps)
        how = f"placed on cells {steps} times as small"
        if factor > steps:
            how += f", then {finer.provenance['refinement']}"
        return replace(finer, provenance={**finer.provenance, "refined": factor, "refinement": how})

    def _steps_to_pixel(self, grid: Grid, pixels: Grid, factor: int) -> int:
        """Parts, along each axis, into which cells are divided to be no larger than the pixels.

        A power of two that divides `factor`.
        """
        steps = 1
        while factor % (2 * steps) == 0 and any(
            h / steps > pixel * (1 + 1e-9)
            for h, pixel in zip(grid.spacing, pixels.spacing, strict=True)
        ):
            steps *= 2
        return steps


@lru_cache(maxsize=8)
def _scan_of(part: MeasuredRoughness, folder: str, _: Stamp) -> Surface:
    return part.scan(Path(folder))
