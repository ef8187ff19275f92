"""The script that matches a constant e to the velocities in a simulation."""

import re
import shutil
import subprocess
import sys

import pytest

from restitution.dem.codes import lammps as lammps_code
from restitution.dem.codes import liggghts as liggghts_code
from restitution.dem.pair import contact_time
from restitution.dem.pair_table import pair_table
from tolerance import approx

COLUMNS = "id type x y z vx vy vz radius"
# 125 spheres with random velocities in a periodic box; no friction, so that all energy that is lost
# is lost to e.
GAS = """
units si
atom_style sphere
comm_modify vel yes
newton off
lattice sc {lattice}
region box block 0 5 0 5 0 5
create_box 1 box
create_atoms 1 box
set type 1 diameter {diameter} density {density}
include restitution.lmp
velocity all set 0 0 0 units box
variable vx atom {speed}*(2*random(0,1,7)-1)
velocity all set v_vx v_vx v_vx units box
variable vy atom {speed}*(2*random(0,1,8)-1)
variable vz atom {speed}*(2*random(0,1,9)-1)
velocity all set NULL v_vy v_vz units box
fix move all nve/sphere
timestep {step}
thermo 1000000
dump impacts all custom 8 impacts.dump {columns}
dump_modify impacts format float %.12g
run {steps}
"""


