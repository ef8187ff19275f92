"""A potential for each node, by a row of a table; node_tables.h has the compiled loop."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@use_loop
def tabulated_potential(
    gap: Array, row: Index, nodes: Array, cells: Array, ends: Array, out: Array
) -> None:
    """Write energy (J/m²), traction (Pa) and its derivative (Pa/m) of all nodes into `out`.

    Args:
        gap: Gap (m) of each node, shape (nx, ny).
        row: The row of each node in `cells` and `ends`, of this shape.
        nodes: Three such arrays (m), one below the other: the gap at the first point of the row,
            below which the pressure is linear; the distance between the points; and the gap from
            which the traction beyond the last point falls with the third power.
        cells: Coefficients (Pa) of 1, t, t² and t³ of the pressure in each cell, t from 0 to 1, and
            its integral up to the cell in distances of points; shape (rows × cells, 5).
        ends: Slope (Pa) at the first point, last pressure (Pa), whole integral; shape (rows, 3).
        out: Shape of `nodes`.
    """
    count = len(cells) // len(ends)
    first, step, middle = np.split(nodes, 3)
    last, (_, tail, whole) = first + count * step, np.moveaxis(ends[row], -1, 0)
    at = np.minimum((gap - first) / step, float(count))
    cell = np.clip(at.astype(np.intp), 0, count - 1)
    t = np.maximum(at, 0.0) - cell
    of = cells[row * count + cell]
    a, b, c, d, before = (of[..., k] for k in range(5))
    p, slope = a + t * (b + t * (c + t * d)), b + t * (2 * c + 3 * t * d)
    integral = before + t * (a + t * (b / 2 + t * (c / 3 + t * d / 4)))
    beyond = np.minimum(at, 0.0)
    integral += beyond * (p + 0.5 * slope * beyond)
    p += slope * beyond
    reach, far = last - middle, gap > last
    ratio = np.where(far, reach / np.maximum(gap - middle, reach), 1.0)
    energy, traction, stiffness = np.split(out, 3)
    rest = 0.5 * tail * reach
    energy[...] = np.where(far, rest * ratio**2, (whole - integral) * step + rest)
    traction[...] = -np.where(far, tail * ratio**3, p)
    stiffness[...] = np.where(far, 3 * tail * ratio**4 / reach, -slope / step)
