"""A scan made larger than what was measured: by tiles of its mirror image, or by a twin.

Neither is the surface that was measured, and both say so (`notice` in the provenance).
"""

from __future__ import annotations

import math
from typing import Literal, get_args

import numpy as np

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.surface import Surface
from restitution.surfaces.twin import twin

Extension = Literal["twin", "mirror"]


def extend(
    surface: Surface, size: tuple[float, float], how: Extension, *, seed: int | None = None
) -> Surface:
    """A surface of at least `size` (m) along x and y with the pixels of the scan `surface`.

    - `twin`: another surface, of random phases from `seed`, with the spectrum, the distribution of
      heights and the rms slope of the scan; see `twin`. It has no waves longer than the scan.
    - `mirror`: the scan in the middle, continued by its mirror image beyond every edge, and so on.
      It repeats itself, and slopes jump where tiles meet.

    Raises `SurfaceError` for another `how`, a size that is not positive, a twin without a seed and
    a mirrored surface with one.
    """
    if how not in get_args(Extension):
        raise SurfaceError(f"extend: {how!r} is unknown; choose 'twin' or 'mirror'")
    if not all(math.isfinite(edge) and edge > 0 for edge in size):
        raise SurfaceError(f"extend: {size} m are not two positive lengths")
    wanted = tuple(
        math.ceil(edge / h * (1 - 1e-9)) for edge, h in zip(size, surface.grid.spacing, strict=True)
    )
    nodes = wanted[0], wanted[1]
    if how == "twin":
        if seed is None or seed < 0:
            raise SurfaceError("roughness.seed: a twin needs one, a whole number from 0 up")
        return twin(surface, nodes, seed)
    if seed is not None:
        raise SurfaceError('roughness.seed: does not belong to extend = "mirror"; leave it out')
    return _mirrored(surface, nodes)


def _mirrored(surface: Surface, nodes: tuple[int, int]) -> Surface:
    have = surface.grid.nodes
    if nodes[0] <= have[0] and nodes[1] <= have[1]:
        return surface
    nodes = max(nodes[0], have[0]), max(nodes[1], have[1])
    # Both grids have their origin at node n // 2.
    before = tuple(n // 2 - m // 2 for n, m in zip(nodes, have, strict=True))
    after = tuple(n - m - b for n, m, b in zip(nodes, have, before, strict=True))
    tiles = " x ".join(f"{n / m:.3g}" for n, m in zip(nodes, have, strict=True))
    return Surface(
        np.pad(surface.height, list(zip(before, after, strict=True)), mode="symmetric"),
        Grid(nodes, surface.grid.spacing),
        {
            **surface.provenance,
            "source": "mirrored",
            "extension": f"mirrored tiling, {tiles} times the scan",
            "notice": f"{surface.provenance.get('file', 'the scan')}: the surface is {tiles} "
            "tiles of the scan and its mirror images, and repeats itself",
        },
    )
