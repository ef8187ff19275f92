"""Types of bodies by their values, and exports in which pairs of spheres have no law."""

import re
from dataclasses import replace

import pytest

from restitution.dem.codes import liggghts as to_liggghts
from restitution.dem.codes import yade as to_yade
from restitution.dem.export import ADHESIVE, CODES, export
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError
from tolerance import approx

ROLES = ("first", "second")


@pytest.fixture
def own(law):
    """Make the law of two bodies whose cases name no material."""
    glass = law().first
    bodies = {
        "a": replace(glass, yield_strength=2e7),
        "b": replace(glass, radius=0.5e-3, youngs_modulus=210e9, yield_strength=4e8),
        "wall": replace(glass, radius=None, youngs_modulus=3e9, density=None),
    }

    def make(pair, **changes):
        one, two = (
            replace(bodies[body], name=role) for body, role in zip(pair, ROLES, strict=True)
        )
        return law(one, replace(one, name="first") if pair[0] == pair[1] else two, **changes)

    return make


@pytest.mark.parametrize("code", [code for code in CODES if code not in ADHESIVE])
@pytest.mark.parametrize("more", [[], ["ba"]], ids=["three laws", "both orders"])
def test_two_materials_with_own_values_are_exported(own, code, more):
    files = export([own(pair) for pair in ["aa", "ab", *more, "bb"]], code, 1.0)
    assert files


def test_every_law_added_lowers_the_count_of_missing_ones(own):
    missing = []
    for pairs in (["ab"], ["ab", "aa"], ["ab", "aa", "bb"]):
        missing.append(len(pair_table([own(pair) for pair in pairs]).missing_spheres()))
    assert missing == [2, 1, 0]


def test_unknown_values_and_units_make_no_other_type(own):
    aa, ab, bb = own("aa"), own("ab"), own("bb")
    rounded = replace(ab.first, radius=ab.first.radius * (1 + 1e-15), yield_strength=None)
    table = pair_table([aa, replace(ab, first=rounded), bb])
    assert [body.yield_strength for body in table.spheres] == [2e7, 4e8]
    named = replace(aa.first, name="aluminium")
    table = pair_table([replace(aa, first=named, second=named), ab, bb])
    assert [body.name for body in table.spheres] == ["aluminium", "sphere, E = 210 GPa"]
    wall = own(("a", "wall"))
    heavy = replace(wall.second, density=7800.0)
    assert len(pair_table([wall, replace(own(("b", "wall")), second=heavy)]).walls) == 1


def test_bodies_that_differ_only_in_strength_or_name_stay_apart(own):
    ab = own("ab")
    hard = replace(ab.first, yield_strength=9e8)
    assert len(pair_table([own("aa"), replace(ab, first=hard)]).spheres) == 3
    names = [replace(ab.first, name=name) for name in ("rough", "smooth")]
    assert len(pair_table([replace(ab, first=names[0]), replace(ab, first=names[1])]).spheres) == 3


def test_a_body_that_may_be_either_of_two_types_is_refused(own):
    aa = own("aa")
    laws = [
        replace(aa, first=replace(aa.first, yield_strength=Y), second=aa.second.__class__(
            **{**vars(aa.second), "yield_strength": Y}))
        for Y in (2e7, 9e8)
    ]  # fmt: skip
    unknown = replace(own("ab"), first=replace(aa.first, yield_strength=None))
    message = r"R = 1 mm.*of both .*Y 20 MPa and .*Y 900 MPa; write the material, yield_strength"
    with pytest.raises(CaseError, match=message):
        pair_table([*laws, unknown])


def test_different_laws_of_one_pair_are_refused(own):
    with pytest.raises(CaseError, match=r"two laws are given for sphere, E = 70 GPa \(R = 1 mm\)"):
        pair_table([own("ab"), own("ba", at=2.0)])


def test_two_equal_spheres_with_own_tables_get_a_fitted_mdr(own):
    from restitution.dem.fits import fitted_laws

    aa = own("aa")
    twice = replace(aa, second=replace(aa.second, name="second"), yield_pressure=560e6)
    assert "lammps-mdr" in [fit.name for fit in fitted_laws(twice)]


def test_a_wall_alone_runs_in_liggghts_and_needs_e_of_the_spheres(on_wall, liggghts, texts):
    files = to_liggghts.write(on_wall, 1.0)
    folder = texts(files)
    asked = on_wall.laws[1, 2].at(1.0).restitution
    assert liggghts.pair(folder, 1, 2) == approx(asked, rel=5e-4)
    assert re.search(
        r"No law is given for the pair 1 1, whose spheres.*", files["restitution.liggghts"]
    )
    script = re.sub(r"variable e_1_1 .*\n", "", files["collision.in.liggghts"])
    (folder / "collision.in.liggghts").write_text(script)
    liggghts.says(folder, "-var", "I", 1, "-var", "J", 2, status=1)  # stops: e_1_1 is not defined


def test_a_wall_alone_runs_in_yade_and_needs_e_of_the_spheres(on_wall, yade, texts):
    files = to_yade.write(on_wall, 1.0)
    folder = texts(files)
    asked = on_wall.laws[1, 2].at(1.0).restitution
    assert yade.ratios(folder, "collision_yade.py", 1.0, 1, 2) == approx([asked], rel=1e-3)
    assert yade.ratios(folder, "collision_yade.py", 1.0, 1, 2, "law") == approx([asked], rel=1e-3)
    script = re.sub(r", dict.fromkeys\(.*?\)\)", ")", files["collision_yade.py"])
    assert script != files["collision_yade.py"]
    (folder / "collision_yade.py").write_text(script)
    said = yade.says(folder, "collision_yade.py", 1.0, 1, 2, status=1)
    assert "no law for types 1 and 1: give e in `others`" in said


def test_the_command_names_the_pairs_without_a_law(law, cli, tmp_path):
    from restitution.laws.law_files import write_law

    write_law(law(second=replace(law().first, name="plate", radius=None)), tmp_path / "law")
    for code in ("liggghts", "yade", "mercurydpm"):
        status, said, _ = cli(
            "export", tmp_path / "law", "--to", code, "--velocity", "1 m/s", "-o", tmp_path / code
        )
        assert status == 0
        assert "No law is given for the pair 1 1, whose spheres can touch, and" in said
