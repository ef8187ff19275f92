import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from restitution.contact.bodies import Body, Pair
from restitution.errors import CaseError
from tolerance import approx

STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850.0)
bodies = st.builds(
    Body,
    radius=st.floats(1e-9, 1e3),
    youngs_modulus=st.floats(1e3, 1e13),
    poissons_ratio=st.floats(-0.999, 0.5),
    density=st.floats(1.0, 1e5),
)


def test_the_seed_pair():
    pair = Pair(STEEL, STEEL)
    assert pair.radius == approx(250e-6, rel=1e-14)
    assert pair.contact_modulus == approx(112e9, rel=1e-14)  # 210/(2·15/16)
    assert pair.mass == approx(2 / 3 * math.pi * 500e-6**3 * 7850, rel=1e-14)


def test_unlike_bodies_worked_out_by_hand():
    # E* = 1/[(1 − ¼)/3 + (1 − 1/9)/8] = 1/(1/4 + 1/9) = 36/13;  R* = 1/(1/2 + 1/3) = 6/5
    pair = Pair(Body(2.0, 3.0, 0.5), Body(3.0, 8.0, 1 / 3))
    assert pair.contact_modulus == approx(36 / 13, rel=1e-14)
    assert pair.radius == approx(1.2, rel=1e-14)


def test_a_wall_lends_its_stiffness_only():
    wall = Body(math.inf, 70e9, 0.3)
    for pair in (Pair(STEEL, wall), Pair(wall, STEEL)):
        assert pair.radius == STEEL.radius
        assert pair.mass == approx(STEEL.mass, rel=1e-14)
        assert pair.contact_modulus == approx(1 / (0.9375 / 210e9 + 0.91 / 70e9), rel=1e-14)
    assert wall.mass == math.inf
    assert Body(math.inf, 70e9, 0.3, density=2700.0).mass == math.inf


def test_without_a_density_there_is_no_mass():
    light = Body(1e-3, 1e9, 0.3)
    assert light.mass is None
    assert Pair(light, STEEL).mass is None
    assert Pair(STEEL, light).mass is None
    assert Pair(light, Body(math.inf, 1e9, 0.3)).mass is None


def test_two_walls_have_no_radius_and_no_finite_mass():
    wall = Body(math.inf, 70e9, 0.3)
    pair = Pair(wall, wall)
    assert pair.flat
    assert pair.radius == pair.mass == math.inf
    assert pair.contact_modulus == approx(70e9 / (2 * 0.91), rel=1e-14)
    assert repr(pair).startswith("Pair: flat bodies, E*")
    assert not Pair(STEEL, wall).flat


@given(bodies, bodies)
def test_the_order_of_the_bodies_does_not_matter_and_the_softer_part_rules(a, b):
    there, back = Pair(a, b), Pair(b, a)
    for name, parts in (
        ("radius", (a.radius, b.radius)),
        ("mass", (a.mass, b.mass)),
        (
            "contact_modulus",
            [body.youngs_modulus / (1 - body.poissons_ratio**2) for body in (a, b)],
        ),
    ):
        value = getattr(there, name)
        assert value == approx(getattr(back, name), rel=1e-14)
        assert 0.4999999 * min(parts) <= value <= min(parts) * (1 + 1e-14)


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("radius", [0.0, -1.0, math.nan, -math.inf]),
        ("youngs_modulus", [0.0, -1.0, math.nan, math.inf]),
        ("poissons_ratio", [-1.0, 0.5000001, math.nan, 3.0]),
        ("density", [0.0, -1.0, math.nan, math.inf]),
    ],
)
def test_what_is_no_body_is_refused_by_name(key, values):
    sound = {"radius": 1e-3, "youngs_modulus": 1e9, "poissons_ratio": 0.3, "density": 1e3}
    Body(**sound)
    for value in values:
        with pytest.raises(CaseError, match=f"^{key}: "):
            Body(**sound | {key: value})
