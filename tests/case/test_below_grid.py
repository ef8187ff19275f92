"""Which waves of the roughness go into patches."""

import re

import numpy as np
import pytest

from restitution.case import below_grid
from restitution.case.below_grid import notice_of
from restitution.case.case_file import parse_case
from restitution.contact.patch.law import PatchAttraction, PatchRepulsion
from restitution.errors import CaseError, SurfaceError
from restitution.numerics import memory
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


def test_patches_larger_than_memory_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(memory, "available", lambda: 1e6)
    with pytest.raises(CaseError, match=r"^roughness.split: patches of 96 x 96 .* too large; use"):
        case().splitting(tmp_path)


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


def test_scales_that_do_not_separate_are_refused(tmp_path):
    with pytest.raises(CaseError, match=r"^roughness.shortest: .*beside the contact radius"):
        case(velocity="0.1 mm/s").contact(tmp_path)
    assert case().splitting(tmp_path) is not None
    assert notice_of(case(), tmp_path) is None


REMEDY = re.compile(
    r"set (?:grid\.)?(?P<key>spacing|split) to (?P<value>[\d.]+ \w+) or less, "
    r"or roughness\.shortest to (?P<shortest>[\d.]+ \w+) or more"
)


@pytest.mark.parametrize(
    "values",
    [
        {"shortest": "50 nm", "velocity": "0.1 mm/s"},
        {"shortest": "50 nm", "velocity": "0.1 mm/s", "more": 'below_grid = "patch"'},
        {
            "shortest": "50 nm",
            "velocity": "0.1 mm/s",
            "interface": 'work_of_adhesion = "0.05 J/m^2"',
        },
        {"more": 'split = "40 um"'},
        {"spacing": "0.62503 um", "more": 'split = "20 um"'},
    ],
)
def test_the_remedies_of_a_split_can_be_typed(tmp_path, values):
    with pytest.raises(CaseError) as refused:
        case(**values).splitting(tmp_path)
    remedy = REMEDY.search(str(refused.value))
    value = remedy["value"]
    typed = {"spacing": value} if remedy["key"] == "spacing" else {"more": f'split = "{value}"'}
    assert case(**{**values, **typed}).splitting(tmp_path) is not None
    without = {**values, "more": "", "shortest": remedy["shortest"]}
    assert case(**without).splitting(tmp_path) is None
    assert not isinstance(case(**without).surface(tmp_path), SplitSurface)


def test_a_split_without_patches_is_refused():
    with pytest.raises(CaseError, match=r"^roughness: split: belongs to below_grid = "):
        case(more='below_grid = "omit"\nsplit = "3 um"')


@pytest.mark.parametrize(
    ("first", "second", "key"),
    [
        ('below_grid = "omit"', 'below_grid = "patch"', "below_grid"),
        ('split = "2 um"', 'split = "3 um"', "split"),
        ("realisations = 2", "realisations = 3", "realisations"),
    ],
)
def test_tables_that_differ_are_refused(first, second, key):
    before, table, after = re.split(r"(?=\[roughness\])|(?=\[grid\])", CASE.format(**USUAL))
    tables = [table.replace("[roughness]", "[[roughness]]") + more for more in (first, second)]
    with pytest.raises(CaseError, match=rf"^roughness\.{key}: differs between the tables"):
        parse_case("\n".join([before, *tables, after]))


def test_adhesive_bodies_have_a_law_of_finite_range(tmp_path):
    adheres = 'work_of_adhesion = "0.05 J/m^2"'
    contact = case(interface=adheres).contact(tmp_path)
    assert isinstance(contact.adhesion, PatchAttraction)
    assert contact.adhesive
    assert (
        case(interface=adheres + '\nadhesion = "jkr"', shortest="2 um").splitting(tmp_path) is None
    )


def scan_of(folder, more="", velocity="0.02 m/s", seed=0, **values):
    """A case with white noise of Rq 2 nm as a scan."""
    rng = np.random.default_rng(seed)
    np.save(folder / "scan.npy", 2e-9 * rng.standard_normal((160, 160)))
    text = CASE.format(**{**USUAL, "velocity": velocity, **values})
    a, b = text.index("[roughness]"), text.index("[grid]")
    scan = '[roughness]\nkind = "measured"\nfile = "scan.npy"\nsize = "24 um"\n'
    return parse_case(f"{text[:a]}{scan}{more}\n{text[b:]}")


