"""The portable contact in C and Python has the e of its law at any time step, and never gains."""

import importlib.util
import math
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from contacts import plate_law, sticking_law
from restitution.dem.codes.c import write as to_c
from restitution.dem.codes.python import write as to_python
from restitution.dem.contact_table import contact_table
from restitution.dem.export import export
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError
from restitution.laws.from_results import bare_law
from tolerance import approx

pytestmark = pytest.mark.programs  # they compile what is exported

CASE = """
title = "Rough glass"
total_error = false
[first]
material = "glass"
radius = "300 um"
[interface]
yield_pressure = "300 MPa"
friction = 0.3
[roughness]
kind = "gaussian"
rms = "40 nm"
correlation_length = "8 um"
seed = 1
[grid]
nodes = 64
spacing = "0.8 um"
[impact]
from = "0.02 m/s"
to = "2 m/s"
steps = 7
[unloading]
curves = 7
"""
COMPILERS = {
    "gcc": ["gcc", "-std=c99"],
    "g++": ["g++", "-std=c++17", "-x", "c++"],
    "clang": ["clang", "-std=c99"],
    "clang++": ["clang++", "-std=c++17", "-x", "c++"],
}
STRICT = ["-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"]
STEPS = (20, 57, 1000)


@pytest.fixture(scope="session")
def rough_folder(tmp_path_factory):
    from restitution.case.case_file import parse_case
    from restitution.results.writer import ResultsFolder
    from restitution.runs.run import run_case

    folder = tmp_path_factory.mktemp("portable") / "rough"
    run_case(parse_case(CASE), CASE, folder.parent, ResultsFolder(folder))
    return folder


@pytest.fixture(scope="session")
def laws(law, rough_folder):
    """A dry rough pair, one with adhesion, and a sphere that yields on a plate."""
    small = replace(law().first, radius=5e-6, youngs_modulus=3e9, density=1050.0)
    plate = replace(law().first, name="plate", radius=None)
    return {
        "rough": bare_law(rough_folder),
        "adhesive": sticking_law(law, small),
        "plate": plate_law(law, law().first, plate),
    }


NAMES = ("rough", "adhesive", "plate")


def compiled(folder, source, compiler="gcc"):
    """The program made of `source` in `folder`; skips without the compiler."""
    command = COMPILERS[compiler]
    if shutil.which(command[0]) is None:
        pytest.skip(f"{command[0]} is not installed")
    program = folder / f"{Path(source).stem}-{compiler.replace('+', 'p')}"
    arguments = [*command, *STRICT, source, "-o", program, "-lm"]
    done = subprocess.run(arguments, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:3000]
    return program


def printed(program, *arguments, status=0):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    assert (done.returncode == 0) == (status == 0), done.stderr
    return dict(line.split(" = ") for line in done.stdout.splitlines()), done.stderr


def module(folder):
    spec = importlib.util.spec_from_file_location(
        "contact_of_a_law", folder / "restitution_contact.py"
    )
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


@pytest.mark.parametrize("compiler", COMPILERS)
def test_every_compiler_takes_the_header_and_its_self_test_passes(laws, texts, compiler):
    program = compiled(texts(to_c(pair_table([laws["adhesive"]]), None)), "collide.c", compiler)
    said, _ = printed(program)
    assert float(said["largest error of e"]) < 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_the_driver_rebounds_as_the_law_says_at_any_time_step(laws, texts, name):
    law = laws[name]
    program = compiled(texts(to_c(pair_table([law]), None)), "collide.c")
    i, j = (1, 1) if name != "plate" else (1, 2)
    for V in np.geomspace(law.lowest, law.highest, 20):
        e = law.at(V).restitution
        for steps in STEPS:
            said, _ = printed(program, f"{V:.12g}", i, j, steps)
            assert float(said["restitution"]) == approx(e, rel=0.005, abs=1e-9), (V, steps)


def test_the_driver_has_40_lines_of_code(laws):
    for write, name in ((to_c, "collide.c"), (to_python, "collide.py")):
        text = write(pair_table([laws["rough"]]), None)[name]
        lines = [line for line in text.splitlines() if line.strip() and line[0] not in '/#"']
        assert len(lines) <= 40, name


