"""LIGGGHTS reproduces the exported restitution."""

from dataclasses import replace

import pytest

from restitution.dem.codes.liggghts import LOWEST, write
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError
from tolerance import approx

VELOCITIES = (0.01, 0.07, 0.5, 2.0, 10.0)


@pytest.mark.parametrize("V", VELOCITIES)
def test_equal_spheres_rebound_as_exported(equal, liggghts, texts, V):
    asked = equal.laws[1, 1].at(V).restitution
    assert liggghts.pair(texts(write(equal, V)), 1, 1) == approx(asked, rel=5e-4)


@pytest.mark.parametrize("V", VELOCITIES)
def test_unlike_spheres_and_walls_rebound_as_exported(mixed, liggghts, texts, V):
    folder = texts(write(mixed, V))
    for i, j, law in mixed.pairs():
        asked = law.at(V).restitution
        assert liggghts.pair(folder, i, j) == approx(asked, rel=5e-4), (i, j)


@pytest.mark.parametrize("E", [1e6, 1e8, 1e9, 1e11])
def test_any_modulus_is_taken(liggghts, law, texts, E):
    sphere = replace(law().first, youngs_modulus=E)
    soft = law(sphere, sphere)
    said = write(pair_table([soft]), 0.1)["collision.in.liggghts"]
    assert ("hard_particles yes" in said) == (E > 1e9)
    asked = soft.at(0.1).restitution
    ratio = liggghts.pair(texts(write(pair_table([soft]), 0.1)), 1, 1)
    assert ratio == approx(asked, rel=5e-4)


def test_the_least_restitution_is_reproduced_and_less_is_refused(liggghts, law, constant, texts):
    table = pair_table([constant(law(), LOWEST)])
    assert liggghts.pair(texts(write(table, 1.0)), 1, 1) == approx(LOWEST, rel=2e-3)
    with pytest.raises(CaseError, match=r"has e = 0.05 at 1 m/s, but the export to LIGGGHTS"):
        write(pair_table([constant(law(), 0.05)]), 1.0)
    with pytest.raises(CaseError, match=r"sticks \(e = 0\) at every computed velocity"):
        write(pair_table([constant(law(), 0.0)]), 1.0)


def test_names_and_titles_stay_in_their_comments(hostile, liggghts, law, texts):
    bad = law(hostile, hostile, title="a &\nquit", warnings=("long " * 3000 + "&\nquit &",))
    files = write(pair_table([bad]), 1.0)
    assert max(len(line) for text in files.values() for line in text.splitlines()) < 120
    asked = bad.at(1.0).restitution
    assert liggghts.pair(texts(files), 1, 1) == approx(asked, rel=5e-4)


def test_warnings_are_carried_into_every_file(law):
    for text in write(pair_table([law(warnings=("the grid is coarse",))]), 1.0).values():
        assert "WARNING: pair 1 1: the grid is coarse" in text


def test_missing_pairs_are_named(mixed):
    laws = {(i, j): law for i, j, law in mixed.pairs()}
    without_spheres = [law for pair, law in laws.items() if pair != (1, 2)]
    with pytest.raises(CaseError, match=r"LIGGGHTS needs a separate law for every pair"):
        write(pair_table(without_spheres), 1.0)
    without_wall = [law for pair, law in laws.items() if pair != (2, 3)]
    with pytest.raises(CaseError, match=r"every sphere on every wall.*steel .* and plate"):
        write(pair_table(without_wall), 1.0)
