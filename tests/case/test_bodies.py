"""Materials by name, and the pressure at which they yield."""

import json
import math
from pathlib import Path

import pytest

from restitution.case.bodies import FROM_LIBRARY
from restitution.case.case_file import parse_case
from restitution.case.interface import Yielding
from restitution.case.materials import material
from restitution.contact.plasticity.cavity import ExpandingCavity
from restitution.errors import CaseError

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


@pytest.mark.parametrize("key", ["youngs_modulus", "poissons_ratio", "density", "hardness"])
def test_a_given_value_has_no_spread_even_if_it_is_that_of_the_library(key):
    known, unit = getattr(material("glass"), key).value, FROM_LIBRARY[key]
    given = f'{key} = "{known!r} {unit}"' if unit else f"{key} = {known!r}"
    case = parsed(GLASS.replace(" }", f", {given} }}"))
    assert getattr(case.first, key) == known
    of_library = parsed(GLASS).first.from_library()
    assert set(of_library) - set(case.first.from_library()) == {key}
    copied = case.refined(2).variant(1).first.model_copy(update={"radius": 1e-4})
    assert copied.from_library() == case.first.from_library()
    assert case.yielding() == parsed(GLASS).yielding()


def test_a_name_alone_is_a_wall():
    pair = parsed('second = "aluminum"\n' + GLASS).pair()
    assert math.isinf(pair.second.radius)
    assert pair.second.youngs_modulus == material("aluminium").youngs_modulus.value
    with pytest.raises(CaseError, match="both bodies are flat"):
        parsed('first = "glass"\nsecond = "steel"\n').pair()
    with pytest.raises(CaseError, match=r'add \[second\], or give .* a radius such as "500 um"'):
        parsed('first = "glass"\n').pair()


@pytest.mark.parametrize("table", ['first = "gless"', 'first = { material = "gless" }'])
def test_a_material_that_is_not_known(table):
    with pytest.raises(CaseError, match=r'first: "gless" is not a material .* mean "glass"'):
        parsed(f"{table}\n")


def test_the_softer_body_yields():
    hardness = '[interface]\nyield_pressure = "hardness"\n'
    case = parsed(f'second = "aluminium"\n{GLASS}{hardness}')
    yielding = case.yielding()
    assert yielding.yield_pressure == material("aluminium").hardness.value
    assert yielding.source == "hardness of second (aluminium), 1050 MPa"
    assert parsed(GLASS + hardness).yielding().yield_pressure == material("glass").hardness.value


@pytest.mark.parametrize(("rule", "factor"), [("1.6 Y", 1.6), ("2.8Y", 2.8), ("3 * Y", 3.0)])
def test_so_many_yield_strengths(rule, factor):
    steel = 'first = { material = "steel", radius = "1 mm" }\nsecond = "304"\n'
    case = parsed(f'{steel}[interface]\nyield_pressure = "{rule}"\n')
    assert case.yielding().hardness == factor * material("304").yield_strength.value
    assert case.yielding().source.startswith(f"{factor:g} Y of second (stainless-steel)")