def test_a_scan_on_coarse_cells(tmp_path):
    assert scan_of(tmp_path, 'below_grid = "omit"').contact(tmp_path).adhesion is None
    given = scan_of(tmp_path)
    contact = given.contact(tmp_path)
    assert isinstance(contact.adhesion, PatchRepulsion)
    patch = contact.adhesion.patches[0]
    assert patch.grid.spacing[0] == approx(0.15e-6)
    assert np.hypot(contact.surface.height.std(), patch.height.std()) == approx(2e-9, rel=0.1)
    finer = given.refined(4).contact(tmp_path)
    assert finer.adhesion is None
    assert finer.surface.height.std() > 1.5 * contact.surface.height.std()


@pytest.mark.parametrize(
    "values",
    [
        {"velocity": "1 mm/s"},
        {"spacing": "0.2 um"},
        {"interface": 'work_of_adhesion = "0.05 J/m^2"'},
        {"interface": "", "more": 'extend = "mirror"\nsplit = "13 um"', "velocity": "10 m/s"},
    ],
)
def test_waves_of_a_scan_stay_out_where_they_do_not_matter(tmp_path, values):
    """A light contact, half an octave, adhesion; a split given all the same."""
    given = scan_of(tmp_path, **values)
    assert (given.splitting(tmp_path) is None) == ("more" not in values)


@pytest.mark.parametrize(("velocity", "matter"), [("0.5 m/s", True), ("0.02 m/s", False)])
def test_contacts_on_few_asperities_under_a_growing_bound_keep_waves_out(
    tmp_path, velocity, matter
):
    """Indentations are compared with the rms height, here 60 nm."""
    given = scan_of(tmp_path, velocity=velocity)
    np.save(tmp_path / "scan.npy", 30 * np.load(tmp_path / "scan.npy"))
    update = {"yield_pressure": None, "yield_strength": 1e9}
    growing = given.model_copy(update={"interface": given.interface.model_copy(update=update)})
    assert growing.yielding().model.grows
    assert given.splitting(tmp_path) is not None
    assert (growing.splitting(tmp_path) is not None) == matter


def test_patches_of_a_scan_that_take_long_are_not_the_default(tmp_path, monkeypatch):
    assert scan_of(tmp_path).splitting(tmp_path) is not None
    monkeypatch.setattr(below_grid, "_MOST_BY_DEFAULT", 20)
    assert scan_of(tmp_path).splitting(tmp_path) is None
    assert scan_of(tmp_path, 'below_grid = "patch"').splitting(tmp_path) is not None


def test_waves_of_a_scan_between_elastic_bodies_stay_out(tmp_path):
    elastic = scan_of(tmp_path).model_copy()
    text = elastic.interface.model_copy(update={"yield_pressure": float("inf")})
    elastic = elastic.model_copy(update={"interface": text})
    assert elastic.splitting(tmp_path) is None
    assert scan_of(tmp_path).splitting(tmp_path) is not None


def test_a_split_of_a_scan_asks_for_patches(tmp_path):
    law = scan_of(tmp_path, 'split = "2 um"').contact(tmp_path).adhesion
    assert law.wavelength == approx(2e-6)


def test_a_split_too_long_for_the_scan(tmp_path):
    with pytest.raises(CaseError, match=r"from a scan of 24 µm; set split to 11\.88 µm or less"):
        scan_of(tmp_path, 'split = "13 um"', "10 m/s").contact(tmp_path)
    assert scan_of(tmp_path, 'split = "11.88 um"', "10 m/s").splitting(tmp_path) is not None


def test_a_scan_that_is_replaced_has_other_patches(tmp_path):
    heights = []
    for seed in (0, 1):
        contact = scan_of(tmp_path, 'below_grid = "patch"', seed=seed).contact(tmp_path)
        heights.append(contact.adhesion.patches[0].height)
    assert not np.array_equal(*heights)


def test_patches_where_their_error_holds_too_rarely_are_said_once(tmp_path):
    """A bound that grows, and an indentation below the rms height."""
    grows = CASE.replace('yield_pressure = "3 GPa"', "")

    def notice(velocity, choice):
        values = {**USUAL, "shortest": "0.8 um", "more": choice, "velocity": velocity}
        return notice_of(parse_case(grows.format(**values)), tmp_path)

    deep, light = "0.2 m/s", "5 mm/s"
    asked = 'below_grid = "patch"'
    assert notice(deep, asked) is None
    assert "can be off by more than its error" in notice(light, asked)
    assert notice(light, "") is None
