"""The pull-off force of adhesive pairs in the exports."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest

from restitution.dem.export import ADHESIVE, CODES, WHOLE, export
from restitution.dem.pair import pull_off_force
from restitution.errors import CaseError
from tolerance import approx


@pytest.fixture
def adhesive(law):
    """A law whose pull-off force is 1 µN ln(V/V₁) above 5 µN."""
    base = law(work_of_adhesion=0.2)
    points = tuple(
        replace(p, pull_off_force=5e-6 + 1e-6 * math.log(p.velocity / 0.01)) for p in base.points
    )
    return replace(base, points=points)


def test_pull_off_force_is_interpolated(adhesive, law):
    for V in np.geomspace(0.01, 10, 7):
        assert pull_off_force(adhesive, V) == approx(5e-6 + 1e-6 * math.log(V / 0.01))
    assert math.isnan(pull_off_force(law(), 1.0))


@pytest.mark.parametrize("code", [code for code in CODES if code not in (*WHOLE, *ADHESIVE)])
def test_every_code_gets_the_force_and_the_reason(adhesive, law, code):
    (*_, notes) = export([adhesive], code, 1.0).values()
    text = " ".join(notes.split())
    assert "pull-off force after an impact at 1 m/s: 9.605e-06 N" in text
    # 3/2 π w R*
    assert f"smooth bodies: {1.5 * math.pi * 0.2 * adhesive.radius:.4g} N" in text
    assert "the pull-off force is not modelled below, because" in text
    assert ("jkr and dmt do not accept coeff_restitution" in text) == (code == "lammps")
    unknown = export([law(work_of_adhesion=0.2)], code, 1.0)
    assert "not known (it needs" in list(unknown.values())[-1]


def test_the_tables_have_the_force(adhesive, law):
    for code, name in (("csv", "restitution.csv"), ("edem", "restitution_edem.csv")):
        for found, asked in ((adhesive, approx(9.60517e-6, rel=1e-6)), (law(), None)):
            lines = export([found], code, 1.0)[name].splitlines()
            (row,) = csv.DictReader(line for line in lines if not line.startswith("#"))
            force = row["pull_off_force_N"]
            assert (float(force) if force not in ("", "nan") else None) == asked


def test_a_contact_with_adhesion_needs_the_pull_off_force(law):
    for code in ("c", "python", *ADHESIVE):
        with pytest.raises(CaseError, match=r'not known.* with unloading.method = "path"'):
            export([law(work_of_adhesion=0.2)], code, 1.0)
