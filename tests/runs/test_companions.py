"""Companion curves of cohesive contacts, and of contacts with waves in patches."""

import math
from dataclasses import replace

import numpy as np
import pytest

from restitution.case.case_file import parse_case
from restitution.collision import collide
from restitution.contact.loading import solve
from restitution.curve.work_curve import WorkCurve
from restitution.errors import CaseError
from restitution.numerics.convolution.operators import Convolution
from restitution.runs.companion_curves import curve_of
from restitution.runs.companions import Companions, coarser_contact
from restitution.runs.scale_curves import ScaleCurves
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


DEPTHS = (1e-9, 1.5e-9, 2e-9, 2.5e-9, 3e-9)


def works_of(folder, depths):
    """Loading work (J) of the run at `depths` (m)."""
    contact = parse_case(COHESIVE).contact(folder)
    return np.array([solve(contact, depth).loading_work for depth in depths])


def test_other_curves_of_a_cohesive_contact_are_compared_at_the_same_impacts(tmp_path):
    """Three impacts of five give the scatter, close to that with all of them."""
    work = works_of(tmp_path, DEPTHS)
    companions = Companions(parse_case(COHESIVE), tmp_path, DEPTHS, work)
    own = companions.own.work
    assert len(own) == 1 + len(work)
    assert own[0] < work[0]
    assert np.all((work <= own[1:]) & (own[1:] < 1.1 * work))
    assert companions.reference.work == approx(own[[0, 3, 5]], rel=1e-12)
    assert companions.weaker(np.ones(5)) is companions.reference
    contact = coarser_contact(companions.case.variant(1).contact(tmp_path))
    depths = (0.9e-9, *DEPTHS)
    for other, full in (
        (companions.own, curve_of(companions.coarse, depths, "path")),
        (companions.curve(contact), curve_of(contact, depths, "path")),
    ):
        assert other.work[0] < work[0] < work[-1] <= other.work[-1] < 1.2 * work[-1]
        assert other.at(work) == approx(full.at(work), abs=0.01)
        assert other.ratio(work) == approx(full.ratio(work), abs=0.02)
        assert other.pull_off_at(work) == approx(full.pull_off_at(work), rel=0.08)


def test_bodies_that_are_weaker_by_the_smallest_factor_have_one_path(tmp_path):
    work = works_of(tmp_path, DEPTHS[:3])
    companions = Companions(parse_case(COHESIVE), tmp_path, DEPTHS[:3], work)
    coarse = companions.coarse
    weak = replace(coarse, plasticity=coarse.plasticity.scaled(0.7))
    mixed = companions.weaker(np.array([0.9, 0.7, 0.8]))
    assert mixed is companions.curve(weak)
    assert np.all(mixed.at(work) < companions.reference.at(work) - 1e-4)


def test_the_own_curve_covers_the_spread_of_the_density(tmp_path):
    """The density of silica moves the mass, and with it the work at equal velocity."""
    work = works_of(tmp_path, DEPTHS[:2])
    companions = Companions(parse_case(COHESIVE), tmp_path, DEPTHS[:2], work)
    spread = companions.case.first.from_library()["density"]
    own = companions.own.work
    assert own[0] < work[0] * spread.low / spread.value
    assert own[-1] >= work[-1] * spread.high / spread.value * (1 - 1e-9)


def test_another_curve_takes_far_fewer_products_than_the_run(tmp_path, monkeypatch):
    """Products on a quarter of the nodes count as a quarter."""
    products = 0.0

    def counted(K, *arguments):
        nonlocal products
        products += math.prod(K.shape)
        return convolve(K, *arguments)

    convolve = Convolution._convolve
    monkeypatch.setattr(Convolution, "_convolve", counted)
    case = parse_case(COHESIVE)
    state = solve(case.contact(tmp_path), 2e-9)
    collide(state)
    run = products
    companions = Companions(case, tmp_path, [2e-9], [state.loading_work])
    for contact in (companions.coarse, coarser_contact(case.variant(1).contact(tmp_path))):
        before = products
        other = companions.curve(contact)
        assert other.work[0] < state.loading_work <= other.work[-1]
        assert products - before < 0.3 * run


def test_an_impact_is_near_each_work_even_if_the_work_rises_past_the_first(tmp_path):
    """The state before has no positive work, so it has no impact."""
    companions = Companions(parse_case(COHESIVE), tmp_path, DEPTHS, works_of(tmp_path, DEPTHS))
    path = solve(companions.coarse, DEPTHS[0])
    while path.loading_work > 0:
        path, after = path.before, path
    first, last = 0.5 * after.loading_work, companions.works[-1]
    few = replace(companions, depths=DEPTHS[:2], works=[first, last])
    curve = few.curve(coarser_contact(few.case.variant(1).contact(tmp_path)))
    assert curve.work.size == 2
    assert 0 < curve.work[0] < 0.5 * last <= curve.work[1]


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
