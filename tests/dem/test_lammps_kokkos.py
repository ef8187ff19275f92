"""The damping for KOKKOS returns its e, in LAMMPS without KOKKOS."""

import re

import pytest

from restitution.dem.codes.lammps import write
from restitution.dem.pair_table import pair_table
from tolerance import approx

NAME = "restitution_kokkos.lmp"
SAID = r"{} {}.* # e = (\S+), (\S+) at half and (\S+) at twice"


def with_kokkos(files):
    """The files, whose collision includes the fragment for KOKKOS."""
    script = files["collision.in"].replace("include restitution.lmp", f"include {NAME}")
    assert script != files["collision.in"]
    return files | {"collision.in": script}


def wall_names(files):
    return re.sub(r"variable wall_(\d)_(\d)", r"wall \1 \2", files[NAME])


@pytest.mark.parametrize("V", [0.02, 4.0])
def test_velocity_damping_returns_e_at_the_velocity_and_what_is_said_beside_it(
    mixed, lammps, texts, V
):
    files = with_kokkos(write(mixed, V))
    folder = texts(files)
    for i, j, law in mixed.pairs():
        said = [float(e) for e in re.search(SAID.format(i, j), wall_names(files)).groups()]
        ratios = [lammps.pair(folder, i, j, V=each) for each in (V, V / 2, 2 * V)]
        assert ratios[0] == approx(law.at(V).restitution, rel=1e-3), (i, j)
        assert ratios == approx(said, rel=2e-3), (i, j)


def test_an_elastic_pair_and_a_wall_alone(lammps, law, constant, on_wall, texts):
    elastic = with_kokkos(write(pair_table([constant(law(), 1.0)]), 1.0))
    assert lammps.pair(texts(elastic), 1, 1) == approx(1, rel=1e-6)
    files = with_kokkos(write(on_wall, 1.0))
    assert "pair_style" not in files[NAME]
    asked = on_wall.laws[1, 2].at(1.0).restitution
    assert lammps.pair(texts(files, "wall"), 1, 2) == approx(asked, rel=1e-3)


def test_linear_spring_returns_e_at_every_velocity(equal, lammps, texts):
    files = with_kokkos(write(equal, 0.5))
    text = files[NAME]
    style = re.search(r"^# (pair_style gran/hooke/history.*)$", text, re.MULTILINE)[1]
    text = re.sub("^pair_style granular$", style, text, flags=re.MULTILINE)
    text = re.sub("^pair_coeff 1 1 .*$", "pair_coeff * *", text, flags=re.MULTILINE)
    folder = texts(files | {NAME: text})
    asked = equal.laws[1, 1].at(0.5).restitution
    for V in (0.25, 0.5, 5.0):
        assert lammps.pair(folder, 1, 1, V=V) == approx(asked, rel=2e-3)


def test_several_types_get_no_linear_spring(mixed):
    assert "gran/hooke/history" not in write(mixed, 0.5)[NAME]
