"""The work of adhesion of the materials library, and `work_of_adhesion = "library"` in a case."""

import math

import pytest

from restitution.case.case_file import parse_case
from restitution.case.materials import adhesive, material, materials, work_of_adhesion
from restitution.case.omissions import omissions
from restitution.errors import CaseError
from tolerance import approx

CASE = """
first = {{ material = "{first}", radius = "20 um" }}
{second}
[interface]
work_of_adhesion = {w}
[grid]
nodes = 32
spacing = "0.1 um"
[impact]
velocity = ["0.1 m/s"]
"""


def case(first="lactose", second='second = "glass"', w='"library"'):
    return parse_case(CASE.format(first=first, second=second, w=w))


def test_it_is_the_geometric_mean_of_the_surface_energies():
    w = work_of_adhesion("glass", "Lactose")
    glass, lactose = (material(key).surface_energy for key in ("glass", "lactose"))
    assert w.value == approx(2 * math.sqrt(glass.value * lactose.value), rel=1e-12)
    assert w.low == approx(2 * math.sqrt(glass.low * lactose.low), rel=1e-12)
    assert w.high == approx(2 * math.sqrt(glass.high * lactose.high), rel=1e-12)
    assert glass.source in w.source
    assert lactose.conditions in w.source
    assert work_of_adhesion("lactose", "lactose").value == approx(2 * 0.0233, rel=1e-12)


def test_a_pair_is_symmetric():
    for first in adhesive():
        for second in adhesive():
            pair, swapped = work_of_adhesion(first, second), work_of_adhesion(second, first)
            assert pair.value == approx(swapped.value, rel=1e-12)
            assert 0.03 < pair.low <= pair.value <= pair.high < 0.12


def test_a_case_takes_it_from_its_materials():
    for second, pair in (('second = "glass"', ("lactose", "glass")), ("", ("lactose", "lactose"))):
        with_library = case(second=second)
        assert with_library.interface.work_of_adhesion == work_of_adhesion(*pair).value
        assert with_library.library_adhesion() == work_of_adhesion(*pair)


def test_a_given_value_has_no_spread():
    assert case(w='"0.05 J/m^2"').library_adhesion() is None
    assert case(w='"0 J/m^2"').library_adhesion() is None
    same = f'"{work_of_adhesion("lactose", "lactose").value!r} J/m^2"'
    assert case(w=same, second="").library_adhesion() is None


def test_no_value_is_used_by_omission():
    text = CASE.format(first="lactose", second='second = "glass"', w='"library"')
    silent = parse_case(text.replace('work_of_adhesion = "library"\n', ""))
    assert silent.interface.adhesive_energy == 0
    (warning,) = [line for line in omissions(silent) if "work_of_adhesion" in line]
    assert '"library" for the one of the materials library' in warning
    other = parse_case(
        text.replace('work_of_adhesion = "library"\n', "").replace("glass", "quartz")
    )
    assert not any('"library"' in line for line in omissions(other))


def test_a_material_without_a_surface_energy_is_named():
    lacking = next(key for key, one in materials().items() if one.surface_energy is None)
    with pytest.raises(CaseError) as caught:
        case(second=f'second = "{lacking}"')
    said = str(caught.value)
    assert f"work_of_adhesion: the library has no surface energy of {lacking}; give" in said
    assert '"0.05 J/m^2"' in said
    assert ", ".join(adhesive()) in said


def test_a_body_without_a_material_is_named():
    second = """
[second]
radius = "flat"
youngs_modulus = "1 GPa"
poissons_ratio = 0.3
hardness = "100 MPa"
"""
    with pytest.raises(CaseError, match=r'"library" needs second.material; name a material, or'):
        case(second=second)
