"""Companion curves of cohesive contacts, and of contacts with waves in patches."""

import math
from dataclasses import replace

import numpy as np
import pytest

from restitution.case.case_file import parse_case
from restitution.contact.cohesive import equilibrium
from restitution.curve.work_curve import WorkCurve
from restitution.errors import CaseError
from restitution.numerics.truncated_newton import minimise_locally
from restitution.runs.companion_curves import curve_of
from restitution.runs.companions import Companions, ScaleCurves, coarser_contact
from restitution.surfaces.refine import coarsen
from tolerance import approx

COHESIVE = """\
first = { material = "silica", radius = "2 um" }
[interface]
work_of_adhesion = "0.05 J/m^2"
yield_pressure = "1.5 GPa"
adhesion = "cohesive"
[roughness]
kind = "gaussian"
rms = "0.6 nm"
correlation_length = "30 nm"
seed = 1
[grid]
nodes = 64
spacing = "3 nm"
[indentation]
values = ["1 nm"]
"""


def test_other_curves_of_a_cohesive_contact_are_compared_at_the_same_impacts(tmp_path):
    """Three impacts of five give the scatter, close to that with all of them."""
    companions = Companions(parse_case(COHESIVE), tmp_path, [1e-9, 1.5e-9, 2e-9, 2.5e-9, 3e-9])
    work = companions.own.work[-6:-1]
    assert companions.reference.work == approx(work[::2], rel=1e-12)
    assert companions.weaker(np.ones(5)) is companions.reference
    contact = coarser_contact(companions.case.variant(1).contact(tmp_path))
    other, full = companions.curve(contact), curve_of(contact, companions.depths, "path")
    assert other.work[0] < work[0] < work[-1] <= other.work[-1]
    assert other.at(work) == approx(full.at(work), abs=0.01)
    assert other.ratio(work) == approx(full.ratio(work), abs=0.02)
    assert other.pull_off_at(work) == approx(full.pull_off_at(work), rel=0.08)


def test_another_curve_at_one_depth_takes_two_thirds_of_the_products_of_the_own(
    tmp_path, monkeypatch
):
    products = 0

    def counted(K, *arguments, **options):
        nonlocal products
        before = K.count
        found = minimise_locally(K, *arguments, **options)
        products += K.count - before
        return found

    monkeypatch.setattr(equilibrium, "minimise_locally", counted)
    companions = Companions(parse_case(COHESIVE), tmp_path, [2e-9])
    work, own = companions.reference.work, products
    other = companions.curve(coarser_contact(companions.case.variant(1).contact(tmp_path)))
    assert other.work[0] < work[0] <= other.work[-1]
    assert products - own < 0.66 * own


def test_other_materials_may_need_finer_cells_than_a_companion_has(tmp_path):
    contact = parse_case(COHESIVE.replace("3 nm", "2 nm")).contact(tmp_path)
    coarse = coarser_contact(contact)
    sticky = replace(coarse, adhesion=coarse.adhesion.with_work_of_adhesion(0.26))
    assert coarse.adhesion.resolves_range(coarse)
    assert not sticky.adhesion.resolves_range(sticky)
    sticky.adhesion.require_fine_grid(sticky)
    with pytest.raises(CaseError, match="too coarse"):
        sticky.adhesion.require_fine_grid(replace(sticky, surface=coarsen(contact.surface)))


def test_waves_that_are_not_short_beside_the_contact_have_an_error():
    def curve(e):
        return WorkCurve(np.array([1.0, 10.0]), e**2 * np.array([1.0, 10.0]), np.zeros(2))

    own, without = curve(0.8), curve(0.9)
    scales = ScaleCurves(own, (), None, without, edge=1.0, wavelength=2e-6)
    work, area = np.array([2.0, 5.0]), math.pi * np.array([1e-6, 4e-6]) ** 2
    errors = scales.separation_error(work, area)
    assert errors[0] == approx(4 * errors[1])
    assert errors[1] == approx(0.2 * 0.5 * 0.1, rel=1e-3)
    growing = replace(scales, weaker=own).separation_error(work, area)
    assert growing[1] == approx(math.hypot(0.1, 0.25) * 0.1, rel=1e-3)
    assert not replace(scales, without=None).separation_error(work, area).any()
