import numpy as np
import pytest

from restitution.numerics.grid import Grid
from restitution.surfaces.clean import fill_harmonically

GRID = Grid((40, 30), (1e-7, 2e-7))
X, Y = np.meshgrid(GRID.x, GRID.y, indexing="ij")


def with_hole(height):
    holed = height.copy()
    holed[10:22, 8:15] = np.nan
    holed[30, 20] = np.nan
    return holed


@pytest.mark.parametrize("form", [0.1 * X - 0.3 * Y + 1e-6, 1e5 * (X**2 - Y**2), 1e5 * X * Y])
def test_harmonic_surfaces_come_back(form):
    """Unequal spacings are included, where wrong weights would show."""
    np.testing.assert_allclose(fill_harmonically(with_hole(form), GRID.spacing), form, atol=1e-18)


def test_fill_stays_within_the_rim_and_leaves_the_rest():
    height = np.random.default_rng(3).normal(size=GRID.nodes)
    holed = with_hole(height)
    filled = fill_harmonically(holed, GRID.spacing)
    known = np.isfinite(holed)
    np.testing.assert_array_equal(filled[known], height[known])
    rim = height[9:23, 7:16]
    hole = filled[10:22, 8:15]
    assert rim.min() < hole.min() < hole.max() < rim.max()
    assert np.isnan(holed[15, 10]), "the argument is not changed"


def test_slope_is_zero_across_the_edges():
    """The heights are an eigenfunction of the five-point Laplacian with zero slope at the edges."""
    nx, ny = GRID.nodes
    ratio = (GRID.spacing[0] / GRID.spacing[1]) ** 2
    theta = 3 * np.pi / ny
    kappa = np.arccosh(1 + ratio * (1 - np.cos(theta)))
    i, j = np.arange(nx)[:, None] + 0.5, np.arange(ny)[None, :] + 0.5
    height = np.cosh(kappa * i) * np.cos(theta * j)
    holed = height.copy()
    holed[:6] = np.nan
    np.testing.assert_allclose(fill_harmonically(holed, GRID.spacing), height, rtol=1e-10)
