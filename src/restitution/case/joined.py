"""The table `[roughness]` of several scans of one surface, joined to one spectrum."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from restitution.case import needs
from restitution.case.measured import unit_of_length
from restitution.case.quantities import Length
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
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface
from restitution.surfaces.cache import kept
from restitution.surfaces.joined.join import join
from restitution.surfaces.joined.read import HowToRead, matching, read_spectra
from restitution.surfaces.joined.scan_spectrum import ScanSpectrum
from restitution.surfaces.joined.spectrum import JoinedSpectrum
from restitution.surfaces.joined.twin import twin_of_scans
from restitution.surfaces.level import Levelling
from restitution.surfaces.refine import divided
from restitution.surfaces.split import long_waves
from restitution.surfaces.surface import Array

_MOST_SCANS = 100
_KEYS = {
    "bridge": "roughness.bridge",
    **{
        name: f"roughness.scan.{name}"
        for name in ("height_unit", "size", "surface", "threshold", "channel", "only")
    },
}
Pattern = Annotated[str, Field(min_length=1)]


class ScanTable(Table):
    """A table `[[roughness.scan]]`: files of one surface that are read alike."""

    file: Pattern = key(
        ...,
        'a topography or line scan, a pattern such as `"afm/*.spm"`, a folder, or a container '
        "(`.zip`) of contact.engineering",
    )
    only: Pattern | None = key(
        None, "pattern for the names of the scans in a container that are used", default="all"
    )
    surface: Annotated[int, Field(ge=0)] | None = key(
        None, "number of the surface in a container", default="the only one"
    )
    channel: Annotated[int, Field(ge=0)] | None = key(
        None, "number of the height channel", default="the reader's default"
    )
    size: Annotated[tuple[Length, Length], PairOf] | None = key(
        None,
        "edge lengths in x and y (or one for both), or the length of a line scan; they "
        "replace those in the file",
        default="from the file",
    )
    height_unit: Annotated[str, AfterValidator(unit_of_length)] | None = key(
        None,
        "unit of the heights, and of the positions of a line scan without `size`",
        default="from the file, or m",
    )
    undefined: Literal["error", "interpolate"] = key(
        "error", '`"interpolate"` fills undefined pixels harmonically, up to 20 %'
    )
    outliers: Annotated[float, Field(gt=0)] | None = key(
        None, "threshold from which pixels count as outliers, as for one scan"
    )
    detrend: Levelling = key("curvature", "what is subtracted from each scan")
    tip_radius: Length | None = key(
        None, "radius of the tip: waves that it cannot resolve are left out"
    )
    resolution: Length | None = key(
        None, "shortest wave that the instrument resolves: shorter ones are left out"
    )

    @property
    def how(self) -> HowToRead:
        """How the files are read."""
        return HowToRead(**self.model_dump(exclude={"file"}))


class JoinedRoughness(Table):
    """The table `[roughness]` with `kind = "joined"`."""

    kind: Literal["joined"] = key(
        ...,
        "several scans of one surface",
        page=Input("", choices=lambda: {"joined": "joined: several scans of one surface"}),
    )
    scans: tuple[Pattern, ...] = key(
        (),
        'topographies and line scans, patterns such as `"*.di"`, folders, or containers (`.zip`) '
        "of contact.engineering",
        default="the tables `[[roughness.scan]]`",
    )
    scan: tuple[ScanTable, ...] = key(
        (), "tables `[[roughness.scan]]`, for scans with keys of their own", default="none"
    )
    bridge: bool = key(
        False,
        "`true`: a power law bridges waves that no scan shows, with its uncertainty in the error",
    )
    deviations: float = key(
        0.0,
        "number of standard deviations by which the joined spectrum is raised, for sensitivity "
        "studies",
    )
    periodic: bool = key(
        False,
        "`true`: waves longer than the grid are left out, so that its opposite edges match, as "
        "`[impacts]` and periodic contacts need",
    )
    seed: Seed = key(
        ..., "seed of the random numbers", page=Input("Seed", slider=(0, 100), initial=1)
    )
    realisations: Realisations = key(1, REALISATIONS)
    below_grid: BelowGrid | None = key(None, BELOW_GRID)
    split: Length | None = key(None, SPLIT)

    @model_validator(mode="before")
    @classmethod
    def _listed(cls, value: object) -> object:
        if not isinstance(value, dict):
            return value
        tuples = {
            name: tuple(value[name]) if isinstance(value[name], list) else (value[name],)
            for name in ("scans", "scan")
            if name in value
        }
        return {**value, **tuples}

    @model_validator(mode="after")
    def _some(self) -> Self:
        if not self.scans and not self.scan:
            raise ValueError('give scans = ["*.di"], or tables [[roughness.scan]] with a file')
        if not -10 <= self.deviations <= 10:
            raise ValueError("deviations: should be from -10 to 10")
        return self

    @property
    def tables(self) -> tuple[ScanTable, ...]:
        """All tables of scans; `scans` are read with the defaults."""
        return tuple(ScanTable(file=pattern) for pattern in self.scans) + self.scan

    def files(self, folder: Path) -> list[tuple[Path, ScanTable]]:
        """The files of all tables, each once. Raises `SurfaceError` for a pattern without files."""
        listed: dict[tuple[Path, str | None], ScanTable] = {}
        for table in self.tables:
            for path in matching(folder, table.file):
                listed[path, table.only] = table
        return [(path, table) for (path, _), table in listed.items()]

    def spectrum(self, folder: Path) -> JoinedSpectrum:
        """Read the scans in `folder` and join their spectra."""
        alike = self._alike()
        return _spectrum_of(alike, str(folder), self.stamp(folder)).raised(self.deviations)

    def _alike(self) -> Self:
        same = {"seed": 0, "realisations": 1, "below_grid": None, "split": None}
        return self.model_copy(update=same | {"deviations": 0.0, "periodic": False})

    def variant(self, number: int) -> Self:
        """The table of a single surface: `number` is added to the seed."""
        return self.model_copy(update={"seed": self.seed + number, "realisations": 1})

    @property
    def is_normal(self) -> bool:
        """True: patches have the heights of the scans."""
        return True

    def needs_patches(self, grid: Grid) -> bool:
        """False: without patches, the waves below `grid` are left out."""
        return False

    def shortest_wave(self, grid: Grid, folder: Path) -> float:
        """Length (m) of the shortest measured wave."""
        return self.spectrum(folder).shortest

    def patch_cell(self, grid: Grid, folder: Path) -> float:
        """Half of the shortest measured wave (m)."""
        return 0.5 * self.spectrum(folder).shortest

    def rms_height(self, folder: Path) -> float:
        """Rms height (m) of all measured waves."""
        spectrum = self.spectrum(folder)
        return spectrum.rms(spectrum.shortest, spectrum.longest)

    @property
    def number(self) -> int:
        """Number of the surface among those of its kind."""
        return self.seed

    def of_patches(self) -> Self:
        """The table whose patches all surfaces of this kind share."""
        return self.model_copy(update={"seed": PATCH_SEED, "realisations": 1})

    def stamp(self, folder: Path) -> Stamp:
        """Latest time and total size of the files; None if one is missing."""
        with suppress(OSError, ValueError, SurfaceError):
            paths = (path for path, _ in self.files(folder))
            stats = [path.stat() for path in paths]
            return max(stat.st_mtime_ns for stat in stats), sum(stat.st_size for stat in stats)
        return None

    def patch_room(self, folder: Path) -> float:
        """Infinite: a twin is as large as needed."""
        return math.inf

    def short_waves(self, window: Grid, wavelength: float, grid: Grid, folder: Path) -> Array:
        """Heights (m) of the waves shorter than `wavelength` (m) on `window`."""
        whole = self.surface(window, folder)
        return whole.height - long_waves(whole, wavelength).height

    def surface(
        self, grid: Grid, folder: Path, factor: int = 1, *, patches: bool = False
    ) -> Surface:
        """Make the twin on cells `factor` times smaller than those of `grid`."""
        fine = divided(grid, factor)
        with naming(_KEYS):
            spectrum = self.spectrum(folder)
            largest = max((scan.surface.grid for scan in spectrum.spectra), key=needs.nodes_of)
            needs.require(needs.measured_bytes(fine, largest, twin=True), fine)
            made_from = {
                "joined": self.model_dump(exclude={"realisations", "below_grid", "split"}),
                "path": str(folder.resolve()),
                "files": [str(path) for path, _ in self.files(folder)],
                "stamp": self.stamp(folder),
                "nodes": fine.nodes,
                "spacing": fine.spacing,
            }
            return kept(
                made_from,
                lambda: twin_of_scans(spectrum, fine, self.seed, periodic=self.periodic),
            )


@lru_cache(maxsize=8)
def _spectrum_of(part: JoinedRoughness, folder: str, _: Stamp) -> JoinedSpectrum:
    with naming(_KEYS):
        spectra: list[ScanSpectrum] = []
        for path, table in part.files(Path(folder)):
            for spectrum in read_spectra(path, table.how):
                known = any(spectrum.name == other.name for other in spectra)
                name = f"{path.parent.name}/{spectrum.name}" if known else spectrum.name
                spectra.append(replace(spectrum, name=name))
        if len(spectra) > _MOST_SCANS:
            raise SurfaceError(
                f"roughness.scans: names {len(spectra)} scans, more than {_MOST_SCANS}; give fewer"
            )
        return join(spectra, bridge=part.bridge)
