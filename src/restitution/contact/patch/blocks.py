"""The law of patches at each node: blocks of a patch, as large as a cell, have a law each.

docs/two-scales.md says why the mean of a patch is not enough where surfaces attract each other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution.contact.cohesive.bounded_law import NodeLaw, law_of
from restitution.contact.contact import Contact
from restitution.contact.influence import half_space
from restitution.contact.state import Array
from restitution.numerics.box import Box
from restitution.numerics.convolution.device import CPU, on_device
from restitution.numerics.grid import Grid
from restitution.numerics.node_tables import tabulated_potential
from restitution.surfaces import Surface

if TYPE_CHECKING:
    from restitution.contact.patch.attraction import AttractionCurve

Index = NDArray[np.intp]
Shape = tuple[int, int]

_CELLS = 256  # of the table of a block
_FAR = 10.0  # end of this table beyond the highest node of its patch, in units of z₀
_NEWTON, _SOFT = 4, 1e-6  # steps to the gap at a pressure; least slope there, in `stiffest`
_TILES = 3  # along each edge: periods of the pressure of blocks on the grid of the contact
_BEYOND = 24  # rigid states between the first solved state and this end


def shape_in(patch: Grid, cell: tuple[float, float]) -> Shape:
    """Number of blocks along each axis of `patch`, about as large as `cell` (m)."""
    nx, ny = (
        max(1, min(n, round(edge / h)))
        for n, edge, h in zip(patch.nodes, patch.size, cell, strict=True)
    )
    return nx, ny


def block_means(values: Array, shape: Shape) -> Array:
    """Mean of `values` of a patch in each of its blocks, which are centred on whole blocks."""
    rows, columns = (_shares(n, count) for n, count in zip(values.shape, shape, strict=True))
    return np.asarray(rows @ values @ columns.T)


def _owners(nodes: int, count: int) -> Index:
    return np.asarray(np.floor(np.arange(nodes) * count / nodes + 0.5), dtype=np.intp) % count


def _shares(nodes: int, count: int) -> Array:
    shares = (_owners(nodes, count) == np.arange(count)[:, None]).astype(float)
    return np.asarray(shares / shares.sum(axis=1, keepdims=True))


def levers(patch: Surface, shape: Shape, weights: Array) -> tuple[Array, Array]:
    """Distance of the weighted nodes of each block from its centre, in blocks along x and y."""
    whole = np.maximum(block_means(weights, shape), 1e-300)
    means = []
    for axis in (0, 1):
        n, count = patch.grid.nodes[axis], shape[axis]
        at = np.arange(n) * count / n
        off = (at - _owners(n, count) + 0.5 * count) % count - 0.5 * count
        along = off[:, None] if axis == 0 else off[None, :]
        means.append(block_means(weights * along, shape) / whole)
    return means[0], means[1]


@dataclass(frozen=True, eq=False)
class BlockTables:
    """The pressure of each block of one shape, as a function of its gap.

    Row k of `values` (Pa) belongs to the gaps `first`[k] + i `step`[k] (m). Beyond the last, the
    traction falls with the third power of the distance from the height `middle` (m) of the block.
    Below the first, the pressure grows at `stiffest` (Pa/m), or faster. `lever` is where the block
    attracts: the distance from its centre in cells along x and y, shape (rows, 2).
    """

    first: Array
    step: Array
    middle: Array
    values: Array
    lever: Array
    stiffest: float
    shape: Shape
    patches: int

    @classmethod
    def of(cls, curves: Sequence[AttractionCurve], cell: tuple[float, float]) -> BlockTables:
        """The blocks of all patches, one patch after the other, on cells of this size (m)."""
        parts = [_rows(curve, cell) for curve in curves]
        first, step, middle, values, lever = (np.concatenate(of) for of in zip(*parts, strict=True))
        stiff = max(_steepness(curve) for curve in curves)
        shape = curves[0].blocks.shape[1:]
        return cls(first, step, middle, values, lever, stiff, (shape[0], shape[1]), len(curves))

    def row_of(self, grid: Grid, place: int) -> Index:
        """The row of each node of `grid`; `place` selects the part of the patches at its middle."""
        across = max(1, math.isqrt(self.patches))
        tiles = across, self.patches // across
        at = np.random.default_rng(place).random(2) if place else (0.0, 0.0)
        tile, block = [], []
        for n, count, number, share in zip(grid.nodes, self.shape, tiles, at, strict=True):
            whole = count * number
            along = (np.arange(n) - n // 2 + whole // 2 + round(share * whole)) % whole
            tile.append(along // count)
            block.append(along % count)
        patch = tile[0][:, None] * tiles[1] + tile[1]
        inside = block[0][:, None] * self.shape[1] + block[1]
        return np.asarray(patch * math.prod(self.shape) + inside)

    @cached_property
    def cells(self) -> Array:
        """Of each cell of each row: coefficients of 1, t, t² and t³, t from 0 to 1, and integral.

        The integral, in units of `step`, is that from the first point to the cell.
        """
        from scipy.interpolate import PchipInterpolator

        points = np.arange(_CELLS + 1)
        slopes: Array = PchipInterpolator(points, self.values, axis=1).derivative()(points)
        slopes[:, 0] = np.minimum(slopes[:, 0], -self.stiffest * self.step)
        low, high = self.values[:, :-1], self.values[:, 1:]
        b, steep = slopes[:, :-1], slopes[:, 1:]
        c, d = 3 * (high - low) - 2 * b - steep, b + steep - 2 * (high - low)
        sums = np.cumsum(low + b / 2 + c / 3 + d / 4, axis=1)
        before = np.concatenate([np.zeros((len(sums), 1)), sums[:, :-1]], axis=1)
        return np.stack([low, b, c, d, before], axis=-1).reshape(-1, 5)

    @cached_property
    def ends(self) -> Array:
        """Of each row: slope (Pa) at the first point, last pressure (Pa), and whole integral."""
        cells = self.cells.reshape(len(self.values), _CELLS, 5)
        last = cells[:, -1]
        whole = last[:, 4] + last[:, :4] @ (1 / np.arange(1.0, 5.0))
        return np.stack([cells[:, 0, 1], self.values[:, -1], whole], axis=-1)

    @cached_property
    def peak(self) -> Index:
        """The point of the largest tension of each block."""
        return np.asarray(self.values.argmin(axis=1))

    @cached_property
    def rest(self) -> Index:
        """The last point of each block with a positive pressure; −1 if there is none."""
        return np.asarray((self.values > 0).cumprod(axis=1).sum(axis=1) - 1)

    def points_at(self, pressure: float) -> Array:
        """`point_at` of all rows."""
        if pressure not in self._points:
            rows = np.arange(len(self.values))[None]
            at = self.point_at(np.full(rows.shape, pressure), rows)
            self._points[pressure] = at[0]
        return self._points[pressure]

    def point_at(self, pressure: Array, row: Index) -> Array:
        """Where the pressure of each `row` has this value (Pa, not negative), in steps."""
        values = self.values
        low, high = np.zeros(row.shape, dtype=np.intp), np.maximum(self.rest[row], 0) + 1
        while (high - low).max(initial=1) > 1:
            middle = (low + high) // 2
            over = values[row, middle] > pressure
            low, high = np.where(over, middle, low), np.where(over, high, middle)
        here, there, most = values[row, low], values[row, low + 1], values[row, 0]
        share = (here - pressure) / np.where(here > there, here - there, 1.0)
        beyond = (most - pressure) / -self.ends[row, 0]
        at = np.where(pressure > most, beyond, low + np.clip(share, 0.0, 1.0))
        least = np.where(pressure > most, -np.inf, low)
        law = BlockLaw.of_steps(self, row)
        for _ in range(_NEWTON):
            _, tension, stiff = law.potential(at)
            way = (-tension - pressure) / np.maximum(stiff, _SOFT * self.stiffest * self.step[row])
            at = np.clip(at + way, np.minimum(least, at), np.maximum(low + 1, at))
        return at

    @cached_property
    def _points(self) -> dict[float, Array]:
        return {}


def _rows(
    curve: AttractionCurve, cell: tuple[float, float]
) -> tuple[Array, Array, Array, Array, Array]:
    from scipy.interpolate import PchipInterpolator

    contact = curve.contact
    law, shape = law_of(contact), (curve.blocks.shape[1], curve.blocks.shape[2])
    z0, patch = law.equilibrium_separation, contact.surface
    gap = np.array(
        [
            g + displacement_of(p, cell, contact.pair.contact_modulus)
            for g, p in zip(curve.gap, curve.blocks, strict=True)
        ]
    )
    local = contact.gap - contact.gap.mean()
    top = -float(local.min())
    end = max(top + _FAR * z0, float(gap[0].max()) + z0)
    beyond = np.linspace(end, float(gap[0].max()), _BEYOND, endpoint=False)
    rigid = np.array([-block_means(law.traction(local + g), shape) for g in beyond])
    flat = np.broadcast_to(beyond[:, None, None], rigid.shape)
    gaps = np.concatenate([flat, gap]).reshape(-1, math.prod(shape)).T
    pressures = np.concatenate([rigid, curve.blocks]).reshape(-1, math.prod(shape)).T
    first, values = np.empty(len(gaps)), np.empty((len(gaps), _CELLS + 1))
    share = np.linspace(0.0, 1.0, _CELLS + 1)
    for k, (g, p) in enumerate(zip(gaps, pressures, strict=True)):
        falling = np.concatenate([[True], g[1:] < np.minimum.accumulate(g)[:-1]])
        x, y = g[falling][::-1], p[falling][::-1]
        first[k] = x[0]
        values[k] = PchipInterpolator(x, y)(x[0] + (end - x[0]) * share)
    z = -local - block_top(-local, shape)
    lever = np.stack([of.ravel() for of in levers(patch, shape, -law.energy(z0 - z))], axis=1)
    middle = block_means(-local, shape).ravel()
    return first, (end - first) / _CELLS, middle, values, lever


def displacement_of(pressure: Array, cell: tuple[float, float], contact_modulus: float) -> Array:
    """Displacement (m) that the grid of the contact adds under the pressures of the blocks."""
    nx, ny = pressure.shape
    tiled = np.tile(pressure - pressure.mean(), (_TILES, _TILES))
    with on_device(CPU):
        K = half_space((tiled.shape[0], tiled.shape[1]), cell, contact_modulus)
    middle = _TILES // 2
    return np.asarray(K(tiled)[middle * nx : (middle + 1) * nx, middle * ny : (middle + 1) * ny])


def block_top(height: Array, shape: Shape) -> Array:
    """The largest `height` of the block of each node."""
    owners = [_owners(n, count) for n, count in zip(height.shape, shape, strict=True)]
    top = np.full(shape, -np.inf)
    where = owners[0][:, None], owners[1][None, :]
    np.maximum.at(top, where, height)
    return np.asarray(top[where])


def _steepness(curve: AttractionCurve) -> float:
    return float((curve.pressure[-1] - curve.pressure[-2]) / (curve.gap[-2] - curve.gap[-1]))


@dataclass(frozen=True, eq=False)
class BlockLaw(NodeLaw):
    """The law at nodes; arrays of their shape.

    Each node has a `row` of `tables`, whose first point is at the gap `first` (m), with a point
    after each `step` (m) up to `last` (m). Beyond, the gap counts from `middle` (m).
    """

    tables: BlockTables
    row: Index
    first: Array
    step: Array
    last: Array
    middle: Array

    steep = False

    @classmethod
    def on(cls, tables: BlockTables, contact: Contact, place: int) -> BlockLaw:
        """The law at all nodes of `contact`."""
        row = tables.row_of(contact.grid, place)
        lever = tables.lever[row]
        slopes = np.gradient(contact.gap)
        # The block attracts where its asperities are, not at its centre.
        farther = slopes[0] * lever[..., 0] + slopes[1] * lever[..., 1]
        return cls.of_rows(tables, row, farther)

    @classmethod
    def of_rows(cls, tables: BlockTables, row: Index, farther: Array | float = 0.0) -> BlockLaw:
        """The law of blocks that are `farther` (m) away than their nodes."""
        first, step = tables.first[row] - farther, tables.step[row]
        return cls(tables, row, first, step, first + _CELLS * step, tables.middle[row] - farther)

    @classmethod
    def of_steps(cls, tables: BlockTables, row: Index) -> BlockLaw:
        """The law of blocks whose gaps are counted in steps from the first point."""
        middle = (tables.middle[row] - tables.first[row]) / tables.step[row]
        ones = np.ones(row.shape)
        return cls(tables, row, 0 * ones, ones, _CELLS * ones, middle)

    def inside(self, box: Box) -> BlockLaw:
        first, step, last, middle = (
            a[box] for a in (self.first, self.step, self.last, self.middle)
        )
        return BlockLaw(self.tables, self.row[box], first, step, last, middle)

    @property
    def gap_of_largest_traction(self) -> Array:
        return self.first + self.step * self.tables.peak[self.row]

    def potential(self, gap: Array) -> tuple[Array, Array, Array]:
        """Energy (J/m²), traction (Pa) and its derivative (Pa/m) at the `gap` (m) of each node."""
        out, tables = np.empty_like(self._nodes), self.tables
        tabulated_potential(gap, self.row, self._nodes, tables.cells, tables.ends, out)
        energy, traction, stiffness = np.split(out, 3)
        return energy, traction, stiffness

    @cached_property
    def _nodes(self) -> Array:
        return np.concatenate([self.first, self.step, self.middle])

    def energy(self, gap: Array) -> Array:
        return self.potential(gap)[0]

    def traction(self, gap: Array) -> Array:
        return self.potential(gap)[1]

    def stiffness(self, gap: Array) -> Array:
        return self.potential(gap)[2]

    def gap_at(self, pressure: Array) -> Array:
        """Gap (m) of each node at which its pressure (Pa, not negative) has this value."""
        if np.ndim(pressure) == 0:  # a bound of the material, of which there are few
            return self.first + self.step * self.tables.points_at(float(pressure))[self.row]
        return self.first + self.step * self.tables.point_at(np.asarray(pressure), self.row)
