"""A scan continued beyond what was measured: by tiles of its mirror image, or by a twin.

Neither is the surface that was measured, and both say so (`notice` in the provenance).
"""

from __future__ import annotations

import math
from typing import Literal, get_args

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.mirror import mirrored
from restitution.surfaces.surface import Surface
from restitution.surfaces.twin import twin

Extension = Literal["twin", "mirror"]


def extend(
    surface: Surface, to: Grid | tuple[float, float], how: Extension, *, seed: int | None = None
) -> Surface:
    """The scan `surface` continued over the grid `to`, or over edges `to` (m) with its own pixels.

    - `twin`: another surface, of random phases from `seed`, with the spectrum, the distribution of
      heights and the rms slope of the scan; see `twin`. It has no waves longer than the scan.
    - `mirror`: the scan in the middle, continued by its mirror image beyond every edge, and so on.
      It repeats itself, and slopes jump where tiles meet.

    Waves that the cells of the grid cannot carry are left out. Raises `SurfaceError` for another
    `how`, a size that is not positive, a twin without a seed, a mirrored surface with one, and as
    `twin`.
    """
    if how not in get_args(Extension):
        raise SurfaceError(f"extend: {how!r} is unknown; choose 'twin' or 'mirror'")
    grid = to if isinstance(to, Grid) else _with_pixels_of(surface, to)
    if how == "twin":
        if seed is None or seed < 0:
            raise SurfaceError("seed: a twin needs one, a whole number from 0 up")
        return twin(surface, grid, seed)
    if seed is not None:
        raise SurfaceError('seed: does not belong to extend = "mirror"; leave it out')
    return mirrored(surface, grid)


def _with_pixels_of(surface: Surface, size: tuple[float, float]) -> Grid:
    if not all(math.isfinite(edge) and edge > 0 for edge in size):
        raise SurfaceError(f"extend: {size} m are not two positive lengths")
    nx, ny = (
        math.ceil(edge / h * (1 - 1e-9)) for edge, h in zip(size, surface.grid.spacing, strict=True)
    )
    return Grid((nx, ny), surface.grid.spacing)
