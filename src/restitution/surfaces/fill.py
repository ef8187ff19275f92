"""Fill pixels that an instrument could not measure."""

from __future__ import annotations

import numpy as np

from restitution.surfaces.surface import Array


def fill_harmonically(height: Array, spacing: tuple[float, float]) -> Array:
    """Fill NaN pixels with the solution of Laplace's equation between the defined pixels.

    `height` has shape (nx, ny) and at least one defined pixel; `spacing` is (hx, hy) in m. The
    heights in each hole stay between the lowest and the highest height on its rim, so filling adds
    no summit that could make contact. The normal slope at the edge of the scan is zero.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    unknown = ~np.isfinite(height)
    count = int(np.count_nonzero(unknown))
    if count == 0:
        return height
    number = np.full(height.shape, -1)
    number[unknown] = np.arange(count)

    # The matrix is the five-point Laplacian, with one row for each unknown pixel:
    # Σ weight (z_here − z_neighbour) = 0.
    diagonal, right_side = np.zeros(count), np.zeros(count)
    rows, columns, values = [np.arange(count)], [np.arange(count)], [diagonal]
    for axis, h in enumerate(spacing):
        # The weights are proportional to 1/h²; a common factor has no effect.
        weight = (max(spacing) / h) ** 2
        for step in (1, -1):
            here, there = _neighbours(axis, step)
            pairs = unknown[here]
            me, other = number[here][pairs], number[there][pairs]
            diagonal[me] += weight
            inside = other >= 0
            rows.append(me[inside])
            columns.append(other[inside])
            values.append(np.full(np.count_nonzero(inside), -weight))
            right_side[me[~inside]] += weight * height[there][pairs][~inside]
    laplacian = coo_array(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
        shape=(count, count),
    )
    filled = height.copy()
    # This ordering of the unknowns exploits the symmetry of the matrix.
    filled[unknown] = spsolve(laplacian.tocsc(), right_side, permc_spec="MMD_AT_PLUS_A")
    return filled


def _neighbours(axis: int, step: int) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Slices of the pixels with a neighbour at `step` along `axis`, and of these neighbours."""
    low, high = slice(None, -1), slice(1, None)
    here, there = [slice(None), slice(None)], [slice(None), slice(None)]
    here[axis], there[axis] = (low, high) if step > 0 else (high, low)
    return (here[0], here[1]), (there[0], there[1])
