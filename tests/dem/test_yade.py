"""YADE reproduces the exported restitution, either constant or from the law."""

import json
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from restitution.dem.codes.yade import write
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError
from tolerance import approx

VELOCITIES = (0.01, 0.07, 0.5, 2.0, 10.0)
# YADE takes seconds to start, so run many exported collisions in one process.
DRIVER = """
import json, os, sys
for folder, *arguments in json.load(open("jobs.json")):
    os.chdir(folder)
    sys.path.insert(0, folder)
    sys.modules.pop("restitution_yade", None)
    sys.argv = ["collision_yade.py", *map(str, arguments)]
    exec(open("collision_yade.py").read(), {"__name__": "__main__"})
    sys.path.remove(folder)
"""


@pytest.fixture
def collide(yade, texts):
    """The rebound ratios of `jobs`, pairs of the folder and the arguments of a collision."""

    def run(jobs):
        jobs = [[str(folder), *arguments] for folder, *arguments in jobs]
        place = texts({"driver.py": DRIVER, "jobs.json": json.dumps(jobs)}, "driver")
        return yade.ratios(place, "driver.py")

    return run


def test_collisions_rebound_as_exported(equal, mixed, collide, texts):
    jobs, asked = [], []
    for name, table in (("equal", equal), ("mixed", mixed)):
        for V in VELOCITIES:
            folder = texts(write(table, V), f"{name}-{V}")
            jobs += [(folder, V, i, j) for i, j, _ in table.pairs()]
            asked += [law.at(V).restitution for _, _, law in table.pairs()]
    assert collide(jobs) == approx(asked, rel=1e-3)


def test_the_law_is_followed_at_every_velocity(mixed, collide, texts):
    folder = texts(write(mixed, 0.5))
    kinds = [(V, pair) for V in VELOCITIES for pair in ((1, 2), (1, 3))]
    asked = [mixed.laws[pair].at(V).restitution for V, pair in kinds]
    jobs = [(folder, V, *pair, "law") for V, pair in kinds]
    assert collide(jobs) == approx(asked, rel=1e-3)


def test_the_law_is_held_beyond_its_ends(equal, collide, texts):
    folder = texts(write(equal, 0.5))
    asked = [equal.laws[1, 1].at(V).restitution for V in (0.01, 10.0)]
    assert collide([(folder, V, 1, 1, "law") for V in (0.005, 20.0)]) == approx(asked, rel=1e-3)


def test_a_collision_runs_by_itself_with_what_was_exported(equal, yade, texts):
    folder = texts(write(equal, 0.5))
    asked = equal.laws[1, 1].at(0.5).restitution
    assert yade.ratios(folder, "collision_yade.py") == approx([asked], rel=1e-3)


@pytest.mark.parametrize("e", [1.0, 0.99, 0.9, 0.5, 0.1, 0.01])
def test_damping_returns_its_restitution(equal, e):
    """YADE's dimensionless x″ = −x^{3/2} − 2β(3x^½/2)^½ x′; contact ends at x″ = 0."""
    beta = module(equal)["damping"](e)

    def slope(_, y):
        x = max(y[0], 0.0)
        return [y[1], -(x**1.5) - 2 * beta * (1.5 * x**0.5) ** 0.5 * y[1]]

    def pull(t, y):
        return -slope(t, y)[1] if t > 1e-3 else 1.0

    pull.terminal, pull.direction = True, -1
    end = solve_ivp(slope, (0, 1e4), [0.0, 1.0], rtol=1e-10, atol=1e-13, events=pull)
    assert -end.y[1, -1] == approx(e, rel=2e-5)


def test_the_table_of_the_law_is_fine_enough_for_straight_lines(law):
    found = law()
    text = module(pair_table([found]))
    for V in np.geomspace(0.01, 10, 101):
        e = text["restitution"](text["LAWS"][1, 1], V)
        assert e == approx(found.at(V).restitution, abs=1e-3)


