"""Free keys: found in the case, scaled in their own units, and refused if they cannot be free."""

import numpy as np
import pytest

from restitution.case.case_file import parse_toml
from restitution.errors import CaseError
from restitution.fit.parameters import free_parameters, with_factors
from tolerance import approx

CASE = """
[first]
material = "steel"
radius = "500 um"
yield_strength = "300 MPa"
[interface]
yield_pressure = "2.8 Y"
work_of_adhesion = "0 J/m^2"
[roughness]
kind = "exponential"
rms = "0.1 um"
correlation_length = ["2 um", "4 um"]
hurst = 0.8
seed = 3
[grid]
nodes = 64
spacing = "0.5 um"
"""


def test_whole_keys_and_last_parts_are_found():
    rms, hurst = free_parameters(parse_toml(CASE), ["rms", "roughness.hurst"])
    assert (rms.key, rms.unit, rms.value) == ("roughness.rms", "m", approx(1e-7))
    assert (hurst.key, hurst.unit, hurst.value) == ("roughness.hurst", "1", 0.8)
    assert rms.text(1.23456) == "0.1235 um"
    assert hurst.scaled(0.5) == approx(0.4)


def test_values_are_scaled_in_the_case():
    content = parse_toml(CASE)
    found = free_parameters(content, ["rms", "hurst"])
    case = with_factors(content, found, np.array([2.0, 0.5]))
    assert (case["roughness"]["rms"], case["roughness"]["hurst"]) == ("0.20000000000000001 um", 0.4)
    assert content["roughness"]["rms"] == "0.1 um"


def test_one_of_several_tables_is_named_by_its_number():
    content = parse_toml(
        CASE.replace("[roughness]", "[[roughness]]") + '[[roughness]]\nrms = "1 um"'
    )
    with pytest.raises(CaseError, match=r"rms may mean roughness\.1\.rms or roughness\.2\.rms"):
        free_parameters(content, ["rms"])
    (second,) = free_parameters(content, ["roughness.2.rms"])
    assert with_factors(content, [second], np.array([3.0]))["roughness"][1]["rms"] == "3 um"


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ([], "names no key"),
        (["xyz"], "xyz is not a key of the case; add it to the case with a first guess"),
        (["interface.yield_strength"], "interface.yield_strength is not a key of the case"),
        (["yield_pressure"], '= "2.8 Y" is not a number or quantity'),
        (["work_of_adhesion"], '= "0 J/m^2" is not positive'),
        (["correlation_length"], "is a list; write one value for both axes"),
        (["seed"], "roughness.seed cannot be free"),
        (["nodes"], "grid.nodes cannot be free"),
        (["kind"], '= "exponential" is not a number'),
        (["rms", "roughness.rms"], "roughness.rms is named twice"),
    ],
)
def test_keys_that_cannot_be_free_are_refused(names, words):
    with pytest.raises(CaseError) as refusal:
        free_parameters(parse_toml(CASE), names)
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_two_keys_of_one_name_are_refused():
    content = parse_toml(CASE + '[second]\nyield_strength = "400 MPa"\n')
    with pytest.raises(CaseError, match=r"first\.yield_strength or second\.yield_strength"):
        free_parameters(content, ["yield_strength"])


def test_the_rms_of_a_scan_is_refused():
    content = parse_toml('[roughness]\nkind = "measured"\nfile = "a.npz"\n')
    with pytest.raises(CaseError, match="is a scan, whose heights are known"):
        free_parameters(content, ["rms"])


def test_the_size_effect_can_be_free():
    interface = {"yield_pressure": "1 GPa", "size_effect": "0.4 um", "hardness_depth": "1 um"}
    (free,) = free_parameters({"interface": interface}, ["size_effect"])
    assert (free.key, free.value, free.unit) == ("interface.size_effect", 0.4e-6, "m")
