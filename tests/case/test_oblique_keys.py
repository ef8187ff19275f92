"""`[interface] friction`, `[impact] angle` and `[impact] spin`: values, units and refusals."""

import math

import pytest

from restitution.case.case_file import parse_case
from restitution.case.quantities import read_quantity
from restitution.errors import CaseError
from tolerance import approx

CASE = """
first = {{ material = "steel", radius = "500 um" }}
second = {second}
[interface]
{interface}
[grid]
nodes = 64
spacing = "1 um"
[impact]
velocity = {velocity}
{impact}
"""

MANY = [f'"{k / 100} deg"' for k in range(5001)]


def case(impact, *, interface="friction = 0.2", second='"steel"', velocity='["1 m/s", "0.5 m/s"]'):
    return parse_case(
        CASE.format(impact=impact, interface=interface, second=second, velocity=velocity)
    )


def test_one_angle_or_many_in_degrees_or_radians():
    assert case('angle = "30 deg"').impact.angles() == approx([math.pi / 6])
    many = case('angle = ["0.5 rad", "10 deg", "0.5 rad"]').impact
    assert many.angles() == approx([math.pi / 18, 0.5])
    assert many.spins() == (0.0, 0.0)


@pytest.mark.parametrize(
    ("text", "spins"),
    [
        ('"100 rad/s"', (100.0, 0.0)),
        ('["-60 rpm", "180 deg/s"]', (-2 * math.pi, math.pi)),
        ('["1 turn/s"]', (2 * math.pi, 0.0)),
    ],
)
def test_one_spin_or_two_in_several_units(text, spins):
    second = '{ material = "steel", radius = "1 mm" }'
    impact = case(f"spin = {text}", second=second).impact
    assert impact.spins() == approx(spins)
    assert impact.angles() == [0.0]


def test_the_depths_are_the_normal_velocities_of_all_impacts_and_those_head_on():
    depths = case('angle = ["60 deg", "45 deg"]').depths()
    # 1 m/s at 60 degrees meets like 0.5 m/s head-on
    assert depths == approx([0.25, math.sqrt(0.125), 0.5, math.sqrt(0.5), 1.0])
    assert 0.5 in depths
    assert 1.0 in depths


def test_without_angle_and_spin_nothing_changes():
    without = case("")
    assert without.depths() == [0.5, 1.0]
    assert not without.impact.oblique
    assert without.impact.angles() == []
    assert without.interface.friction == 0.2


@pytest.mark.parametrize(
    ("impact", "changed", "words"),
    [
        ('angle = "30 deg"', {"interface": ""}, "interface.friction: is missing; give it, because"),
        ('spin = "1 rad/s"', {"interface": ""}, "because impact.spin needs a coefficient"),
        (
            'angle = "90 deg"',
            {},
            'impact.angle: "90 deg" is not an angle of impact; give an angle',
        ),
        ('angle = "95 deg"', {}, "from the normal of at least 0 and less than 90 degrees"),
        ('angle = "-1 deg"', {}, "from the normal of at least 0 and less than 90 degrees"),
        ('angle = "30 m"', {}, 'impact.angle: "30 m" is not an angle; write for example'),
        ("angle = 30", {}, 'impact.angle: 30 has no unit; write for example "30 deg"'),
        ("angle = []", {}, "impact.angle: .* should be a list with at least one value"),
        ('spin = "100 Hz"', {}, "is not a spin, because its unit has no angle; write for"),
        ('spin = "100 m/s"', {}, 'impact.spin: "100 m/s" is not a spin; write for example'),
        ("spin = 5", {}, 'impact.spin: 5 has no unit; write for example "100 rad/s"'),
        ('spin = ["1 rpm", "1 rpm", "1 rpm"]', {}, "3 values for two bodies"),
        ('spin = ["1 rpm", "1 rpm"]', {}, "impact.spin: second is a wall and does not turn"),
        ('angle = "1 deg"', {"interface": "friction = -0.1"}, "interface.friction: -0.1 should be"),
        ('angle = "1 deg"', {"interface": "friction = 20"}, "interface.friction: 20 should be"),
        ('angle = "1 deg"', {"interface": 'friction = "x"'}, "friction: .* should be a number"),
        (
            'angle = "1 deg"',
            {"interface": 'friction = 0.1\nwork_of_adhesion = "0.1 J/m^2"'},
            "impact.angle: oblique impacts are computed only for pairs without adhesion",
        ),
        (
            f"angle = [{', '.join(MANY)}]",
            {},
            "10002 impacts .velocities times angles. are more than 10000",
        ),
    ],
)
def test_wrong_keys_are_refused_in_one_line(impact, changed, words):
    with pytest.raises(CaseError, match=words) as refused:
        case(impact, **changed)
    assert "\n" not in str(refused.value)


def test_friction_alone_goes_with_adhesion():
    assert case("", interface='friction = 0.1\nwork_of_adhesion = "0.1 J/m^2"').impact is not None


def test_turns_and_degrees_are_spins_and_hertz_is_not():
    assert read_quantity("2 rpm", "rad/s") == approx(math.pi / 15)
    for text in ("1 Hz", "1 kHz", "1 s^-1"):
        with pytest.raises(ValueError, match="is not a spin"):
            read_quantity(text, "rad/s")