def test_names_and_titles_break_out_of_nothing(hostile, law):
    bad = law(hostile, hostile, title='"""\n{x} quit(', warnings=('"""\nquit(',))
    files = write(pair_table([bad]), 1.0)
    assert all(text.isascii() for text in files.values())
    for name in ("restitution_yade.py", "collision_yade.py"):
        compile(files[name], name, "exec")
    assert module(pair_table([bad]))["MATERIALS"][0][1:] == (7e10, 0.25, 2500)


def test_warnings_are_carried_into_every_file(law):
    for text in write(pair_table([law(warnings=("the grid is coarse",))]), 1.0).values():
        assert "WARNING: pair 1 1: the grid is coarse" in text


def test_pairs_that_stick_or_are_missing_are_refused(law, constant, mixed):
    with pytest.raises(CaseError, match=r"sticks \(e = 0\) at every computed velocity.*YADE"):
        write(pair_table([constant(law(), 0.0)]), 1.0)
    laws = {(i, j): found for i, j, found in mixed.pairs()}
    with pytest.raises(CaseError, match=r"YADE needs a separate law for every pair"):
        write(pair_table([found for pair, found in laws.items() if pair != (1, 1)]), 1.0)
    with pytest.raises(CaseError, match=r"YADE needs .* glass .* and plate"):
        write(pair_table([found for pair, found in laws.items() if pair != (1, 3)]), 1.0)


def test_beyond_the_law_it_warns_once_a_pair_or_raises(mixed):
    names = module(mixed)
    check = names["check"]
    for V in (0.01, 0.3, 10.0):
        check((1, 2), V)
    said = r"types 1 and 2 meet at 20 m/s, outside .* \(0.01 to 10 m/s\)"
    with pytest.warns(UserWarning, match=said):
        check((1, 2), 20.0)
    check((1, 2), 0.001)  # filterwarnings = error: a second warning would fail
    with pytest.warns(UserWarning, match="types 1 and 3 meet at 0.001 m/s"):
        check((1, 3), 0.001)
    with pytest.raises(ValueError, match=said):
        check((1, 2), 20.0, "raise")
    with pytest.raises(ValueError, match="beyond"):
        check((1, 2), 1.0, "ignore")


def test_a_run_beyond_the_law_is_told_once_or_stopped(equal, yade, texts):
    files = write(equal, 0.5)
    said = yade.says(texts(files), "collision_yade.py", 20.0, 1, 1, "law")
    assert said.count("UserWarning: types 1 and 1 meet at 20 m/s") == 1
    assert "restitution = 0.299" in said
    strict = files["collision_yade.py"].replace(".follow()", ".follow(beyond='raise')")
    files["collision_yade.py"] = strict
    said = yade.says(texts(files, "strict"), "collision_yade.py", 20.0, 1, 1, "law", status=1)
    assert "ValueError: types 1 and 1 meet at 20 m/s" in said


def test_a_wall_keeps_its_density(law):
    def densities(wall):
        table = pair_table([law(), law(law().first, wall)])
        return [row[3] for row in module(table)["MATERIALS"]]

    plate = replace(law().first, name="plate", radius=None, density=7850.0)
    assert densities(plate) == [2500.0, 7850.0]
    unknown = replace(plate, density=None)
    assert densities(unknown) == [2500.0, 1000.0]


def module(table):
    """The names of the exported module, imported with a stand-in for YADE."""
    stand_in = type(sys)("yade")
    for name in ("O", "FrictMat", "Ip2_FrictMat_FrictMat_MindlinPhys", "MatchMaker"):
        setattr(stand_in, name, None)
    names = {}
    saved = sys.modules.get("yade")
    sys.modules["yade"] = stand_in
    try:
        exec(write(table, 1.0)["restitution_yade.py"], names)
    finally:
        del sys.modules["yade"]
        if saved is not None:
            sys.modules["yade"] = saved
    return names
