import pytest

from restitution.case.materials import Property, material, materials
from restitution.errors import CaseError
from tolerance import approx

ALL = materials().values()
each_material = pytest.mark.parametrize("entry", ALL, ids=lambda entry: entry.key)


def properties(entry):
    return {
        name: value
        for name in type(entry).model_fields
        if isinstance(value := getattr(entry, name), Property)
    }


# Materials of which no source of E, ν and a strength was found: the user gives them.
PARTIAL = {"paracetamol", "ibuprofen", "mannitol"}
SOFT = {"hdpe", "ldpe"}


def test_the_materials_asked_for_are_there():
    assert set(materials()) == {
        "steel",
        "stainless-steel",
        "aluminium",
        "copper",
        "glass",
        "silica",
        "quartz",
        "alumina",
        "zirconia",
        "tungsten-carbide",
        "polystyrene",
        "pmma",
        "sodium-chloride",
        "sucrose",
        "lactose",
        "mcc",
        "calcite",
        "limestone",
        "talc",
        "titania",
        "starch",
        "paracetamol",
        "ibuprofen",
        "mannitol",
        "hdpe",
        "ldpe",
        "pvc",
    }


@each_material
def test_every_quantity_has_a_spread_and_a_source(entry):
    needed = {"youngs_modulus", "poissons_ratio", "density"}
    assert needed <= set(properties(entry)) or entry.key in PARTIAL
    assert entry.note.endswith(".")
    for value in properties(entry).values():
        assert value.low <= value.value <= value.high
        assert len(value.source) > 20
    for known in filter(None, (entry.surface_energy, entry.size_effect)):
        assert len(known.conditions) > 20


@each_material
def test_what_is_missing_is_said_in_the_note(entry):
    if entry.key in PARTIAL:
        missing = {"youngs_modulus", "poissons_ratio"} - set(properties(entry))
        assert missing
        assert all(key in entry.note for key in missing)


@each_material
def test_values_are_plausible(entry):
    E, nu, rho = (getattr(entry, name) for name in ("youngs_modulus", "poissons_ratio", "density"))
    if E and nu:
        assert E.low > (1e8 if entry.key in SOFT else 1e9)
        assert E.high < 1e12
        assert nu.low >= 0.05
        assert nu.high < 0.45
    if rho:
        assert rho.low > 900
        assert rho.high < 16_000
    for strength in (entry.yield_strength, entry.hardness):
        if strength and E:
            assert E.value / strength.value > 5
    if entry.yield_strength and entry.hardness:
        assert 1.5 <= entry.hardness.value / entry.yield_strength.value <= 6
    if entry.surface_energy:
        assert entry.surface_energy.low > 0.015
        assert entry.surface_energy.high < 0.08


@each_material
def test_every_material_says_when_it_yields(entry):
    assert entry.yield_strength or entry.hardness or entry.key in PARTIAL


def test_values_computed_from_others_are_right():
    def of(K, G):
        return 9 * K * G / (3 * K + G), (3 * K - 2 * G) / (2 * (3 * K + G))

    for key, moduli in (("calcite", (76.8e9, 32e9)), ("talc", (47e9, 25e9))):
        E, nu = of(*moduli)
        assert material(key).youngs_modulus.value == approx(E, rel=2e-3)
        assert material(key).poissons_ratio.value == approx(nu, rel=3e-3)
    assert material("limestone").youngs_modulus.low == approx(of(65e9, 24e9)[0], rel=2e-3)
    HV = 9.807e6 / 0.927
    assert material("titania").hardness.value == approx(880 * HV, rel=2e-3)
    assert material("calcite").hardness.value == approx(140 * HV, rel=2e-3)


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
    names = [name.lower() for entry in ALL for name in (entry.key, *entry.aliases)]
    assert len(names) == len(set(names))
    for entry in ALL:
        for name in (entry.key, *entry.aliases):
            assert material(name) is entry


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("CaCO3", "calcite"),
        ("marble", "limestone"),
        ("TiO2", "titania"),
        ("Rutile", "titania"),
        ("acetaminophen", "paracetamol"),
        ("High density polyethylene", "hdpe"),
        ("PE-LD", "ldpe"),
        ("uPVC", "pvc"),
        ("corn starch", "starch"),
    ],
)
def test_common_names_of_powders_are_known(name, key):
    assert material(name).key == key


@pytest.mark.parametrize(
    ("wrong", "hint"),
    [
        ("polyethylene", 'did you mean "hdpe" or "ldpe"?'),
        ("PE", 'did you mean "hdpe" or "ldpe"?'),
        ("anatase", 'it is mentioned under "titania";'),
        ("chalk", 'it is mentioned under "limestone";'),
    ],
)
def test_a_word_of_a_name_or_note_leads_to_its_material(wrong, hint):
    with pytest.raises(CaseError) as caught:
        material(wrong)
    assert f"library; {hint} known materials" in str(caught.value)


def test_a_name_that_only_looks_alike_is_not_suggested():
    with pytest.raises(CaseError, match="library; known materials"):
        material("gypsum")  # not GPPS


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
