"""The asperity that each node belongs to: its elongation and the gap at its crest."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from restitution.contact.asperities import crest_gap_of, elongation_of
from tolerance import approx

NODES = st.tuples(st.integers(2, 9), st.integers(2, 9))


def gaps(shape, seed):
    """Distinct gaps in random order, so that each node has one lowest neighbour."""
    return np.random.default_rng(seed).permutation(shape[0] * shape[1]).reshape(shape) * 1e-9


def walked(gap, i, j):
    """Follow the steepest descent from a node, one step at a time."""
    while True:
        rows, columns = slice(max(i - 1, 0), i + 2), slice(max(j - 1, 0), j + 2)
        block = gap[rows, columns]
        di, dj = np.unravel_index(np.argmin(block), block.shape)
        lower = rows.start + di, columns.start + dj
        if gap[lower] == gap[i, j]:
            return gap[i, j]
        i, j = lower


@given(NODES, st.integers(0, 1000))
def test_each_path_ends_at_the_crest_that_single_steps_reach(shape, seed):
    gap = gaps(shape, seed)
    assert (crest_gap_of(gap) == [[walked(gap, *at) for at in row] for row in indices(gap)]).all()


def indices(gap):
    return [[(i, j) for j in range(gap.shape[1])] for i in range(gap.shape[0])]


@given(NODES, st.integers(0, 1000))
def test_the_crests_turn_with_the_surface_and_scale_with_the_heights(shape, seed):
    gap = gaps(shape, seed)
    crests = crest_gap_of(gap)
    assert (crest_gap_of(gap[::-1]) == crests[::-1]).all()
    assert (crest_gap_of(gap.T) == crests.T).all()
    assert (crest_gap_of(4 * gap) == 4 * crests).all()


def test_a_plane_and_a_bowl_have_one_crest():
    assert not crest_gap_of(np.zeros((5, 6))).any()
    x = np.linspace(-1, 1, 41)
    assert not crest_gap_of(np.add.outer(x**2, x**2)).any()


def test_waves_have_a_crest_in_each_period():
    x = np.arange(96) / 24
    gap = np.add.outer(0.3 * x**2 + 1 - np.cos(2 * np.pi * x), np.zeros(5))
    n = np.round(x)  # the nearest crest; each slope of the parabola shifts it by less than a cell
    inner = np.abs(x - n) < 0.4
    assert crest_gap_of(gap)[inner, 2] == approx(0.3 * n[inner] ** 2, rel=0.03, abs=1e-12)


@pytest.mark.parametrize(("smaller", "larger"), [(0.0, 2.0), (0.5, 2.0), (1.0, 1.0), (-1.0, 2.0)])
def test_the_elongation_follows_the_curvatures_in_every_direction(smaller, larger):
    h = 1e-7
    x = h * np.arange(-4, 5)
    for angle in (0.0, 0.4, np.pi / 2):
        along = np.add.outer(np.cos(angle) * x, np.sin(angle) * x)
        across = np.add.outer(-np.sin(angle) * x, np.cos(angle) * x)
        found = elongation_of(0.5 * (smaller * along**2 + larger * across**2), (h, h))
        expected = (1 - abs(smaller) / larger) ** 2
        assert found[1:-1, 1:-1] == approx(np.full((7, 7), expected), rel=1e-6, abs=1e-6)
        assert not found[0].any()
        assert not found[:, -1].any()
