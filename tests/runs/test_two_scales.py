"""Grids for waves in patches: those that a run chooses, and those that it names."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from points import point
from restitution.case.below_grid import notice_of, refines_for_patches
from restitution.case.case_file import parse_case
from restitution.contact.bodies import Body, Pair
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact, smooth
from restitution.contact.patch.law import PatchAttraction, law_of_patches
from restitution.numerics.grid import Grid
from restitution.runs import refinement, two_scales
from restitution.runs.depths import load_to
from restitution.runs.error_budget import law_error
from restitution.runs.refinement import with_chosen_grids
from restitution.runs.two_scales import patches_that_jump, solve_patches, too_small_for_patches
from restitution.surfaces import generate_surface
from tolerance import approx

CASE = """
[first]
radius = "100 um"
youngs_modulus = "70 GPa"
poissons_ratio = 0.2
density = "2500 kg/m^3"
[second]
radius = "flat"
youngs_modulus = "200 GPa"
poissons_ratio = 0.3
[interface]
{interface}
[roughness]
kind = "measured"
file = "{file}"
detrend = "tilt"
below_grid = "{below}"
{split}
[grid]
nodes = 40
spacing = "0.25 um"
{refine}
[impact]
velocity = "{velocity}"
"""
ROUGH = """
[first]
radius = "1 um"
youngs_modulus = "4 GPa"
poissons_ratio = 0.3
[interface]
work_of_adhesion = "0.08 J/m^2"
yield_pressure = "elastic"
[roughness]
kind = "self-affine"
rms = "0.15 nm"
hurst = 0.8
rolloff = "40 nm"
shortest = "7 nm"
seed = 1
[grid]
nodes = 8
spacing = "11.2 nm"
[indentation]
values = ["0.2 nm"]
"""
USUAL = {
    "interface": 'yield_pressure = "3 GPa"',
    "below": "patch",
    "split": "",
    "refine": "",
    "velocity": "0.1 m/s",
}


@pytest.fixture
def case(own_scan):
    def make(**values):
        return parse_case(CASE.format(**{**USUAL, "file": own_scan.as_posix(), **values}))

    return make


def separation(case, folder):
    """Contact radius divided by the longest wave of the patches."""
    contact = case.contact(folder)
    state = load_to(case, contact, case.depths()[0])
    return math.sqrt(state.contact_area / math.pi) / law_of_patches(contact).wavelength


def test_the_grid_is_refined_until_the_contact_is_not_small_beside_the_patches(case, tmp_path):
    said = []
    chosen = with_chosen_grids(case(), tmp_path, said.append)
    assert chosen.grid.factor > 1
    assert separation(chosen, tmp_path) >= 2
    assert separation(case().refined(chosen.grid.factor // 2), tmp_path) < 2
    nodes = 40 * chosen.grid.factor
    (line,) = said
    assert f"refined up to {chosen.grid.factor} times ({nodes} x {nodes} nodes)" in line
    assert "grid.refine = 1 keeps it" in line


def test_few_asperities_with_a_growing_bound_get_a_grid_that_carries_all_waves(case, tmp_path):
    growing = 'yield_strength = "1 GPa"'
    given = case(interface=growing, refine="refine = 1")
    named = int(re.search(r"grid\.refine = (\d+)", notice_of(given, tmp_path))[1])
    chosen = with_chosen_grids(case(interface=growing), tmp_path)
    assert chosen.grid.factor == named
    assert chosen.splitting(tmp_path) is None
    assert notice_of(chosen, tmp_path) is None
    assert given.refined(named // 2).splitting(tmp_path) is not None


def test_a_grid_that_cannot_be_refined_further_is_told(case, tmp_path, monkeypatch):
    monkeypatch.setattr(refinement, "_MOST_IMPLIED", 40**2)
    said = []
    chosen = with_chosen_grids(case(), tmp_path, said.append)
    assert chosen.grid.factor == 1
    assert "at 100 mm/s" in said[0]
    assert "the next grid would have 80 x 80 nodes" in said[0]


@pytest.mark.parametrize(
    "values",
    [
        {"refine": "refine = 1"},
        {"below": "omit"},
        {"split": 'split = "0.6 um"'},
        {"interface": 'yield_pressure = "elastic"'},
        {"interface": 'work_of_adhesion = "0.1 J/m^2"\nyield_pressure = "3 GPa"'},
    ],
)
def test_other_grids_stay(case, tmp_path, values):
    given = case(**values)
    assert not refines_for_patches(given, tmp_path)
    assert with_chosen_grids(given, tmp_path) is given
    assert refines_for_patches(case(), tmp_path)


@pytest.fixture
def small(case, tmp_path):
    """A contact on given cells, and points whose contacts are small and large beside patches."""
    given = case(refine="refine = 1")
    contact = given.contact(tmp_path)
    radius = law_of_patches(contact).wavelength * 0.6
    area = math.pi * radius**2
    points = [point(contact_area=a, discretisation_error=0.12) for a in (area, 100 * area)]
    return given, contact, points


def test_a_wide_error_names_a_grid_and_the_error_there(small):
    given, contact, points = small
    (line,) = too_small_for_patches(given, contact, points)
    assert "(500 nm) at 1 of 2 depths" in line
    assert "grid.refine = 4 (160 x 160 nodes), it would be about 0.03" in line
    narrow = [replace(wide, discretisation_error=0.02) for wide in points]
    assert not list(too_small_for_patches(given, contact, narrow))
    finer = given.refined(2)
    assert "grid.refine = 8 (320 x 320 nodes)" in next(
        too_small_for_patches(finer, contact, points)
    )


def test_changes_at_other_velocities_count_in_proportion_to_the_split():
    change, none, work = np.array([0.08, 0.0]), np.zeros(2), np.array([1.0, math.e**2])
    ratio = np.array([2.0, 0.5])
    slow, fast = law_error(change, none, work, ratio)
    weight = math.exp(-2) / (1 + math.exp(-2))
    assert fast == approx(0.08 * math.sqrt(weight) / 4)
    assert slow == approx(0.08 * math.sqrt(1 - weight))
    assert law_error(change, none, work, np.ones(2))[1] == approx(4 * fast)


def test_patches_that_lose_much_in_jumps_name_cells_that_need_none(monkeypatch):
    grid, soft = Grid((64, 64), (0.7e-9, 0.7e-9)), (4e9, 0.3, 1500.0)
    shape = {"kind": "self-affine", "hurst": 0.8, "shortest": 7e-9, "rolloff": 40e-9}
    patch = generate_surface(grid, rms=0.15e-9, seed=1, **shape)
    law = PatchAttraction((patch,), grid.size[0] / 2, Cohesive(0.08))
    pair = Pair(Body(1e-6, *soft), Body(math.inf, *soft))
    wide = Grid((8, 8), (grid.size[0] / 4, grid.size[0] / 4))
    contact = Contact(pair, smooth(wide), adhesion=law)
    given = parse_case(ROUGH)
    monkeypatch.setattr(two_scales, "_LOST", 0.02)
    assert not list(patches_that_jump(given, contact))  # not solved yet
    solve_patches(contact)
    lost = contact.adhesion.lost_in_jumps / 0.08
    assert 0.025 < lost < 0.035
    assert contact.adhesion.pull_off_error(None) == approx(lost)
    (line,) = patches_that_jump(given, contact)
    assert "the patches lose 3% of the work of adhesion in jumps" in line
    assert 'use grid.nodes = [128, 128] and grid.spacing = "0.7 nm", without patches' in line
    monkeypatch.setattr(two_scales, "MOST_NODES", 2**13)
    (line,) = patches_that_jump(given, contact)
    assert "leave out short waves (roughness.shortest), without patches" in line
    monkeypatch.setattr(two_scales, "_LOST", 0.05)
    assert not list(patches_that_jump(given, contact))
