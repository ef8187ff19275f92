"""Boxes of the grid and arrays on them."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from restitution.numerics.box import NOWHERE, bounding_box, reframe, shape_of, union, widen


@st.composite
def boxes(draw, n=12):
    """Boxes with at least one node inside a grid of n x n."""
    edges = [
        sorted(draw(st.lists(st.integers(0, n), min_size=2, max_size=2, unique=True))) for _ in "xy"
    ]
    return tuple(slice(*edge) for edge in edges)


def members(box, n=12):
    mask = np.zeros((n, n), dtype=bool)
    mask[box] = True
    return mask


@settings(deadline=None, max_examples=60)
@given(st.integers(1, 9), st.integers(1, 9), st.floats(0, 0.3), st.integers(0, 1000))
def test_the_box_is_the_smallest_that_holds_all(nx, ny, density, seed):
    mask = np.random.default_rng(seed).random((nx, ny)) < density
    box = bounding_box(mask)
    if not mask.any():
        assert box is None
        return
    i, j = np.nonzero(mask)
    assert box == (slice(i.min(), i.max() + 1), slice(j.min(), j.max() + 1))
    assert shape_of(box) == mask[box].shape


@settings(deadline=None)
@given(boxes(), st.integers(0, 1000))
def test_a_box_is_found_in_the_indices_of_the_grid(box, seed):
    mask = np.random.default_rng(seed).random((12, 12)) < 0.1
    assert bounding_box(mask[box], box) == bounding_box(mask & members(box))


@settings(deadline=None)
@given(boxes(), boxes())
def test_the_union_holds_both_and_nothing_holds_nothing(first, second):
    both = union(first, second)
    assert both == bounding_box(members(first) | members(second))
    assert union(first, None) == first
    assert union(None, second) == second
    assert union(None, None) is None


@settings(deadline=None)
@given(boxes(), st.integers(0, 4))
def test_a_wider_box_stays_on_the_grid(box, cells):
    wider = widen(box, cells, (12, 12))
    for part, grown in zip(box, wider, strict=True):
        assert grown == slice(max(part.start - cells, 0), min(part.stop + cells, 12))


@settings(deadline=None)
@given(boxes(), boxes(), st.integers(0, 1000))
def test_what_is_known_on_one_box_is_cut_for_another(box, wanted, seed):
    values = np.random.default_rng(seed).normal(size=(12, 12))
    expected = np.where(members(box), values, 0.0)[wanted]
    assert np.array_equal(reframe(values[box], box, wanted), expected)
    nothing = reframe(values[NOWHERE], NOWHERE, wanted)
    assert nothing.shape == shape_of(wanted)
    assert not nothing.any()


def test_nowhere_is_a_box_without_nodes():
    assert shape_of(NOWHERE) == np.ones((3, 4))[NOWHERE].shape == (0, 0)
    assert shape_of(union(NOWHERE, NOWHERE)) == (0, 0)
