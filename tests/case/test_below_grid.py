"""Which waves of the roughness go into patches."""

import numpy as np
import pytest

from restitution.case.below_grid import notice_of
from restitution.case.case_file import parse_case
from restitution.contact.patch.law import PatchAttraction, PatchRepulsion
from restitution.errors import CaseError, SurfaceError
from restitution.surfaces.split import SplitSurface
from tolerance import approx

CASE = """
first = {{ material = "steel", radius = "500 um" }}
[interface]
yield_pressure = "3 GPa"
{interface}
[roughness]
kind = "self-affine"
rms = "50 nm"
hurst = 0.8
rolloff = "10 um"
shortest = "{shortest}"
seed = 1
{more}
[grid]
nodes = 48
spacing = "{spacing}"
[impact]
velocity = "{velocity}"
"""
USUAL = {
    "interface": "",
    "more": "",
    "shortest": "0.5 um",
    "spacing": "0.5 um",
    "velocity": "0.2 m/s",
}


def case(**values):
    return parse_case(CASE.format(**{**USUAL, **values}))


def test_waves_below_two_cells_go_into_patches(tmp_path):
    contact = case().contact(tmp_path)
    law, surface = contact.adhesion, contact.surface
    assert isinstance(law, PatchRepulsion)
    assert law.wavelength == approx(1e-6)
    assert len(law.patches) == 4
    assert law.patches[0].grid.size[0] >= 8e-6
    whole = np.hypot(surface.height.std(), surface.provenance["patch_rms_m"])
    assert whole == approx(50e-9, rel=0.02)
    assert not contact.adhesive


def test_other_seeds_share_the_patches(tmp_path):
    one, other = (case().variant(number).contact(tmp_path) for number in (0, 1))
    assert one.adhesion.patches[0] is other.adhesion.patches[0]
    assert not np.array_equal(one.surface.height, other.surface.height)


def test_omit_refuses_waves_that_the_grid_cannot_represent(tmp_path):
    with pytest.raises(SurfaceError, match=r"roughness\.shortest"):
        case(more='below_grid = "omit"').contact(tmp_path)


def test_a_grid_that_carries_all_waves_is_not_split(tmp_path):
    contact = case(shortest="2 um").contact(tmp_path)
    assert contact.adhesion is None
    assert not isinstance(contact.surface, SplitSurface)
    asked = case(shortest="2 um", more='below_grid = "patch"\nsplit = "1.5 um"')
    assert asked.contact(tmp_path).adhesion is None
    assert notice_of(asked, tmp_path).startswith("roughness.below_grid: no waves are below")


def test_a_split_of_its_own(tmp_path):
    law = case(more='split = "3 um"').contact(tmp_path).adhesion
    assert law.wavelength == approx(3e-6)
    asked = case(shortest="1.5 um", more='below_grid = "patch"\nsplit = "2 um"')
    assert asked.contact(tmp_path).adhesion.wavelength == approx(2e-6)


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ({"more": 'split = "0.8 um"'}, "below two grid spacings"),
        ({"more": 'split = "40 um"'}, "above the contact radius"),
        ({"more": 'below_grid = "patch"', "velocity": "0.1 mm/s"}, "above the contact radius"),
        ({"shortest": "2 nm"}, "too large"),
    ],
)
def test_impossible_splits_name_the_key(tmp_path, values, named):
    with pytest.raises(CaseError, match=rf"^roughness.split: .*{named}"):
        case(**values).contact(tmp_path)


@pytest.mark.parametrize(
    "values",
    [
        {"more": 'below_grid = "patch"\nskewness = 0.5'},
        {
            "more": 'below_grid = "patch"',
            "interface": 'work_of_adhesion = "1 J/m^2"\nadhesion = "jkr"',
        },
        {"more": 'below_grid = "patch"', "interface": 'plasticity = "truncated"'},
    ],
)
def test_models_without_patches_refuse_the_key(tmp_path, values):
    with pytest.raises(CaseError, match=r"^roughness.below_grid: .* leave below_grid"):
        case(**values).contact(tmp_path)


def test_scales_that_do_not_separate_are_said(tmp_path):
    shallow = case(velocity="0.1 mm/s")
    assert "would not be small beside the contact radius" in notice_of(shallow, tmp_path)
    assert case().splitting(tmp_path) is not None
    assert notice_of(case(), tmp_path) is None


def test_adhesive_bodies_have_a_law_of_finite_range(tmp_path):
    adheres = 'work_of_adhesion = "0.05 J/m^2"'
    contact = case(interface=adheres).contact(tmp_path)
    assert isinstance(contact.adhesion, PatchAttraction)
    assert contact.adhesive
    assert (
        case(interface=adheres + '\nadhesion = "jkr"', shortest="2 um").splitting(tmp_path) is None
    )


def test_a_scan_on_coarse_cells(tmp_path):
    rng = np.random.default_rng(0)
    np.save(tmp_path / "scan.npy", 2e-9 * rng.standard_normal((160, 160)))
    text = CASE.format(**{**USUAL, "velocity": "0.02 m/s"})
    a, b = text.index("[roughness]"), text.index("[grid]")
    scan = '[roughness]\nkind = "measured"\nfile = "scan.npy"\nsize = "24 um"\n'
    assert parse_case(text[:a] + scan + text[b:]).contact(tmp_path).adhesion is None
    scan += 'below_grid = "patch"\n'
    given = parse_case(text[:a] + scan + text[b:])
    contact = given.contact(tmp_path)
    assert isinstance(contact.adhesion, PatchRepulsion)
    patch = contact.adhesion.patches[0]
    assert patch.grid.spacing[0] == approx(0.15e-6)
    assert np.hypot(contact.surface.height.std(), patch.height.std()) == approx(2e-9, rel=0.1)
    finer = given.refined(4).contact(tmp_path)
    assert finer.adhesion is None
    assert finer.surface.height.std() > 1.5 * contact.surface.height.std()
