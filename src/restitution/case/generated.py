"""The table `[roughness]` of a surface to generate."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Self

from restitution.case import needs
from restitution.case.quantities import Angle, Length
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
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, generate_surface, refine
from restitution.surfaces.cache import kept
from restitution.surfaces.generate import WAVES, RoughnessKind, Waves, spectrum_of_kind
from restitution.surfaces.refine import divided
from restitution.surfaces.split import Bands
from restitution.surfaces.surface import Array

PER_WAVE = 6  # cells of a patch per shortest wave of a generated surface


def _kinds_with(wave: str) -> tuple[str, ...]:
    return "kind", *(kind for kind, waves in WAVES.items() if wave in waves)


class GeneratedRoughness(Table):
    """The table `[roughness]` with `kind` exponential, gaussian or self-affine."""

    kind: RoughnessKind = key(
        ...,
        "kind of the autocorrelation or of the spectrum",
        page=Input("Roughness", empty="smooth"),
    )
    rms: Length = key(
        ..., "Rq, met exactly", page=Input("Rq", slider=(1e-9, 1e-5), initial="0.1 um")
    )
    correlation_length: Annotated[tuple[Length, Length], PairOf] | None = key(
        None,
        "distance at which the autocorrelation has fallen to 10 %; one value, or two (along "
        "the lay and across it); at least one grid spacing, and at most half the size of the "
        "grid",
        default="required unless self-affine",
        only=_kinds_with("correlation_length"),
        page=Input("Correlation length", slider=(1e-8, 1e-4), initial="2 um"),
    )
    lay: Angle = key(
        0.0,
        "direction of the first correlation length, from the x axis",
        default='`"0 deg"`',
        only=_kinds_with("lay"),
    )
    hurst: float | None = key(
        None,
        "Hurst exponent H, above 0 and up to 1: the power spectral density falls as q^−2(H+1)",
        default="required if self-affine",
        only=_kinds_with("hurst"),
        page=Input("Hurst exponent", slider=(0.05, 0.99), initial=0.8),
    )
    rolloff: Length | None = key(
        None,
        "wavelength above which the spectrum is flat",
        default="size of the grid",
        only=_kinds_with("rolloff"),
        page=Input("Roll-off wavelength", slider=(1e-8, 1e-4), initial="10 um"),
    )
    shortest: Length | None = key(
        None,
        "waves shorter than this are left out",
        default="two grid spacings",
        page=Input("Shortest wavelength", slider=(1e-9, 1e-5), more=True),
    )
    skewness: float = key(0.0, "skewness of the heights")
    kurtosis: float = key(
        3.0, "kurtosis of the heights (normal distribution: 3); at least skewness² + 1.1"
    )
    periodic: bool = key(True, "whether the heights at opposite edges of the surface match")
    seed: Seed = key(
        ..., "seed of the random numbers", page=Input("Seed", slider=(0, 100), initial=1)
    )
    realisations: Realisations = key(
        1,
        replace(
            REALISATIONS,
            meaning="number of surfaces, with the seeds `seed`, `seed` + 1, …: `run` then computes "
            "the mean, the standard deviation and the confidence interval of COR, see "
            "[results](results.md)",
        ),
    )

    below_grid: BelowGrid | None = key(None, BELOW_GRID)
    split: Length | None = key(None, SPLIT)

    def variant(self, number: int) -> Self:
        """Return the table of a single surface, with the seed increased by `number`."""
        return self.model_copy(update={"seed": self.seed + number, "realisations": 1})

    def surface(self, grid: Grid, _: Path, factor: int = 1, *, patches: bool = False) -> Surface:
        """Generate the surface on `grid` and interpolate it to cells `factor` times smaller.

        With `patches`, waves below the grid are left to them.
        """
        fine = divided(grid, factor)
        needed = needs.generated_bytes(grid, normal=self.is_normal, periodic=self.periodic)
        needs.require(max(needed, needs.generated_bytes(fine, normal=True, periodic=True)), fine)
        waves = self.model_dump(exclude={"realisations", "below_grid", "split"})
        if patches and self.needs_patches(grid):
            waves |= {"shortest": None, "rms": self.rms * self._bands(grid).share()}
            if self.kind == "self-affine":
                waves["shortest"] = 2 * max(grid.spacing)
        made_from = {
            "generated": waves,
            "nodes": grid.nodes,
            "spacing": grid.spacing,
            "refine": factor,
        }
        with naming({argument: f"roughness.{argument}" for argument in waves}):
            return kept(made_from, lambda: refine(generate_surface(grid, **waves), factor))

    @property
    def is_normal(self) -> bool:
        """Whether the heights of patches have the distribution of the surface."""
        return (self.skewness, self.kurtosis) == (0.0, 3.0)

    def _bands(self, grid: Grid) -> Bands:
        waves: Any = {name: getattr(self, name) for name in Waves.__annotations__}
        shortest = self.shortest or 2 * max(grid.spacing)
        return Bands(spectrum_of_kind(self.kind, waves), grid, shortest)

    def needs_patches(self, grid: Grid) -> bool:
        """Whether `shortest` is a wave that `grid` cannot represent."""
        shortest = self.shortest or math.inf
        return self.is_normal and shortest < 2 * max(grid.spacing) * (1 - 1e-9)

    def shortest_wave(self, grid: Grid, folder: Path) -> float:
        """Length (m) of the shortest wave of the surface."""
        return self.shortest or 2 * max(grid.spacing)

    def patch_cell(self, grid: Grid, folder: Path) -> float:
        """Cell (m) that resolves the shortest wave in a patch."""
        return self.shortest_wave(grid, folder) / PER_WAVE

    def rms_height(self, folder: Path) -> float:
        """Rms height (m)."""
        return self.rms

    @property
    def number(self) -> int:
        """Number of the surface among those of its kind."""
        return self.seed

    def of_patches(self) -> Self:
        """The table whose patches all surfaces of this kind share."""
        return self.model_copy(update={"seed": PATCH_SEED, "realisations": 1})

    def stamp(self, folder: Path) -> Stamp:
        """None: the surface has no file."""
        return None

    def patch_room(self, folder: Path) -> float:
        """Largest edge (m) of a window with short waves."""
        return math.inf

    def short_waves(self, window: Grid, wavelength: float, grid: Grid, folder: Path) -> Array:
        """Heights (m) of the waves shorter than `wavelength` (m) on `window`."""
        return self._bands(grid).short_waves(window, wavelength, self.rms, self.seed)
