"""The total error of a point."""

import math
from dataclasses import replace

import pytest

from points import point
from restitution.curve.curve import largest_part
from tolerance import approx

PARTS = {
    "restitution_error": 0.01,
    "discretisation_error": 0.02,
    "surface_scatter": 0.04,
    "material_error": 0.05,
}


def test_it_is_the_root_of_the_sum_of_the_squares_of_its_four_parts():
    one = point(restitution=0.6, **PARTS)
    assert one.combined_error == approx(math.sqrt(0.01**2 + 0.02**2 + 0.04**2 + 0.05**2))
    assert replace(one, model_error=0.3).combined_error == one.combined_error


@pytest.mark.parametrize("name", PARTS)
def test_a_part_that_is_not_known_is_left_out(name):
    rest = {key: value for key, value in PARTS.items() if key != name}
    expected = math.hypot(*rest.values())
    one = point(restitution=0.6, **{**PARTS, name: math.nan})
    assert one.combined_error == approx(expected)


@pytest.mark.parametrize(("e", "most"), [(0.8, 0.8), (0.3, 0.7), (0.5, 0.5)])
def test_it_is_at_most_the_distance_to_the_farther_end(e, most):
    assert point(restitution=e, restitution_error=0.9).combined_error == most
    assert point(restitution=e, restitution_error=0.2).combined_error == 0.2


@pytest.mark.parametrize("name", PARTS)
def test_the_largest_part_is_that_of_all_rows_with_a_total_error(name):
    many = {**dict.fromkeys(PARTS, 0.01), name: 0.012, "total_error": 0.02}
    other = "surface_scatter" if name != "surface_scatter" else "material_error"
    one = {**dict.fromkeys(PARTS, 0.01), other: 0.0121, "total_error": 0.02}
    unknown = {**dict.fromkeys(PARTS, math.nan), other: 0.9, "total_error": math.nan}
    many, one, unknown = (point(**values) for values in (many, one, unknown))
    assert largest_part([many, many, one, unknown]) == name
    assert largest_part([replace(one, **{name: math.nan}), one]) == other
