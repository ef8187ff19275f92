import runpy
from pathlib import Path

import pytest

from restitution.case.materials import Property, material, materials
from restitution.errors import CaseError
from tolerance import approx

DOCS = Path(__file__).parents[2] / "docs"
ALL = materials().values()
each_material = pytest.mark.parametrize("found", ALL, ids=lambda found: found.key)


def properties(found):
    return {
        name: value
        for name in type(found).model_fields
        if isinstance(value := getattr(found, name), Property)
    }


def test_the_materials_asked_for_are_there():
    assert 10 <= len(ALL) <= 18
    assert {
        "steel",
        "stainless-steel",
        "aluminium",
        "glass",
        "silica",
        "alumina",
        "zirconia",
        "polystyrene",
        "pmma",
        "lactose",
        "mcc",
        "sucrose",
    } <= set(materials())


@each_material
def test_every_quantity_has_a_spread_and_a_source(found):
    assert {"youngs_modulus", "poissons_ratio", "density"} <= set(properties(found))
    assert found.note.endswith(".")
    for each in properties(found).values():
        assert each.low <= each.value <= each.high
        assert len(each.source) > 20


@each_material
def test_values_are_plausible(found):
    E, nu, rho = (getattr(found, name) for name in ("youngs_modulus", "poissons_ratio", "density"))
    assert E.low > 1e9
    assert E.high < 1e12
    assert nu.low >= 0.05
    assert nu.high < 0.45
    assert rho.low > 900
    assert rho.high < 16_000
    for strength in (found.yield_strength, found.hardness):
        if strength:
            assert E.value / strength.value > 5
    if found.yield_strength and found.hardness:
        assert 1.5 <= found.hardness.value / found.yield_strength.value <= 6


@each_material
def test_every_material_says_when_it_yields(found):
    assert found.yield_strength or found.hardness


def test_values_are_in_si_units():
    alumina = material("alumina")
    assert alumina.youngs_modulus.value == 416e9
    assert alumina.density.value == 3984
    assert material("mcc").hardness.value == approx(168e6)


def test_names_are_found_in_any_case_and_by_alias():
    assert material("Steel") is material("STEEL") is material("100cr6")
    assert material(" aluminum ") is material("aluminium")
    assert material("Stainless Steel") is material("stainless_steel")


def test_names_and_aliases_are_unique():
    names = [name.lower() for found in ALL for name in (found.key, *found.aliases)]
    assert len(names) == len(set(names))
    for found in ALL:
        for name in (found.key, *found.aliases):
            assert material(name) is found


@pytest.mark.parametrize(("wrong", "near"), [("stel", "steel"), ("Lactos", "lactose")])
def test_an_unknown_name_is_met_with_a_suggestion(wrong, near):
    with pytest.raises(CaseError) as caught:
        material(wrong)
    assert str(caught.value).startswith(f'"{wrong}" is not a material of the library; did you mean')
    assert f'did you mean "{near}"?' in str(caught.value)
    assert ", ".join(materials()) in str(caught.value)


def test_a_name_like_no_other_is_met_with_all_names():
    with pytest.raises(CaseError, match="library; known materials: steel, "):
        material("x" * 100)


def test_a_value_outside_its_spread_is_refused():
    given = {"value": 3.0, "low": 1.0, "high": 2.0, "source": "somewhere", "verified": True}
    with pytest.raises(ValueError, match="between low and high"):
        Property[float].model_validate(given)


def test_the_page_of_materials_is_up_to_date():
    table = runpy.run_path(str(DOCS / "studies" / "materials.py"))["table"]()
    assert table in (DOCS / "materials.md").read_text(encoding="utf-8")
