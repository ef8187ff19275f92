"""LAMMPS reproduces the exported restitution."""

import re
from dataclasses import replace

import pytest

from restitution.dem.codes.lammps import LOWEST, write
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError, DomainError
from tolerance import approx

VELOCITIES = (0.01, 0.07, 0.5, 2.0, 10.0)


@pytest.mark.parametrize("V", VELOCITIES)
def test_equal_spheres_rebound_as_exported(equal, lammps, texts, V):
    asked = equal.laws[1, 1].at(V).restitution
    assert lammps.pair(texts(write(equal, V)), 1, 1) == approx(asked, rel=5e-4)


@pytest.mark.parametrize("V", VELOCITIES)
def test_unlike_spheres_and_walls_rebound_as_exported(mixed, lammps, texts, V):
    folder = texts(write(mixed, V))
    for i, j, law in mixed.pairs():
        asked = law.at(V).restitution
        assert lammps.pair(folder, i, j) == approx(asked, rel=5e-4), (i, j)


def test_sphere_on_a_wall_needs_no_law_between_spheres(on_wall, lammps, texts):
    files = write(on_wall, 1.0)
    assert "pair_style granular" not in files["restitution.lmp"]
    asked = on_wall.laws[1, 2].at(1.0).restitution
    assert lammps.pair(texts(files), 1, 2) == approx(asked, rel=5e-4)


def test_e_is_that_of_the_velocity_of_the_export_at_any_other(equal, lammps, texts):
    asked = equal.laws[1, 1].at(0.1).restitution
    assert lammps.pair(texts(write(equal, 0.1)), 1, 1, V=5.0) == approx(asked, rel=5e-4)


@pytest.mark.parametrize(("e", "rel"), [(1.0, 1e-6), (0.05, 1e-3), (LOWEST, 0.01)])
def test_restitution_is_reproduced_from_the_least_to_one(lammps, law, constant, texts, e, rel):
    table = pair_table([constant(law(), e)])
    assert lammps.pair(texts(write(table, 1.0)), 1, 1) == approx(e, rel=rel)


def test_contact_has_the_stiffness_of_the_law(lammps, mixed, constant, texts):
    """The maximum overlap of an elastic collision is Hertz's: δ = (15 m* V²/16 E* R*^½)^⅖."""
    elastic = pair_table([constant(found, 1.0) for _, _, found in mixed.pairs()])
    files = write(elastic, 1.0)
    deepest = "variable depth equal -v_gap\nfix deepest all ave/time 1 1 1 v_depth mode scalar"
    files["collision.in"] = files["collision.in"].replace(
        "fix move all nve/sphere", f"{deepest} file depth.txt\nfix move all nve/sphere"
    )
    folder = texts(files)
    for i, j, found in elastic.pairs():
        lammps.pair(folder, i, j)
        lines = (folder / "depth.txt").read_text().splitlines()
        depths = [line.split()[1] for line in lines if line[0] != "#"]
        hertz = (15 * found.mass / (16 * found.contact_modulus * found.radius**0.5)) ** 0.4
        assert max(map(float, depths)) == approx(hertz, rel=1e-4), (i, j)


def test_names_and_titles_stay_in_their_comments(hostile, lammps, law, texts):
    bad = law(hostile, hostile, title='a &\n"""\nquit 1', warnings=('too & \n"""quit 1 &',))
    files = write(pair_table([bad]), 1.0)
    assert all(text.isascii() for text in files.values())
    asked = bad.at(1.0).restitution
    assert lammps.pair(texts(files), 1, 1) == approx(asked, rel=5e-4)


def test_comments_tell_where_e_comes_from_and_how_far_to_trust_it(law):
    files = write(pair_table([law()]), 1.0)
    said = " ".join(files["restitution_lammps.txt"].split())
    assert "written by restitution" in said
    assert "e = 0.516667 +/- 0.004 at 1 m/s" in said
    assert "0.5819 at 0.5 m/s" in said
    assert "0.4515 at 2 m/s" in said
    assert "glass (R = 1 mm)" in said
    assert "R* = 0.0005 m, E* = 3.73333e+10 Pa" in said
    assert "yield pressure p_y: 1e+09 Pa; convention: mean pressure of a plastic contact" in said
    assert "end of contact assumed for e: the force is back to zero" in said
    assert "computed from 0.01 to 10 m/s" in said
    assert "End of a contact in LAMMPS: the overlap is back to zero" in said
    assert "Friction 0.5 is a placeholder" in files["restitution.lmp"]
    assert "restitution_lammps.txt" in files["restitution.lmp"]
    assert not any("WARNING" in text for text in files.values())


def test_velocities_beyond_the_law_are_not_named(law):
    said = write(pair_table([law()]), 10.0)["restitution_lammps.txt"]
    assert "at 5 m/s" in said
    assert "20 m/s" not in said


def test_warnings_are_carried_into_every_file(law):
    point = replace(law().points[0], resolved=False)
    found = law(warnings=("the grid is coarse",), work_of_adhesion=0.2)
    found = replace(found, points=(point, *found.points[1:]))
    files = write(pair_table([found]), 0.012)
    for name, text in files.items():
        sign = "" if name.endswith(".txt") else "# "
        assert re.search(f"^{sign}WARNING: unresolved at 0.012 m/s", text, re.MULTILINE)
        assert f"{sign}WARNING: pair 1 1: the grid is coarse" in text
    assert "pull-off force is not modelled" in " ".join(files["restitution_lammps.txt"].split())
    for text in write(pair_table([found]), 1.0).values():
        assert "unresolved" not in text


def test_pairs_that_stick_are_refused(law, constant):
    sticking = constant(law(sticks_below=0.3), 0.0)
    with pytest.raises(
        CaseError, match=r"sticks \(e = 0\) at every computed velocity.*LAMMPS.*0.001"
    ):
        write(pair_table([sticking]), 0.1)


def test_velocities_that_were_not_computed_are_refused(equal):
    with pytest.raises(DomainError, match="nothing is extrapolated"):
        write(equal, 20.0)


def test_missing_pairs_are_named(mixed):
    some = [law for i, j, law in mixed.pairs() if (i, j) != (1, 2)]
    named = r"LAMMPS needs a separate law for every pair.*glass.*steel"
    with pytest.raises(CaseError, match=named):
        write(pair_table(some), 1.0)