@pytest.mark.parametrize("name", NAMES)
def test_random_sequences_never_gain_energy(laws, texts, name):
    folder = texts(to_c(pair_table([laws[name]]), None))
    shutil.copy(Path(__file__).with_name("reapproach.c"), folder)
    done = subprocess.run(
        [compiled(folder, "reapproach.c"), "1500"], capture_output=True, text=True
    )
    ended, gain = done.stdout.split()
    assert int(ended) > 500
    assert float(gain) < 1e-12


def test_a_law_without_loss_never_gains(law, constant, texts):
    folder = texts(to_c(pair_table([constant(law(), 1.0)]), None))
    shutil.copy(Path(__file__).with_name("reapproach.c"), folder)
    done = subprocess.run(
        [compiled(folder, "reapproach.c"), "1500"], capture_output=True, text=True
    )
    assert float(done.stdout.split()[1]) < 1e-12


PATH = """
#include <stdio.h>
#include "restitution_contact.h"
int main(void)
{
    const restitution_pair *p = &restitution_pairs[0];
    const double normal[3] = {0.0, 0.6, 0.8};
    double x, rate, dt, slip[3], pull[3];
    restitution_contact c;
    memset(&c, 0, sizeof c);
    while (scanf("%lf %lf %lf %lf %lf %lf", &x, &rate, &dt, slip, slip + 1, slip + 2) == 6) {
        const double force = restitution_normal(p, &c, x, rate, dt);
        restitution_friction(p, &c, normal, slip, dt, pull);
        printf("%.17g %.17g %.17g %.17g\\n", force, pull[0], pull[1], pull[2]);
    }
    return 0;
}
"""


@pytest.mark.parametrize("name", NAMES)
def test_python_and_c_are_the_same_contact(laws, texts, name):
    """On a random path with separations, reversals and loads."""
    table = pair_table([laws[name]])
    folder = texts(to_c(table, None) | {"path.c": PATH}, "c")
    other = module(texts(to_python(table, None), "python"))
    (pair,) = other.PAIRS.values()
    rng = np.random.default_rng(3)
    x = np.cumsum(rng.normal(size=1500)) * 0.04 * pair.depth[-1]
    x = pair.depth[-1] * (0.9 * np.abs(np.sin(x / pair.depth[-1])) - 0.1)
    x *= np.linspace(0.2, 1.05, x.size)
    dt = 1e-8
    rate, slip = np.diff(x, prepend=x[0]) / dt, rng.normal(size=(x.size, 3))
    rows = np.column_stack([x, rate, np.full_like(x, dt), slip])
    text = "\n".join(" ".join(f"{value:.17g}" for value in row) for row in rows)
    program = compiled(folder, "path.c")
    done = subprocess.run([program], input=text, capture_output=True, text=True, check=True)
    expected = np.array([line.split() for line in done.stdout.splitlines()], dtype=float)
    contact, sliding = other.apart(1), other.standing(1)
    normals = np.array([[0.0], [0.6], [0.8]])
    results = []
    for at, speed, slide in zip(x, rate, slip, strict=True):
        force, contact = other.normal(pair, contact, np.array([at]), np.array([speed]), dt)
        pull, sliding = other.friction(pair, contact, sliding, normals, slide[:, None], dt)
        results.append([force[0], *pull[:, 0]])
    scale = np.abs(expected[:, 0]).max()
    assert np.abs(np.array(results)[:, 0] - expected[:, 0]).max() < 1e-9 * scale
    assert np.abs(np.array(results) - expected).max() < 1e-6 * scale


@pytest.mark.parametrize("name", NAMES)
def test_python_rebounds_many_contacts_at_once(laws, texts, name):
    law = laws[name]
    other = module(texts(to_python(pair_table([law]), None)))
    (pair,) = other.PAIRS.values()
    V = np.geomspace(law.lowest, law.highest, 20)
    for steps in (20, 57):
        assert other.collide(pair, V, steps) == approx(law.restitution(V), rel=0.005, abs=1e-9)


