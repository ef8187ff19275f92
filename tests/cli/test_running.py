"""The words that `restitution run` adds to its numbers."""

import math

import pytest

from points import point
from restitution.case.case_file import parse_case
from restitution.cli.run import _advice, _elastic_error, _with_error
from restitution.errors import CaseError


def test_the_error_of_a_model_that_does_not_yield_is_explained():
    def row(error, work, cor):
        return point(model_error=error, plastic_work=work, restitution=cor)

    assert "from 1.6 Y on" in _elastic_error([row(0.0, 0.0, 1.0), row(0.07, 0.0, 1.0)])
    for other in (row(0.0, 0.0, 1.0), row(0.1, 1e-9, 0.9), row(0.1, 0.0, 0.9)):
        assert _elastic_error([other]) == ""


def test_unknown_errors_are_named():
    assert _with_error(0.5, 0.01, wanted=True) == "0.5000 ± 0.0100"
    assert _with_error(0.5, math.nan, wanted=True) == "0.5000 ± unknown"
    assert _with_error(0.5, math.nan, wanted=False) == "0.5000"


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
rms = "60 nm"
correlation_length = "1 um"
seed = 1
[grid]
nodes = 32
spacing = "0.3 um"
[impact]
velocity = ["0.1 m/s"]
"""


@pytest.mark.parametrize("more", ["", "[impacts]\ncoverage = 1\n"])
def test_the_advice_of_more_surfaces_is_for_single_impacts(more):
    """[impacts] refuses `realisations`."""
    rough = point(surface_scatter=0.2, total_error=0.2)
    advice = _advice(parse_case(CASE + more), [rough], {"warnings": [], "diagnostics": {}})
    assert ("realisations = 8" in advice) is (not more)
    with pytest.raises(CaseError, match=r"roughness\.realisations: must be 1 with \[impacts\]"):
        parse_case(
            CASE.replace("seed = 1", "seed = 1\nrealisations = 8") + "[impacts]\ncount = 9\n"
        )
