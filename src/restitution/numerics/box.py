"""Boxes: rectangular blocks of a grid, and arrays on them."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Box = tuple[slice, slice]
Scalar = TypeVar("Scalar", bound=np.generic)

NOWHERE: Box = (slice(0, 0), slice(0, 0))  # an empty box


def shape_of(box: Box) -> tuple[int, int]:
    """Number of nodes of the box along x and y."""
    rows, columns = box
    return rows.stop - rows.start, columns.stop - columns.start


def bounding_box(mask: NDArray[np.bool_], within: Box | None = None) -> Box | None:
    """Smallest box with every true node of `mask`, which covers the box `within`; None if none."""
    rows = np.flatnonzero(mask.any(axis=1))
    if rows.size == 0:
        return None
    top, bottom = int(rows[0]), int(rows[-1]) + 1
    columns = np.flatnonzero(mask[top:bottom].any(axis=0))
    i, j = (0, 0) if within is None else (within[0].start, within[1].start)
    return slice(i + top, i + bottom), slice(j + int(columns[0]), j + int(columns[-1]) + 1)


def widen(box: Box, cells: int, nodes: tuple[int, int]) -> Box:
    """Enlarge the box by `cells` cells on each side, within a grid of `nodes` (nx, ny) nodes."""
    rows, columns = (
        slice(max(part.start - cells, 0), min(part.stop + cells, n))
        for part, n in zip(box, nodes, strict=True)
    )
    return rows, columns


def union(first: Box | None, second: Box | None) -> Box | None:
    """Smallest box that contains both boxes; None stands for an empty box."""
    if first is None or second is None:
        return second if first is None else first
    rows, columns = (
        slice(min(a.start, b.start), max(a.stop, b.stop))
        for a, b in zip(first, second, strict=True)
    )
    return rows, columns


def intersection(first: Box, second: Box) -> Box:
    """The part that two boxes share, which may be empty."""
    rows, columns = (
        slice(start := max(a.start, b.start), max(min(a.stop, b.stop), start))
        for a, b in zip(first, second, strict=True)
    )
    return rows, columns


def reframe(values: NDArray[Scalar], box: Box, target: Box) -> NDArray[Scalar]:
    """`values` on `box` as an array on `target`, zero elsewhere; not copied for equal boxes."""
    if box == target:
        return values
    framed: NDArray[Any] = np.zeros(shape_of(target), dtype=values.dtype)
    shared = [
        (max(have.start, want.start), min(have.stop, want.stop))
        for have, want in zip(box, target, strict=True)
    ]
    if all(start < stop for start, stop in shared):
        framed[_within(target, shared)] = values[_within(box, shared)]
    return framed


def _within(box: Box, ranges: list[tuple[int, int]]) -> tuple[slice, ...]:
    pairs = zip(box, ranges, strict=True)
    return tuple(slice(start - part.start, stop - part.start) for part, (start, stop) in pairs)
