"""Drake gives back the restitution that was exported."""

import re
from dataclasses import replace

import pytest

from restitution.dem.codes.drake import LOWEST, write
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError
from tolerance import approx

SCRIPT = "collision_drake.py"


@pytest.fixture
def drake(python_with):
    return python_with("pydrake", SCRIPT)


@pytest.mark.parametrize("V", [0.01, 10.0])
def test_equal_spheres_rebound_as_exported(equal, drake, texts, V):
    asked = equal.laws[1, 1].at(V).restitution
    assert drake.ratios(texts(write(equal, V))) == approx([asked], rel=1e-3)


def test_unlike_spheres_and_walls_rebound_as_exported(mixed, drake, texts):
    folder = texts(write(mixed, 0.5))
    for i, j, law in mixed.pairs():
        asked = law.at(0.5).restitution
        assert drake.ratios(folder, 0.5, i, j) == approx([asked], rel=1e-3), (i, j)


def test_the_file_says_what_e_is_at_half_and_twice_the_velocity(equal, drake, texts):
    files = write(equal, 0.5)
    said = re.search(r"# e = \S+, (\S+) at half and (\S+) at", files["restitution_drake.py"])
    folder = texts(files)
    assert drake.ratios(folder, 0.25) == approx([float(said[1])], rel=1e-3)
    assert drake.ratios(folder, 1.0) == approx([float(said[2])], rel=1e-3)


@pytest.mark.parametrize("e", [1.0, 0.99995, 0.99, LOWEST])
def test_restitution_is_reproduced_from_the_least_to_one(drake, law, constant, texts, e):
    folder = texts(write(pair_table([constant(law(), e)]), 1.0))
    assert drake.ratios(folder) == approx([e], rel=1e-3)


def test_small_spheres_rebound(drake, law, texts):
    sphere = replace(law().first, radius=1e-5)
    found = law(sphere, sphere)
    folder = texts(write(pair_table([found]), 1.0))
    assert drake.ratios(folder) == approx([found.at(1.0).restitution], rel=1e-3)


def test_a_discrete_plant_loses_what_the_file_says(law, constant, drake, texts):
    files = write(pair_table([constant(law(), 0.8)]), 1.0)
    assert "0.766 with 100" in " ".join(files["restitution_drake.txt"].split())
    script = files[SCRIPT].replace("time_step=0.0", "time_step=CONTACT[I, J] / 100")
    script = re.sub(r"ResetIntegrator.*\n.*fixed_step_mode.*\n", "", script)
    script = script.replace("    ResetIntegratorFromFlags, Simulator", "    Simulator")
    assert drake.ratios(texts(files | {SCRIPT: script})) == approx([0.766], rel=5e-3)


def test_names_and_titles_stay_in_their_comments(hostile, law, texts):
    bad = law(hostile, hostile, title='"""\n{x} quit(', warnings=('"""\nquit(',))
    for name, text in write(pair_table([bad]), 1.0).items():
        assert text.isascii()
        if name.endswith(".py"):
            compile(text, name, "exec")


def test_pairs_that_stick_are_refused(law, constant):
    with pytest.raises(CaseError, match=r"sticks \(e = 0\) at every computed velocity.*Drake"):
        write(pair_table([constant(law(), 0.0)]), 1.0)