def test_a_body_without_a_yield_strength_yields_at_its_hardness():
    steel = 'first = { material = "glass", radius = "1 mm" }\nsecond = "polystyrene"\n'
    case = parsed(f'{steel}[interface]\nyield_pressure = "1.6 Y"\n')
    strength = material("polystyrene").yield_strength.value
    assert case.yielding() == Yielding(
        "1.6 Y of second (polystyrene), Y = 90 MPa",
        yield_pressure=1.6 * strength,
        yields="second",
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
        ("28 Y", "is not a plausible contact pressure"),
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


STEELS = 'first = { material = "steel", radius = "1 mm" }\nsecond = "304"\n'


def test_a_known_strength_bounds_by_an_expanding_cavity():
    """The default is the strength of the softer body; interface.yield_strength overrides it."""
    strength = material("304").yield_strength.value
    yielding = parsed(STEELS).yielding()
    assert yielding == Yielding(
        f"Y of second (stainless-steel), {1e-6 * strength:.6g} MPa",
        "expanding-cavity",
        yield_strength=strength,
        yields="second",
    )
    own = parsed(f'{STEELS}[interface]\nyield_strength = "1 GPa"\ntangent_modulus = "2 GPa"\n')
    assert own.yielding() == Yielding(
        "given",
        "expanding-cavity",
        yield_strength=1e9,
        tangent_modulus=2e9,
        yields="second",
    )
    contact = own.contact(Path())
    assert contact.plasticity == ExpandingCavity(1e9, 2e9)


def test_a_yield_pressure_keeps_the_constant_bound():
    text = f'{STEELS}[interface]\nyield_pressure = "2.8 Y"\n'
    assert parsed(text).yielding().plasticity == "equilibrium"
    constant = parsed(f'{STEELS}[interface]\nplasticity = "equilibrium"\n').yielding()
    assert constant == parsed(text).yielding()
    # ceramics have no yield strength: the softer body yields at its hardness
    assert parsed(GLASS).yielding().source.startswith("hardness of first (glass)")


@pytest.mark.parametrize(
    ("interface", "said"),
    [
        (
            'yield_strength = "1 GPa"\nyield_pressure = "2 GPa"',
            "yield_pressure, yield_strength: give only one of them",
        ),
        (
            'tangent_modulus = "1 GPa"\nyield_pressure = "2 GPa"',
            "yield_pressure, tangent_modulus: give only one of them",
        ),
        (
            'plasticity = "expanding-cavity"\nyield_pressure = "2 GPa"',
            'is not used with plasticity = "expanding-cavity"; give yield_strength',
        ),
        (
            'plasticity = "truncated"\nyield_strength = "2 GPa"',
            'is not used with plasticity = "truncated"; give a yield_pressure',
        ),
        ('plasticity = "expanding-cavity"', r"first \(glass\) has no yield_strength; give"),
        ('tangent_modulus = "1 GPa"', r"first \(glass\) has no yield_strength; give"),
    ],
)
def test_a_model_without_what_it_needs(interface, said):
    with pytest.raises(CaseError, match=said):
        parsed(f"{GLASS}[interface]\n{interface}\n").yielding()


def test_a_tangent_modulus_above_youngs_is_refused():
    text = f'{STEELS}[interface]\nyield_strength = "1 GPa"\ntangent_modulus = "300 GPa"\n'
    case = parsed(text)
    with pytest.raises(
        CaseError, match=r"tangent_modulus: 3e\+11 Pa is not between 0 and Young's modulus"
    ):
        case.contact(Path())


@pytest.mark.parametrize(("first", "second"), [("5 GPa", "1 GPa"), ("1 GPa", "5 GPa")])
def test_a_missing_yield_strength_is_asked_of_the_softer_body(first, second):
    of = 'radius = "1 mm"\nyoungs_modulus = "70 GPa"\npoissons_ratio = 0.2\nhardness = "{}"\n'
    softer = "first" if first == "1 GPa" else "second"
    with pytest.raises(CaseError, match=f"and {softer} has no yield_strength"):
        parsed(
            f"[first]\n{of.format(first)}[second]\n{of.format(second)}"
            '[interface]\nplasticity = "expanding-cavity"\n'
        )


OWN = 'youngs_modulus = "70 GPa", poissons_ratio = 0.3'


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ('yield_strength = "100 MPa"', 'yield_strength = "300 MPa"', "first"),
        ('yield_strength = "300 MPa"', 'yield_strength = "100 MPa"', "second"),
        ('yield_strength = "105 MPa"', 'yield_strength = "100 MPa"', "both"),
        ('yield_strength = "150 MPa"', 'yield_strength = "100 MPa"', "both"),
        ('yield_strength = "100 MPa"', 'yield_strength = "150 MPa"', "first"),
        ('yield_strength = "100 MPa"', 'hardness = "300 MPa"', "both"),
        ('hardness = "1 GPa"', 'hardness = "2 GPa"', "first"),
        ('yield_strength = "100 MPa"', "", None),
    ],
)
def test_which_body_yields(first, second, expected):
    """Both yield up to 1.75 times the strength if the wall is softer, else up to 1.1 times."""
    tables = (f'radius = "1 mm", {OWN}, {first}', f'radius = "flat", {OWN}, {second}')
    text = "".join(
        f"{name} = {{ {table.rstrip(', ')} }}\n"
        for name, table in zip(("first", "second"), tables, strict=True)
    )
    given = '[interface]\nyield_pressure = "300 MPa"\n'
    assert parsed(text + given).yielding().yields == expected
    assert parsed(text + '[interface]\nyield_pressure = "elastic"\n').yielding().yields is None


def test_two_equal_bodies_yield_alike():
    text = f'first = {{ radius = "1 mm", {OWN} }}\n[interface]\nyield_strength = "1 GPa"\n'
    assert parsed(text).yielding().yields == "both"
