"""What a mixture exports runs in LAMMPS: the packing as it stands, and collisions of its pairs."""

import itertools
import random
import re
import shutil
import subprocess
from dataclasses import replace

import pytest

from restitution.dem.export import export, write_export
from restitution.dem.pair_table import pair_table
from restitution.laws.law_files import read_laws
from tolerance import approx

pytestmark = pytest.mark.programs  # even those without LAMMPS need the laws of all pairs

VELOCITY = 0.3  # m/s
SPHERES = {1: 40, 2: 30, 3: 10, 4: 20}  # by type
STEPS = 100_000  # the lowest spheres reach the wall


@pytest.fixture(scope="module")
def laws(computed_mixture):
    return read_laws([computed_mixture])


@pytest.fixture(scope="module")
def lammps(laws, tmp_path_factory, lammps_environment):
    """Run an exported input file of the mixture with the given variables; return what is said."""
    lmp = shutil.which("lmp", path=lammps_environment["PATH"])
    if lmp is None:
        pytest.skip("lmp is not installed")
    folder = tmp_path_factory.mktemp("lammps")
    write_export(export(laws, "lammps", VELOCITY), folder)

    def says(name, **variables):
        words = [word for key, value in variables.items() for word in ("-var", key, str(value))]
        done = subprocess.run(
            [lmp, "-in", name, "-log", "none", *words],
            cwd=folder,
            env=lammps_environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr
        return done.stdout

    return says


def test_the_packing_runs_to_its_end_and_keeps_every_sphere(lammps):
    numbers = {f"number_{kind}": count for kind, count in SPHERES.items()}
    said = lammps("packing.in", steps=STEPS, **numbers)
    assert f"spheres = {sum(SPHERES.values())}" in said
    assert "ERROR" not in said
    words = re.findall(r"^\s+\d+\s+\d+\s+(\S+)\s*$", said, re.MULTILINE)
    energies = list(map(float, words))
    assert len(energies) == STEPS / 5000 + 1
    # Gravity adds little in this time: collisions alone lower the energy, and nothing raises it.
    assert any(after < before for before, after in itertools.pairwise(energies))
    assert max(energies) < 1.1 * energies[0]


def test_the_packing_has_the_fractions_of_the_sizes(laws):
    def counts(fractions):
        """The spheres of each type of the packing, for the fractions of the types."""

        def given(body):
            number = None if body.wall else types.index(body)
            return body if number is None else replace(body, number_fraction=fractions[number])

        types = pair_table(laws).spheres
        changed = [replace(law, first=given(law.first), second=given(law.second)) for law in laws]
        text = export(changed, "lammps", VELOCITY)["packing.in"]
        return [int(n) for n in re.findall(r"^variable number_\d+ index (\d+)", text, re.MULTILINE)]

    assert counts([None] * 4) == [125] * 4
    assert counts([0.5, 0.3, 0.2, 1.0]) == [125, 75, 50, 250]
    # Every type is there, and the spheres are 500 in all.
    assert counts([0.9998, 0.0001, 0.0001, 1.0]) == [248, 1, 1, 250]


def test_ten_random_pairs_collide_by_their_laws(lammps, laws):
    pairs = random.Random(27).sample(list(pair_table(laws).pairs()), 10)
    for i, j, law in pairs:
        said = lammps("collision.in", V=VELOCITY, I=i, J=j)
        (found,) = re.findall(r"^restitution = (\S+)", said, re.MULTILINE)
        assert float(found) == approx(law.at(VELOCITY).restitution, rel=0.01), law.pair
