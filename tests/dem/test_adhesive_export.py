"""Adhesive variants of the exports: pull-off, sticking and e in LAMMPS, LIGGGHTS and YADE."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from contacts import sticking_law
from restitution.dem.codes.lammps_adhesive import write as to_lammps
from restitution.dem.codes.liggghts_adhesive import write as to_liggghts
from restitution.dem.codes.yade_adhesive import write as to_yade
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError
from tolerance import approx

WRITERS = {"lammps": to_lammps, "liggghts": to_liggghts}
# Several collisions in one process, because YADE takes seconds to start.
DRIVER = """
import json, sys
for job in json.load(open("jobs.json")):
    sys.argv = ["collision_yade.py", *map(str, job)]
    try:
        exec(open("collision_yade.py").read(), {"__name__": "__main__"})
    except SystemExit:
        pass
"""
SHARES = (1.3, 1.8, 3.0, 6.0, 15.0)  # impact velocities over the sticking velocity


@pytest.fixture(scope="module")
def sticky(law):
    """Spheres of 5 µm that stick below 93 mm/s, by JKR."""
    return sticking_law(law, replace(law().first, radius=5e-6, youngs_modulus=3e9, density=1050.0))


def stated(text):
    """Sticking velocity and largest difference of e, as a file states them."""
    said = " ".join(text.replace("#", " ").split())
    return (float(re.search(rf"{name} (\S+)", said)[1])
            for name in ("; sticks below", "is off by up to"))  # fmt: skip


@pytest.mark.parametrize("code", WRITERS)
def test_e_and_sticking_are_as_the_file_states(sticky, texts, code, request):
    program = request.getfixturevalue(code)
    files = WRITERS[code](pair_table([sticky]), 0.3)
    sticks_below, worst = stated(next(iter(files.values())))
    V_s = sticky.sticks_below
    assert sticks_below == approx(V_s, rel=0.1)
    assert worst < 0.11
    folder = texts(files)
    for share in SHARES:
        e = program.pair(folder, 1, 1, V=share * V_s)
        assert abs(e - sticky.at(share * V_s).restitution) < worst + 0.01, share
    assert program.pair(folder, 1, 1, V=0.94 * sticks_below) == 0
    assert program.pair(folder, 1, 1, V=1.06 * sticks_below) > 0


def test_lammps_has_the_pull_off_force(sticky, lammps, texts):
    files = to_lammps(pair_table([sticky]), 0.3)
    watch = "variable pull equal -fz[1]\nfix pull all ave/time 1 1 1 v_pull mode scalar file f.txt"
    files["collision.in"] = files["collision.in"].replace("fix move", f"{watch}\nfix move")
    folder = texts(files)
    lammps.pair(folder, 1, 1, V=1.02 * next(stated(files["restitution_adhesive.lmp"])))
    lines = (folder / "f.txt").read_text().splitlines()
    forces = [float(line.split()[1]) for line in lines if line[0] != "#"]
    # After the turn; on the approach damping adds to the jump into contact.
    tension = max(forces[int(np.argmin(forces)) :])
    assert tension == approx(sticky.points[-1].pull_off_force, rel=0.02)


def test_yade_follows_the_law_and_sticks(sticky, law, yade, texts):
    plate = replace(sticky.first, name="plate", radius=None)
    on_plate = sticking_law(law, sticky.first, second=plate)
    files = to_yade(pair_table([sticky, on_plate]), 0.3)
    said = " ".join(files["restitution_yade.py"].replace("#", " ").split())
    assert float(re.search(r"above, e is off by up to (\S+)\.", said)[1]) < 0.02
    jobs = [(V, 1, j) for j, found in ((1, sticky), (2, on_plate))
            for V in found.sticks_below * np.array([0.6, 0.97, *SHARES])]  # fmt: skip
    folder = texts(files | {"driver.py": DRIVER, "jobs.json": json.dumps(jobs)})
    e = yade.ratios(folder, "driver.py")
    asked = [(sticky, on_plate)[j - 1].at(V).restitution for V, _, j in jobs]
    assert asked[:2] == e[:2] == [0, 0]
    assert e == approx(asked, abs=0.012)


def test_yade_has_the_pull_off_force(sticky, yade, texts):
    files = to_yade(pair_table([sticky]), 0.3)
    force = sticky.points[-1].pull_off_force
    script = files["collision_yade.py"].replace(
        'print("restitution = 0.0")',
        'print("attraction = %g" % max(c.phys.adhesionForce for c in O.interactions))',
    )
    V = 0.8 * sticky.sticks_below
    said = yade.says(texts(files | {"collision_yade.py": script}), "collision_yade.py", V, 1, 1)
    assert float(re.search(r"attraction = (\S+)", said)[1]) == approx(force, rel=0.02)


@pytest.mark.parametrize("code", WRITERS)
def test_pairs_without_adhesion_keep_their_e(sticky, law, texts, code, request):
    program = request.getfixturevalue(code)
    small = sticky.first
    plate = replace(small, name="plate", radius=None, youngs_modulus=5e9)
    folder = texts(WRITERS[code](pair_table([sticky, law(small, plate)]), 0.3))
    e = program.pair(folder, 1, 2, V=0.3)
    assert e == approx(law(small, plate).at(0.3).restitution, rel=2e-3)


def test_notes_do_not_say_that_the_pull_off_force_is_missing(sticky):
    for write in WRITERS.values():
        *_, notes = write(pair_table([sticky]), 0.3).values()
        assert "not modelled" not in notes
        assert "pull-off force after an impact at 0.3 m/s" in " ".join(notes.split())


@pytest.mark.parametrize("code", WRITERS)
def test_laws_without_adhesion_are_sent_to_the_other_export(law, code):
    with pytest.raises(CaseError, match=f"none of these pairs has adhesion.*--to {code}$"):
        WRITERS[code](pair_table([law()]), 1.0)


def test_a_law_that_yields_is_fitted_with_its_misfit_stated(sticky):
    """e falls at high velocities, which damping does not."""
    points = tuple(
        replace(p, ratio=p.ratio * share, restitution=max(p.ratio * share, 0.0) ** 0.5)
        for p, share in zip(sticky.points, np.linspace(1.0, 0.3, 9).tolist(), strict=True)
    )
    for write in WRITERS.values():
        _, worst = stated(
            next(iter(write(pair_table([replace(sticky, points=points)]), 0.3).values()))
        )
        assert 0.05 < worst < 0.6


@pytest.mark.parametrize("code", WRITERS)
def test_a_law_that_sticks_at_every_velocity_is_said_to_stick(sticky, code):
    points = sticky.points[:2]
    assert all(point.ratio <= 0 for point in points)
    law = replace(sticky, points=points, sticks_below=None)
    (text, *_) = WRITERS[code](pair_table([law]), law.highest).values()
    said = " ".join(text.replace("#", " ").split())
    assert f"the law sticks up to {law.highest:.3g} m/s at least" in said
