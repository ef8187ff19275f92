"""The keys of plates and internal friction, and what the case makes of them."""

import math

import pytest

from restitution.case.case_file import parse_case
from restitution.case.hardness import strength
from restitution.errors import CaseError
from restitution.losses.half_space import HalfSpace
from restitution.losses.losses import Losses
from restitution.losses.plate import Plate
from restitution.losses.viscosity import Friction
from restitution.runs.losses import loss_information
from tolerance import approx

REST = """
[grid]
nodes = 32
spacing = "10 um"
[impact]
velocity = "1 m/s"
"""
BALL = 'first = { material = "steel", radius = "3 mm"%s }\n'
WALL = 'second = { material = "steel", radius = "flat"%s }\n'


def parsed(ball="", wall=""):
    return parse_case(BALL % ball + WALL % wall + REST)


def test_a_wall_has_waves_and_with_a_thickness_bending_waves():
    steel = 203e9, 0.3, 7830.0
    assert parsed().losses() == Losses(waves=HalfSpace(*steel))
    both = parsed(wall=', thickness = "3 mm"').losses()
    assert both == Losses(Plate(3e-3, *steel), HalfSpace(*steel))


def test_two_spheres_lose_nothing():
    assert parse_case(BALL % "" + REST).losses() == Losses()


def test_a_wall_without_density_has_no_waves():
    bare = (
        'second = { radius = "flat", youngs_modulus = "70 GPa", poissons_ratio = 0.2, '
        'hardness = "5 GPa" }\n'
    )
    assert parse_case(BALL % "" + bare + REST).losses() == Losses()


def test_friction_has_the_share_of_each_body_in_the_compliance():
    soft = ', youngs_modulus = "67.66666666666667 GPa", loss_tangent = 0.1'
    case = parsed(', relaxation_time = "2 us"', soft)
    assert case.losses().viscosity.bodies == (
        (Friction(relaxation_time=approx(2e-6)), approx(0.25)),
        (Friction(loss_tangent=0.1), approx(0.75)),
    )


@pytest.mark.parametrize(
    ("ball", "wall", "message"),
    [
        (', thickness = "1 mm"', "", "first: thickness: belongs to a wall, but .* remove"),
        ("", ", loss_tangent = 1.2", "second.loss_tangent: .*1"),
        ("", ", loss_tangent = -0.1", "second.loss_tangent: .*0"),
        (
            ', loss_tangent = 0.1, relaxation_time = "1 us"',
            "",
            "first.*relaxation_time.* remove one",
        ),
        (', relaxation_time = "1 um"', "", '"1 um" is not a time; write for example "10 us"'),
        ("", ', thickness = "0 mm"', "second.thickness: .*greater than zero"),
        ("", ", thickness = 3", "second.thickness: .*no unit"),
    ],
)
def test_refused_values(ball, wall, message):
    with pytest.raises(CaseError, match=message):
        parsed(ball, wall)


def test_a_plate_needs_a_density():
    bare = 'second = { radius = "flat", youngs_modulus = "70 GPa", poissons_ratio = 0.2%s }\n'
    with pytest.raises(CaseError, match=r"second: density: is missing; .* thickness"):
        parse_case(BALL % "" + bare % ', thickness = "1 mm"' + REST)


def test_a_periodic_contact_has_no_losses():
    text = """
first = { material = "steel", radius = "flat", thickness = "1 mm" }
[interface]
yield_pressure = "elastic"
[roughness]
kind = "gaussian"
rms = "10 nm"
correlation_length = "100 um"
seed = 1
[grid]
nodes = 32
spacing = "10 um"
periodic = true
[indentation]
values = ["10 nm"]
"""
    with pytest.raises(CaseError, match=r"first\.thickness: acts in impacts only"):
        parse_case(text)
    case = parse_case(text.replace(', thickness = "1 mm"', ""))
    assert case.losses() == Losses()
    assert loss_information(case) == ""


def hard(rule, more=', hardness = "7 GPa"'):
    return parsed(wall=f', yield_strength = "{rule}"{more}').second


def test_a_strength_from_the_hardness():
    wall = hard("H/2.8")
    assert wall.yield_strength == approx(2.5e9)
    known = wall.from_library()["yield_strength"]
    assert (known.low, known.high) == (approx(7e9 / 3), approx(7e9 / 2.2))
    assert hard(" H / 2.5 ", "").yield_strength == approx(7.9e9 / 2.5)  # of the library


def test_the_spread_includes_that_of_a_hardness_of_the_library():
    known = hard("H/3", "").from_library()
    H, Y = known["hardness"], known["yield_strength"]
    assert H.low < H.value < H.high
    assert Y.low == approx(H.low / 3)
    more = math.hypot(H.value / 2.2 - H.value / 3, (H.high - H.value) / 3)
    assert Y.high == approx(H.value / 3 + more)


def test_the_spread_includes_the_given_ratio():
    assert strength(7e9, 4.0).low == approx(1.75e9)
    assert strength(7e9, 2.0).high == approx(3.5e9)


def test_the_case_says_which_conversion_is_used():
    case = parsed(wall=', yield_strength = "H/2.8", hardness = "5.6 GPa"')
    assert case.yielding().source == "Y of second (steel), 2000 MPa (H/2.8)"
    assert case.yielding().yield_strength == approx(2e9)
    assert parsed().yielding().source.endswith("(H/2.4, from rebound tests)")


@pytest.mark.parametrize(
    ("rule", "more", "message"),
    [
        ("H/0.5", ', hardness = "7 GPa"', "second: yield_strength: .* not plausible"),
        ("H/2.8", ', hardness = "7 m"', "second: hardness: .*not a pressure"),
        ("H*2.8", ', hardness = "7 GPa"', "second.yield_strength: "),
    ],
)
def test_wrong_conversions(rule, more, message):
    with pytest.raises(CaseError, match=message):
        hard(rule, more)
    assert math.isfinite(parsed().yielding().hardness)


def test_a_conversion_needs_a_hardness():
    bare = (
        'second = { radius = "flat", youngs_modulus = "70 GPa", poissons_ratio = 0.2, '
        'yield_strength = "H/2.8" }\n'
    )
    with pytest.raises(CaseError, match="second: hardness: is missing; give it"):
        parse_case(BALL % "" + bare + REST)
