"""Materials by name, and the pressure at which they yield."""

import json
import math

import pytest

from restitution.errors import CaseError
from restitution.studies.case import parse_case
from restitution.studies.materials import material

REST = """
[grid]
nodes = 32
spacing = "0.5 um"
[indentation]
values = ["40 nm"]
[unloading]
curves = 0
"""
GLASS = 'first = { material = "glass", radius = "500 um" }\n'


def parsed(text):
    return parse_case(text + REST)


def test_a_material_gives_what_the_table_leaves_out():
    case = parsed('first = { material = "Glass", radius = "500 um", density = "2600 kg/m^3" }\n')
    body, glass = case.pair().first, material("glass")
    assert body.radius == 500e-6
    assert body.youngs_modulus == glass.youngs_modulus.value
    assert body.poissons_ratio == glass.poissons_ratio.value
    assert body.density == 2600
    assert set(case.first.from_library()) == {"youngs_modulus", "poissons_ratio", "hardness"}


def test_a_name_alone_is_a_wall():
    pair = parsed('second = "aluminum"\n' + GLASS).pair()
    assert math.isinf(pair.second.radius)
    assert pair.second.youngs_modulus == material("aluminium").youngs_modulus.value
    with pytest.raises(CaseError, match="both are flat"):
        parsed('first = "glass"\nsecond = "steel"\n').pair()
    with pytest.raises(CaseError, match=r'radius = "500 um"'):
        parsed('first = "glass"\n').pair()


@pytest.mark.parametrize("table", ['first = "gless"', 'first = { material = "gless" }'])
def test_a_material_that_is_not_known(table):
    with pytest.raises(CaseError, match=r'first: "gless" is not a material .* mean "glass"'):
        parsed(f"{table}\n")


def test_the_softer_body_yields():
    hardness = '[interface]\nyield_pressure = "hardness"\n'
    case = parsed(f'second = "aluminium"\n{GLASS}{hardness}')
    pressure, words = case.yields()
    assert pressure == material("aluminium").hardness.value
    assert words == "hardness of second (aluminium), 1050 MPa"
    assert parsed(GLASS + hardness).yields()[0] == material("glass").hardness.value


@pytest.mark.parametrize(("rule", "factor"), [("1.6 Y", 1.6), ("2.8Y", 2.8), ("3 * Y", 3.0)])
def test_so_many_yield_strengths(rule, factor):
    steel = 'first = { material = "steel", radius = "1 mm" }\nsecond = "304"\n'
    case = parsed(f'{steel}[interface]\nyield_pressure = "{rule}"\n')
    assert case.yielding().hardness == factor * material("304").yield_strength.value
    assert case.yielding().source.startswith(f"{factor:g} Y of second (stainless-steel)")


def test_a_body_without_a_yield_strength_yields_at_its_hardness():
    steel = 'first = { material = "glass", radius = "1 mm" }\nsecond = "polystyrene"\n'
    case = parsed(f'{steel}[interface]\nyield_pressure = "1.6 Y"\n')
    assert case.yields() == (
        1.6 * material("polystyrene").yield_strength.value,
        "1.6 Y of second (polystyrene), Y = 90 MPa",
    )
    soft = 'first = { material = "sodium-chloride", radius = "1 mm" }\nsecond = "steel"\n'
    case = parsed(f'{soft}[interface]\nyield_pressure = "1.6 Y"\n')
    assert case.yielding().source == "hardness of first (sodium-chloride), 216 MPa"


def test_a_strength_of_ones_own():
    steel = 'first = { material = "steel", radius = "1 mm", yield_strength = "500 MPa" }\n'
    case = parsed(f'{steel}[interface]\nyield_pressure = "2 Y"\n')
    assert case.yielding().hardness == 1e9


@pytest.mark.parametrize(
    ("pressure", "remedy"),
    [
        ("2.8 Y", r"needs first\.yield_strength, which is not given; give it"),
        ("hardness", r"needs first\.hardness, which is not given; give it"),
        ("28 Y", "is no contact pressure"),
        ("Y", "is not one number followed by a unit"),
        ("hard", "is not one number followed by a unit"),
        ("-1 MPa", "greater than zero"),
    ],
)
def test_a_rule_that_does_not_hold(pressure, remedy):
    bare = 'first = { radius = "1 mm", youngs_modulus = "70 GPa", poissons_ratio = 0.2 }\n'
    with pytest.raises(CaseError, match=rf"interface\.yield_pressure: .*{remedy}"):
        parsed(f'{bare}[interface]\nyield_pressure = "{pressure}"\n')


def test_results_say_where_values_are_from(cli, tmp_path):
    text = f'second = "steel"\n{GLASS}[interface]\nyield_pressure = "hardness"\n{REST}'
    (tmp_path / "case.toml").write_text(text)
    status, said, _ = cli("check", tmp_path / "case.toml")
    assert status == 0
    assert "hardness of first (glass), 5700 MPa" in said
    assert cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")[0] == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["model"]["yield_pressure"] == "hardness of first (glass), 5700 MPa"
    density = summary["materials"]["second"]["density"]
    assert density["value"] == summary["materials"]["second"]["density"]["value"] == 7830
    assert density["low"] <= density["value"] <= density["high"]
    assert "verified" in density
    assert density["source"]
