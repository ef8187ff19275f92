"""Shape and height of the asperity that each node belongs to, from the gap before loading."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.read_only import freeze
from restitution.numerics.relief import lowest_downhill, ridge_shape

Array = NDArray[np.float64]


def elongation_of(gap: Array, spacing: tuple[float, float]) -> Array:
    """Elongation of the asperity at each node, (1 − κ₂/κ₁)².

    κ₂ and κ₁ are the magnitudes of the two principal curvatures of the gap, from second
    differences; κ₁ is the larger one.

    Args:
        gap: Gap before loading (m), shape (nx, ny).
        spacing: Distances between neighbouring nodes along x and y (m).

    Returns:
        Elongation (dimensionless), shape of `gap`, read-only: 0 at a round asperity, 1 along a
        ridge. It is 0 at the outermost nodes of the grid, which a contact must not reach.
    """
    elongation = np.empty(gap.shape)
    hx, hy = spacing
    ridge_shape(gap, float(hx), float(hy), elongation)
    return freeze(elongation)


def crest_gap_of(gap: Array) -> Array:
    """Gap at the crest that a path of steepest descent over the eight neighbours comes to.

    Args:
        gap: Gap before loading (m), shape (nx, ny).

    Returns:
        Gap at the crests (m), shape of `gap`, read-only.
    """
    crest_gap = np.empty(gap.shape)
    lowest_downhill(gap, crest_gap)
    return freeze(crest_gap)