def match(folder, environment, *arguments, status=0):
    """What the script prints."""
    done = subprocess.run(
        [sys.executable, "match_velocity.py", *map(str, arguments)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert (done.returncode == 0) == (status == 0), done.stdout + done.stderr
    return done.stdout + done.stderr


def values(folder, name="matched.lmp"):
    """The matched e by types."""
    found = re.findall(r"^variable e_(\d)_(\d) index (\S+)$", (folder / name).read_text(), re.M)
    return {(int(i), int(j)): float(e) for i, j, e in found}


def with_dump(files, name):
    """The files, whose collision writes the dump."""
    dump = f"dump impacts all custom 100 impacts.dump {COLUMNS}\n"
    return files | {name: re.sub(r"(?m)^(timestep .*\n)", r"\1" + dump, files[name])}


@pytest.fixture
def script(mixed):
    """The names of the script."""
    names = {"__name__": "match_velocity"}
    exec(lammps_code.write(mixed, 0.5)["match_velocity.py"], names)
    return names


def test_the_e_of_a_collision_in_lammps_is_that_of_its_velocity(mixed, lammps, texts):
    folder = texts(with_dump(lammps_code.write(mixed, 0.5), "collision.in"))
    for i, j, wall in ((1, 2, ()), (2, 3, ("--wall", 3, "z", 0.0))):
        run = [*lammps.command, "-var", "V", 3.0, "-var", "I", i, "-var", "J", j]
        said = match(folder, lammps.environment, *wall, "--", *run)
        assert "1 collisions, mean 3 m/s" in said
        assert "fewer than 20 collisions" in said
        asked = mixed.laws[i, j].at(3.0).restitution
        assert values(folder)[i, j] == approx(asked, abs=1e-3)
        script = (folder / "collision.in").read_text()
        include = "include matched.lmp\ninclude restitution.lmp"
        (folder / "collision.in").write_text(script.replace("include restitution.lmp", include))
        assert lammps.pair(folder, i, j, V=3.0) == approx(asked, abs=1e-3)
        (folder / "collision.in").write_text(script)


def test_the_e_of_a_collision_in_liggghts_is_that_of_its_velocity(equal, liggghts, texts):
    folder = texts(with_dump(liggghts_code.write(equal, 0.5), "collision.in.liggghts"))
    match(folder, liggghts.environment, "--", *liggghts.command, "-var", "V", 3.0)
    asked = equal.laws[1, 1].at(3.0).restitution
    assert values(folder, "matched.liggghts") == {(1, 1): approx(asked, abs=1e-3)}


def test_the_energy_that_a_gas_loses_is_that_of_its_law(law, lammps, texts):
    found = law()
    R, speed = found.first.radius, 1.0
    gas = GAS.format(
        lattice=2.12 * R,
        diameter=2 * R,
        density=found.first.density,
        speed=speed,
        step=contact_time(found) / 40,
        steps=1500,
        columns=COLUMNS,
    )
    files = lammps_code.write(pair_table([found]), 5.0)
    files["restitution.lmp"] = files["restitution.lmp"].replace("NULL 1.0 0.5", "NULL 1.0 0.0")
    folder = texts(files | {"gas.in": gas})
    said = match(
        folder, lammps.environment, "--", lammps.command[0], "-in", "gas.in", "-log", "none"
    )
    (e,) = values(folder).values()
    assert "e still changes" not in said
    assert "fewer" not in said
    mean = float(re.findall(r"mean (\S+) m/s", said)[-1])
    assert 0.2 < mean < 1.5
    assert e == approx(found.at(mean).restitution, abs=0.05)
    # The dump itself: the energy of the last frame and of the first, against the law.
    names = {"__name__": "match_velocity"}
    exec((folder / "match_velocity.py").read_text(), names)
    bodies = [frame for _, frame in names["frames"](folder / "impacts.dump")]
    before, after = (
        sum(v * v for body in frame.values() for v in body[3]) * found.mass
        for frame in (bodies[0], bodies[-1])
    )  # ½ m v² with m = 2 m*
    velocities = names["impacts"](folder / "impacts.dump", [])[1, 1]
    lost = sum(
        (1 - found.at(max(V, found.lowest)).restitution ** 2) * found.mass * V**2 / 2
        for V in velocities
    )
    assert len(velocities) > 100
    assert before - after == approx(lost, rel=0.05)


def test_matched_e_dissipates_the_energy_of_the_law(script):
    law = script["LAWS"][1, 1]
    e = script["matched"](law, [0.02, 5.0])
    slow, fast = (script["restitution"](law, V) for V in (0.02, 5.0))
    assert e == approx(((0.02 * slow) ** 2 + (5 * fast) ** 2) ** 0.5 / (0.02**2 + 25) ** 0.5)
    assert script["matched"](law, [0.5]) == approx(script["restitution"](law, 0.5))


def test_velocities_beyond_the_law_are_named(script, capsys):
    script["adjust"]({(1, 1): 0.5}, {(1, 1): [0.001, 0.5, 20.0]})
    said = capsys.readouterr().out
    assert "warning: 2 of them are outside the velocities of the law (0.01 to 10 m/s)" in said


def test_contacts_are_found_over_the_borders_of_a_periodic_box(script):
    periods = [10.0, 0, 10.0]
    bodies = {
        1: (1, 1.0, [0.5, 0.0, 5.0], [-1.0, 0.0, 0.0]),
        2: (2, 1.0, [9.0, 0.0, 5.0], [1.0, 0.0, 0.0]),
        3: (1, 1.0, [5.0, 9.5, 5.0], [0.0, 0.0, 0.0]),
        4: (1, 1.0, [5.0, -0.5, 5.0], [0.0, 0.0, 0.0]),
    }
    walls = [(3, 1, -1.0)]
    found = script["touching"](bodies, periods, walls)
    assert found == {(1, 2), (4, -1)}
    assert script["closing"](bodies, (1, 2), periods, walls) == ((1, 2), approx(2.0))
    bodies[4] = (2, 1.0, [5.0, -0.5, 5.0], [0.0, -3.0, 0.0])
    assert script["closing"](bodies, (4, -1), periods, walls) == ((2, 3), approx(3.0))


def test_what_fails_is_said(equal, lammps_environment, texts):
    folder = texts(lammps_code.write(equal, 0.5))
    wrong = "import sys; print('a reason'); sys.exit(3)"
    said = match(folder, lammps_environment, "--", sys.executable, "-c", wrong, status=1)
    assert "a reason\nthe command ended with status 3" in said
    said = match(folder, lammps_environment, "--", shutil.which("true"), status=1)
    assert "impacts.dump: the command did not write it" in said
    lines = ["ITEM: NUMBER OF ATOMS", "1", "ITEM: BOX BOUNDS ff ff ff", *["0 1"] * 3]
    (folder / "short.dump").write_text("\n".join([*lines, "ITEM: ATOMS id type", "1 1"]))
    copy = "import shutil; shutil.copy('short.dump', 'impacts.dump')"
    said = match(folder, lammps_environment, "--", sys.executable, "-c", copy, status=1)
    assert "has id type, but needs id type radius x y z vx vy vz" in said
