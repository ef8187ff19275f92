"""Maps of pressure and plastic displacement at every depth: the file `maps.nc`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from restitution.contact.state import Array, State
from restitution.curve.columns import Column, Record
from restitution.numerics.box import Box, bounding_box, reframe
from restitution.numerics.grid import Grid
from restitution.results.writer import replace_file

MAPS_FILE = "maps.nc"
_MAPS = {
    "pressure": Column("", "pressure", "Pa", "contact pressure"),
    "plastic": Column("", "plastic_displacement", "m", "lowering of the surface by yielding"),
}


@dataclass(frozen=True, eq=False)
class DepthMaps:
    """The maps of one depth; each is kept on the box of its nonzero nodes."""

    grid: Grid
    pressure: tuple[Box, Array]
    plastic: tuple[Box, Array]

    @classmethod
    def of(cls, state: State) -> DepthMaps:
        plastic = state.plastic_displacement
        lowered = bounding_box(plastic != 0) or (slice(0, 0), slice(0, 0))
        return cls(
            state.contact.grid, (state.box, state.box_pressure), (lowered, plastic[lowered].copy())
        )

    def on(self, name: str, grid: Grid) -> Array:
        """The map `name` at the nodes of `grid`, whose cells are not larger than those of the map.

        Each node takes the value of the cell in which it lies.
        """
        box, values = getattr(self, name)
        whole = slice(0, self.grid.nodes[0]), slice(0, self.grid.nodes[1])
        full = reframe(values, box, whole)
        if grid == self.grid:
            return full
        # Nodes are counted from the origin, which all grids share (see `Grid`).
        ratio = grid.nodes[0] // self.grid.nodes[0]
        rows, columns = (
            np.clip((2 * (np.arange(m) - m // 2) + ratio) // (2 * ratio) + n // 2, 0, n - 1)
            for m, n in zip(grid.nodes, self.grid.nodes, strict=True)
        )
        return full[np.ix_(rows, columns)]


def write_maps(
    folder: Path | None,
    maps: Sequence[DepthMaps],
    points: Sequence[Record],
    along: Mapping[str, str],
) -> None:
    """Write `maps.nc` on the finest grid of the depths, completely or not at all.

    `maps` and `points` have an item for each depth. `along` gives headers of columns and the names
    of their variables: first the coordinate of the depths, then others. Only one map at a time is
    expanded to the whole grid.
    """
    import netCDF4

    if not maps or folder is None:
        return
    columns, rows = points[0].columns(), [point.cells() for point in points]
    grid = min((one.grid for one in maps), key=lambda grid: grid.spacing)
    depth, *others = along.values()

    def write(to: Path) -> None:
        with netCDF4.Dataset(to, "w") as file:
            for name, values in (("x", grid.x), ("y", grid.y)):
                file.createDimension(name, values.size)
                file.createVariable(name, "f8", (name,))[:] = values
                file[name].units = "m"
            file.createDimension(depth, len(maps))
            for key, name in along.items():
                values = np.array([row[key] for row in rows], dtype=float)
                _variable(file, name, columns[key], (depth,))[:] = values
            for name, column in _MAPS.items():
                held = _variable(file, column.variable, column, (depth, "x", "y"))
                held.coordinates = " ".join(others)
                for number, one in enumerate(maps):
                    held[number] = one.on(name, grid)

    replace_file(folder / MAPS_FILE, write)


def _variable(file: Any, name: str, column: Column, along: tuple[str, ...]) -> Any:
    variable = file.createVariable(name, "f8", along, zlib=True, complevel=1)
    variable.units, variable.long_name = column.unit, column.meaning
    return variable