@pytest.mark.parametrize("library", ["jax", "numba"])
def test_other_libraries_compute_the_same(laws, texts, library):
    loaded = pytest.importorskip(library)
    other = module(texts(to_python(pair_table([laws["rough"]]), None)))
    (pair,) = other.PAIRS.values()
    if library == "jax":
        loaded.config.update("jax_enable_x64", True)
        functions = other.using(importlib.import_module("jax.numpy"))
        functions.normal = loaded.jit(functions.normal)
    else:
        functions = other.using(compiled=loaded.njit)
    V = np.array([0.05, 0.4])
    assert other.collide(pair, V, 25, functions) == approx(other.collide(pair, V, 25), rel=1e-9)


def test_coarse_grains_have_the_e_of_the_real_size(laws, texts):
    other = module(texts(to_python(pair_table([laws["rough"]]), None)))
    (pair,) = other.PAIRS.values()
    V = np.geomspace(0.03, 1.5, 5)
    assert other.collide(pair._replace(size=25.0), V, 30) == approx(other.collide(pair, V, 30))


def test_the_loading_and_the_unloading_curve_are_those_of_the_run(laws, rough_folder, texts):
    """Slow loading to a stored depth and back, beside the stored curves."""
    from restitution.impacts.stored_force import stored_force

    stored = stored_force(rough_folder)
    other = module(texts(to_python(pair_table([laws["rough"]]), None)))
    (pair,) = other.PAIRS.values()
    deepest = laws["rough"].points[4].indentation
    way = np.linspace(0, deepest, 801)[1:]
    forces, contact = [], other.apart(1)
    for x in np.append(way, way[::-1]):
        force, contact = other.normal(pair, contact, np.array([x]), np.array([1e-6]), 1e-12)
        forces.append(force[0])
    down, up = np.array(forces[:800]), np.array(forces[800:])[::-1]
    most = stored.loading(deepest)
    assert down == approx(np.array([stored.loading(x) for x in way]), abs=3e-3 * most)
    branch, end, _ = stored.branch(deepest)
    expected = np.array([branch(x) if x > end else 0.0 for x in way])
    assert np.abs(up - expected).max() < 0.06 * most
    assert np.trapezoid(up, way) == approx(np.trapezoid(expected, way), rel=0.01)


def test_a_pair_that_sticks_is_freed_by_more_than_its_pull_off_force(laws, texts):
    law = laws["adhesive"]
    other = module(texts(to_python(pair_table([law]), None)))
    (pair,) = other.PAIRS.values()
    pull, mass = law.points[0].pull_off_force, pair.mass
    dt = 2.87 * (mass**2 / (pair.radius * pair.modulus**2 * law.lowest)) ** 0.2 / 25

    def held(load):
        x, v, contact = np.array([-1e-12]), np.array([law.lowest]), other.apart(1)
        damped = pair._replace(settling=0.5)
        for n in range(3000):
            x = x + v * dt
            force, contact = other.normal(damped, contact, x, v, dt)
            v = v - (force + load * min(n / 2500, 1.0)) / mass * dt
        return bool(contact.branch[0])

    assert held(0.9 * pull)
    assert not held(1.1 * pull)


def test_bodies_that_overlap_from_the_beginning_are_pushed_apart(laws, texts):
    other = module(texts(to_python(pair_table([laws["rough"]]), None)))
    (pair,) = other.PAIRS.values()
    x, v, contact = np.array([0.3 * pair.depth[-1]]), np.zeros(1), other.apart(1)
    work = float(other.energy(pair, x)[0])
    for _ in range(1000):
        x = x + v * 4e-9
        force, contact = other.normal(pair, contact, x, v, 4e-9)
        v = v - force / pair.mass * 4e-9
    returned = 0.5 * pair.mass * v[0] ** 2
    assert contact.branch[0] == 0
    assert returned == approx(work - float(other.loss(pair, work)), rel=0.05)


