import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from restitution.errors import CaseError
from restitution.numerics.grid import Grid
from tolerance import approx

counts = st.integers(1, 50)


def test_axes_follow_the_indices():
    grid = Grid((4, 3), (2.0, 0.5))
    assert_array_equal(grid.x, [-4, -2, 0, 2])
    assert_array_equal(grid.y, [-0.5, 0, 0.5])
    assert grid.cell_area == 1.0
    assert grid.size == (8.0, 1.5)


@given(counts, counts, st.floats(1e-9, 1e3))
def test_the_origin_is_a_node_and_the_spacing_is_uniform(nx, ny, h):
    grid = Grid((nx, ny), (h, 3 * h))
    assert grid.x.shape == (nx,)
    assert grid.y.shape == (ny,)
    assert grid.x[nx // 2] == 0
    assert grid.y[ny // 2] == 0
    assert_allclose(np.diff(grid.x), h, rtol=1e-12)
    assert_allclose(np.diff(grid.y), 3 * h, rtol=1e-12)
    assert grid.cell_area * nx * ny == approx(math.prod(grid.size), rel=1e-12)


@given(counts, counts)
def test_grids_of_one_spacing_coincide(n, m):
    """The nodes of the smaller grid are nodes of the larger one."""
    small, large = sorted((n, m))
    x, larger = Grid((small, 1), (0.3, 1.0)).x, Grid((large, 1), (0.3, 1.0)).x
    assert set(x) <= set(larger)


@pytest.mark.parametrize("nodes", [(0, 4), (4, 0), (-1, 4)])
def test_a_grid_without_nodes_is_refused(nodes):
    with pytest.raises(CaseError, match=r"^nodes: .*at least 1 x 1"):
        Grid(nodes, (1.0, 1.0))


@pytest.mark.parametrize("h", [0.0, -1.0, math.nan, math.inf])
def test_a_spacing_that_is_no_length_is_refused(h):
    for spacing in ((h, 1.0), (1.0, h)):
        with pytest.raises(CaseError, match=r"^spacing: .*positive length"):
            Grid((4, 4), spacing)


def test_a_grid_does_not_change():
    with pytest.raises(AttributeError):
        Grid((4, 4), (1.0, 1.0)).nodes = (5, 5)


def test_one_number_is_for_both_axes():
    assert Grid(64, 1e-6) == Grid((64, 64), (1e-6, 1e-6))
    assert Grid((64, 32), 1e-6).spacing == (1e-6, 1e-6)
    assert Grid(np.int64(8), np.float32(0.5)) == Grid(np.array([8, 8]), [0.5, 0.5])
    assert hash(Grid([8, 8], [0.5, 0.5])) == hash(Grid(8, 0.5))


def test_whole_numbers_may_be_floats():
    nodes = Grid((64.0, np.float64(32)), 1e-6).nodes
    assert nodes == (64, 32)
    assert {type(n) for n in nodes} == {int}


@pytest.mark.parametrize("nodes", ["64", None, (64,), (64, 64, 64), (64, "64"), True, 64.5])
def test_nodes_that_are_none_are_refused_by_name(nodes):
    with pytest.raises(CaseError, match=r"^nodes: "):
        Grid(nodes, 1e-6)


@pytest.mark.parametrize("spacing", ["1 um", None, (1e-6,), (1e-6, None), math.nan, 0.0])
def test_spacings_that_are_none_are_refused_by_name(spacing):
    with pytest.raises(CaseError, match=r"^spacing: "):
        Grid(64, spacing)
