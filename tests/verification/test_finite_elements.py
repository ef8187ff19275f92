"""Jackson and Green's (2005) fit against the finite elements of this project (evidence/)."""

import json
from pathlib import Path

import pytest

from restitution.theory import JacksonGreen
from tolerance import approx

DATA = Path(__file__).parents[2] / "evidence" / "finite_elements" / "data"


@pytest.mark.skipif(not DATA.is_dir(), reason="evidence/ is not beside the package")
def test_two_independent_finite_elements_agree():
    """Force within 4 %, area within 5.5 %: the fit is for ν = 0.32, the reference for 0.3."""
    reference = json.loads((DATA / "smooth_0.001.json").read_text())
    model = reference["model"]
    fit = JacksonGreen(
        model["radius_m"],
        reference["contact_modulus_Pa"],
        model["yield_strength_Pa"],
        model["poissons_ratio"],
    )
    assert len(reference["summary"]) >= 7
    for row in reference["summary"]:
        force = float(fit.loading_force(row["indentation_m"]))
        area = float(fit.contact_area(row["indentation_m"]))
        assert force == approx(row["force_smoothed_N"], rel=0.04, abs=0)
        assert area == approx(row["contact_area_m2"], rel=0.055, abs=0)