@pytest.mark.parametrize("angle", [10, 20, 30, 60])
def test_oblique_impacts_of_elastic_spheres_rebound_as_computed(law, constant, texts, angle):
    """Full slip is exact; e_t of contacts that stick is within 0.03 of theory, as in LAMMPS."""
    base = constant(law(friction=0.15), 1.0)
    program = compiled(texts(to_c(pair_table([base]), None)), "collide.c")
    said, _ = printed(program, 1.0, 1, 1, 400, angle)
    expected = {10: 0.72, 20: 0.604, 30: 0.590, 60: 0.827}[angle]
    assert float(said["tangential restitution"]) == approx(expected, abs=0.03)


def test_outside_its_velocities_the_driver_warns(laws, texts):
    law = laws["plate"]
    program = compiled(texts(to_c(pair_table([law]), None)), "collide.c")
    said, warned = printed(program, 2 * law.highest, 1, 2)
    assert "outside the law" in warned
    assert 0 < float(said["restitution"]) <= law.points[-1].restitution * 1.01
    said, warned = printed(program, law.lowest / 2, 1, 2)
    assert "outside the law" in warned
    assert float(said["restitution"]) == approx(law.points[0].restitution, rel=0.01)
    _, refused = printed(program, 1.0, 2, 2, status=1)
    assert "no law for these types" in refused


def test_a_pair_below_its_velocities_loses_as_much_by_adhesion_as_above(laws, texts):
    other = module(texts(to_python(pair_table([laws["adhesive"]]), None)))
    (pair,) = other.PAIRS.values()
    work = pair.work[0]
    assert other.loss(pair, 0.1 * work) == approx(other.loss(pair, work))


def test_several_pairs_are_in_one_file(mixed, texts):
    files = to_c(mixed, None)
    program = compiled(texts(files), "collide.c")
    for i, j, law in mixed.pairs():
        said, _ = printed(program, 0.5, j, i, 50)
        assert float(said["restitution"]) == approx(law.at(0.5).restitution, rel=0.005)
    other = module(texts(to_python(mixed, None), "python"))
    assert list(other.PAIRS) == [(i, j) for i, j, _ in mixed.pairs()]
    assert other.collide(other.PAIRS[2, 3], np.array([0.5]), 20) == approx(
        [mixed.laws[2, 3].at(0.5).restitution], rel=0.005
    )


def test_no_velocity_is_needed_and_notes_say_what_holds(laws):
    for code in ("c", "python"):
        files = export([laws["adhesive"]], code, None)
        notes = " ".join(files[f"restitution_{code}.txt"].split())
        assert "at the computed velocities" in notes
        assert "hold at this velocity only" not in notes
        assert "does not keep the bodies in contact" not in notes
        (text,) = (t for n, t in files.items() if n.startswith("restitution_contact"))
        said = " ".join(re.sub("^ *(//|#)", "", text, flags=re.MULTILINE).split())
        assert "e is within 0.5 % of the law with 20 or more steps" in said


def test_a_law_whose_indentations_do_not_increase_is_refused(law):
    base = law()
    points = tuple(replace(point, indentation=1e-6) for point in base.points)
    with pytest.raises(CaseError, match=r"glass.* indentations of its law do not increase"):
        to_c(pair_table([replace(base, points=points)]), None)


def test_hostile_names_stay_in_comments(hostile, law, texts):
    bad = law(hostile, hostile, title="*/ int x;", warnings=('"""\n*/ quit(',))
    files = to_c(pair_table([bad]), None)
    assert all(text.isascii() for text in files.values())
    compiled(texts(files), "collide.c")
    for name, text in to_python(pair_table([bad]), None).items():
        assert text.isascii()
        if name.endswith(".py"):
            compile(text, name, "exec")


def test_the_table_interpolates_the_law(laws):
    for law in laws.values():
        table = contact_table(law)
        V = np.geomspace(law.lowest * 1.01, law.highest * 0.99, 50)
        work = 0.5 * law.mass * V**2
        e2 = 1 - np.interp(work, table.work, table.lost) / work
        assert np.sqrt(np.maximum(e2, 0)) == approx(law.restitution(V), rel=0.003, abs=1e-6)
        assert math.isclose(table.depth[-1], law.points[-1].indentation)
