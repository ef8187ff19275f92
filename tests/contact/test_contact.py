import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from restitution.contact.contact import Contact, smooth
from restitution.contact.plasticity.bound import ConstantBound
from restitution.errors import CaseError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface
from tolerance import approx


def test_what_is_no_pair_or_no_surface_is_refused_by_name(pair):
    flat = smooth(Grid(8, 1e-6))
    call = r"call Contact\(pair, surface\), with "
    with pytest.raises(
        CaseError, match=rf"^pair: a Body is not a Pair; {call}Pair\(first, second\)"
    ):
        Contact(pair.first, flat)
    with pytest.raises(
        CaseError, match=rf"^surface: an array of shape .* is not a Surface; {call}Surface\("
    ):
        Contact(pair, np.zeros((8, 8)))


def test_the_smooth_gap_is_the_paraboloid_and_the_apex_a_node(pair):
    for nodes in ((8, 5), (7, 6), (1, 1), (1, 4)):
        gap = Contact(pair, smooth(Grid(nodes, (1e-6, 2e-6)))).gap
        assert gap[nodes[0] // 2, nodes[1] // 2] == 0  # exactly
        for i, j in np.ndindex(nodes):
            x, y = (i - nodes[0] // 2) * 1e-6, (j - nodes[1] // 2) * 2e-6
            assert gap[i, j] == approx((x * x + y * y) / 500e-6, rel=1e-14)


def test_heights_close_the_gap_and_the_highest_asperity_touches_first(pair):
    grid = Grid((9, 7), (1e-6, 2e-6))
    bare = Contact(pair, smooth(grid)).gap
    z = np.zeros(grid.nodes)
    z[2, 1] = 3 * bare.max()
    gap = Contact(pair, Surface(z, grid)).gap
    assert np.unravel_index(gap.argmin(), gap.shape) == (2, 1)
    assert_allclose(gap, bare - z + 3 * bare.max() - bare[2, 1], atol=1e-15 * bare.max())


@settings(deadline=None, max_examples=30)
@given(
    st.tuples(st.integers(1, 12), st.integers(1, 12)),
    st.floats(1e-12, 1e-5),
    st.floats(-1e-3, 1e-3),
    st.integers(0, 1000),
)
def test_the_least_gap_is_zero_whatever_the_surface(pair, nodes, rms, shift, seed):
    """Adding a constant to all heights does not change the gap either."""
    grid = Grid(nodes, (1e-6, 3e-7))
    z = rms * np.random.default_rng(seed).normal(size=nodes)
    gap = Contact(pair, Surface(z, grid)).gap
    assert gap.min() == 0
    lifted = Contact(pair, Surface(z + shift, grid)).gap
    assert_allclose(lifted, gap, atol=1e-15 * (abs(shift) + rms) * 4 + 1e-22)


def test_the_surface_is_left_alone(pair):
    grid = Grid((5, 5), (1e-6, 1e-6))
    z = np.random.default_rng(0).normal(size=(5, 5))
    kept = z.copy()
    contact = Contact(pair, Surface(z, grid))
    assert contact.gap is contact.gap  # computed once
    assert_array_equal(z, kept)
    assert contact.grid is grid


def test_smooth_says_so(pair):
    surface = smooth(Grid((3, 4), (1e-6, 1e-6)))
    assert surface.provenance["kind"] == "smooth"
    assert_array_equal(surface.height, np.zeros((3, 4)))
    assert Contact(pair, surface).hardness == math.inf


@pytest.mark.parametrize("p_y", [0.0, -1.0, math.nan, -math.inf])
def test_a_yield_pressure_that_is_not_positive_is_refused(pair, p_y):
    with pytest.raises(CaseError, match=r"^yield_pressure: .*not positive"):
        Contact(
            pair,
            smooth(Grid((3, 3), (1e-6, 1e-6))),
            plasticity=ConstantBound(p_y),
        )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"plasticity": "perfect"}, r'plasticity: "perfect" is no model; use Elastic\(\), '),
        ({"plasticity": 1e9}, r"use Elastic\(\), ConstantBound\(yield_pressure\), "),
        ({"adhesion": "jkr"}, r'adhesion: "jkr" is no model; use JKRLimit\(work_of_adhesion\), '),
        ({"yield_pressure": 1e9}, r"plasticity=ConstantBound\(yield_pressure\)"),
        ({"yield_strength": 1e9}, r"plasticity=ExpandingCavity\(yield_strength\)"),
        ({"work_of_adhesion": 0.05}, r"adhesion=JKRLimit\(work_of_adhesion\)"),
        ({"detachment": "pohrt-popov"}, r"adhesion=JKRLimit\(.*detachment=…\)"),
    ],
)
def test_what_is_not_a_model_names_the_form_to_write(pair, options, words):
    with pytest.raises(CaseError, match=words) as refusal:
        Contact(pair, smooth(Grid((3, 3), (1e-6, 1e-6))), **options)
    assert "\n" not in str(refusal.value)
