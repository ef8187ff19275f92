"""Keys of both kinds of `[roughness]`, and the errors of surfaces in terms of the case file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Annotated, Literal

from pydantic import Field

from restitution.case.rulebook import Input, Key
from restitution.errors import SurfaceError
from restitution.surfaces.refused import Code, RefusedSurfaceError
from restitution.surfaces.twin import LEAST_PIXELS

MOST_REALISATIONS = 1000
PATCH_SEED = 2_718_281  # all surfaces of one kind share their patches, and so their law
# Defaults of `split`, in cells of the grid. With adhesion, more waves make a law of longer range.
CELLS, ADHESIVE_CELLS = 2, 4

Realisations = Annotated[int, Field(ge=1, le=MOST_REALISATIONS)]
REALISATIONS = Key(
    "number of twins, or of places of the scan",
    page=Input(
        "Surfaces",
        hint="the curve is the mean over them; while a slider moves, only the first is computed",
        slider=(1, 16),
    ),
)
Seed = Annotated[int, Field(ge=0, lt=2**63)]

# Time (ns) and size (bytes) of the file of a surface, which change if the file is replaced.
Stamp = tuple[int, int] | None
BelowGrid = Literal["patch", "omit"]
BELOW_GRID = Key(
    'what happens to waves that the grid does not carry ([two scales](two-scales.md)): `"patch"` '
    "solves them on periodic patches, whose law the contact uses (dry scans without `refine`: on "
    'smaller cells where a contact is small beside the patches); `"omit"` leaves them out, and the '
    "total error includes them",
    default='`"patch"` for generated waves below two cells, and for scans where their waves matter '
    "and bodies do not adhere",
    page=Input("Waves below the grid", more=True, empty="on patches where they matter"),
)
SPLIT = Key(
    "wavelength at which the surface is split: shorter waves go into the patches; at least two "
    "grid spacings, and below the contact radius",
    default=f"{CELLS} grid spacings, with adhesion {ADHESIVE_CELLS}",
    only=("below_grid", "", "patch"),
    otherwise='split: belongs to below_grid = "patch"; remove split',
)

# For each `RefusedSurfaceError.code`, the remedy in terms of the case file.
_REMEDIES: dict[Code, str] = {
    "cells-above-scan": "use a smaller grid.spacing",
    "flat-scan": 'leave roughness.extend out, or set roughness.extend = "mirror"',
    "grid-beyond-surface": "use a smaller grid.nodes or grid.spacing, a larger scan, or "
    "roughness.extend",
    "height-unit-unknown": 'set roughness.height_unit = "um" (or the unit that they have)',
    "heights-impossible": 'set roughness.height_unit = "um" (or "mm", "nm"), or correct '
    "roughness.size",
    "masked-pixels": 'set roughness.undefined = "interpolate" to fill them from their neighbours, '
    "remove the mask in Gwyddion, or set roughness.crop",
    "size-impossible": 'give its edge lengths, such as roughness.size = ["10 um", "10 um"]',
    "size-unknown": 'give its edge lengths, such as roughness.size = ["10 um", "10 um"]',
    "too-few-pixels": f"use a scan of at least {LEAST_PIXELS} x {LEAST_PIXELS}, or set "
    'roughness.extend = "mirror"',
    "too-many-undefined": 'set roughness.crop = { x = ["-4 um", "4 um"], y = ["-4 um", "4 um"] } '
    "to use a part with fewer, or measure again",
    "undefined-pixels": 'set roughness.undefined = "interpolate" to fill them from their '
    "neighbours, or crop the file",
}


@contextmanager
def naming(keys: Mapping[str, str]) -> Iterator[None]:
    """Name keys (`keys`, by argument) and remedies of the case file in errors of `surfaces`."""
    try:
        yield
    except RefusedSurfaceError as error:
        raise SurfaceError(f"{error.fact}; {_REMEDIES[error.code]}") from None
    except SurfaceError as error:
        raise error.renamed(keys) from None
