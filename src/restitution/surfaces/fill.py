"""Fill pixels that an instrument could not measure."""

from __future__ import annotations

import numpy as np

from restitution.surfaces.surface import Array


def fill_harmonically(height: Array, spacing: tuple[float, float]) -> Array:
    """Fill NaN pixels with heights that satisfy Laplace's equation in each hole.

    `height` has shape (nx, ny) and at least one defined pixel; `spacing` is (hx, hy) in m. The
    defined pixels around a hole are the boundary values. All heights in a hole stay between the
    lowest and the highest height on its rim, so filling adds no summit that could make contact. At
    the edge of the scan, the slope normal to the edge is zero.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    unknown = ~np.isfinite(height)
    count = int(np.count_nonzero(unknown))
    if count == 0:
        return height
    number = np.full(height.shape, -1)
    number[unknown] = np.arange(count)
    at = np.nonzero(unknown)

    # The matrix is the five-point Laplacian, with one row for each unknown pixel:
    # Σ weight (z_here − z_neighbour) = 0.
    diagonal, right_side = np.zeros(count), np.zeros(count)
    rows, columns, values = [np.arange(count)], [np.arange(count)], [diagonal]
    for axis, h in enumerate(spacing):
        # The weights are proportional to 1/h²; a common factor has no effect.
        weight = (max(spacing) / h) ** 2
        for step in (1, -1):
            along = at[axis] + step
            me = np.flatnonzero((along >= 0) & (along < height.shape[axis]))
            there = tuple((along if k == axis else at[k])[me] for k in range(2))
            other = number[there]
            diagonal[me] += weight
            inside = other >= 0
            rows.append(me[inside])
            columns.append(other[inside])
            values.append(np.full(np.count_nonzero(inside), -weight))
            right_side[me[~inside]] += weight * height[there][~inside]
    laplacian = coo_array(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
        shape=(count, count),
    )
    filled = height.copy()
    # This ordering of the unknowns exploits the symmetry of the matrix.
    filled[unknown] = spsolve(laplacian.tocsc(), right_side, permc_spec="MMD_AT_PLUS_A")
    return filled
