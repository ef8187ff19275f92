"""Keys of [impacts] in a study."""

import pytest

from restitution.case.case_file import parse_case
from restitution.errors import CaseError
from restitution.sweeps.sweep import parse_study

CASE = """
[first]
radius = "50 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
density = "7850 kg/m^3"
[interface]
yield_pressure = "1 GPa"
[roughness]
kind = "gaussian"
rms = "15 nm"
correlation_length = "1 um"
seed = 1
[grid]
nodes = 48
spacing = "0.25 um"
[impact]
velocity = "0.1 m/s"
[impacts]
coverage = 1
[sweep]
"impacts.coverage" = [1, 2]
"impacts.place" = ["random", "same"]
"""


def test_a_study_sweeps_keys_of_impacts():
    study = parse_study(CASE)
    assert len(study.cases) == 4
    assert "coverage = 2" in study.cases[-1].text


def test_a_periodic_contact_has_no_impacts():
    case = CASE[: CASE.index("[sweep]")].replace('"50 um"', '"flat"')
    case = case.replace("nodes = 48", "nodes = 48\nperiodic = true")
    periodic = case.replace('[impact]\nvelocity = "0.1 m/s"', '[indentation]\nvalues = ["1 nm"]')
    with pytest.raises(CaseError, match=r"^\[impacts\]: .* remove this table$"):
        parse_case(periodic)
    parse_case(periodic[: periodic.index("[impacts]")])
