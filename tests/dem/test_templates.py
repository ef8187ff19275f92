"""The templates of the exports: all are used, and the files are well-formed."""

import re
import shutil
import subprocess
import sys
from dataclasses import replace
from itertools import combinations_with_replacement
from pathlib import Path

import pytest

import restitution.dem
from restitution.dem.export import ADHESIVE, CODES, export

TEMPLATES = Path(restitution.dem.__file__).parent / "templates"
WITHOUT_TEMPLATES = ("csv", "edem")  # tables, written by the csv module
PARTS = ("mdr.lmp",)  # included by another template


@pytest.fixture(scope="module")
def exports(law, points, mixed, on_wall):
    """Every file of every code by name, for several tables of laws."""
    adhesive = law(work_of_adhesion=0.2, smooth_sticking_velocity=0.01)
    pulled = tuple(replace(point, pull_off_force=1e-5) for point in adhesive.points)
    adhesive = replace(adhesive, points=pulled)
    several = [found for _, _, found in mixed.pairs()]
    cases = {"fitted": [points], "adhesive": [adhesive], "mixed": several}
    found = {
        (case, code, name): text
        for case, laws in cases.items()
        for code in CODES
        if code not in ADHESIVE or case == "adhesive"
        for name, text in export(laws, code, 1.0).items()
    }
    of_wall = [each for _, _, each in on_wall.pairs()]
    return found | {
        ("wall", code, name): text
        for code in CODES
        if code not in ADHESIVE
        for name, text in export(of_wall, code, 1.0).items()
    }


def test_every_template_is_of_a_file_and_every_file_of_a_template(exports):
    files = {name for _, code, name in exports if code not in WITHOUT_TEMPLATES}
    assert {path.name for path in TEMPLATES.iterdir()} == {
        f"{name}.j2" for name in (*files, *PARTS) if not name.endswith(".txt")
    }


def test_nothing_is_left_to_fill_in(exports):
    for key, text in exports.items():
        assert text.endswith("\n"), key
        assert text.isascii() or key[1] == "csv", key
        for sign in ("{{", "}}", "{%", "%}", "{#", "None", "Undefined", "nan"):
            assert sign not in text or (sign == "nan" and key[1] == "csv"), (key, sign)
        for line in text.splitlines():
            assert line == line.rstrip(), (key, line)


@pytest.mark.parametrize("code", ["lammps", "liggghts"])
def test_quotes_are_closed_and_continued_lines_are_indented(exports, code):
    """Lines after a line that ends in & are indented, and no others."""
    for key, text in exports.items():
        if key[1] != code or key[2].endswith((".py", ".txt")):
            continue
        continued = False
        for line in text.splitlines():
            if line.startswith("#"):
                assert not continued, (key, line)
                continue
            assert line.startswith("  ") == continued, (key, line)
            assert line.count('"') % 2 == 0, (key, line)
            continued = line.endswith("&")
        assert not continued, key


def test_scripts_are_python(exports, texts):
    scripts = {
        f"{case}_{code}_{name}": text
        for (case, code, name), text in exports.items()
        if name.endswith(".py")
    }
    assert {name.split("_")[1] for name in scripts} == {
        "drake", "kratos", "lammps", "liggghts", "mujoco", "python", "yade", "yade-adhesive"
    }  # fmt: skip
    for name, text in scripts.items():
        compile(text, name, "exec")
    ruff = shutil.which("ruff", path=str(Path(sys.executable).parent)) or shutil.which("ruff")
    if ruff is None:
        pytest.skip("ruff is not installed")
    # Scripts for YADE import all names of yade.
    rules = ["--select", "E9,F,W", "--ignore", "F403,F405"]
    done = subprocess.run(
        [ruff, "check", "--isolated", "--no-cache", *rules, "."],
        cwd=texts(scripts),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout


@pytest.fixture(scope="module")
def mixture(law):
    """The laws of a mixture of four sizes and a wall; every law has the same warning."""
    ball = law().first
    sizes = [replace(ball, radius=1e-3 * 1.5**k) for k in range(4)]
    plate = replace(ball, name="plate", radius=None)
    pairs = [*combinations_with_replacement(sizes, 2), *((size, plate) for size in sizes)]
    return [law(one, two, warnings=(f"the grid is coarse at {k} depths",))
            for k, (one, two) in enumerate(pairs)]  # fmt: skip


@pytest.mark.parametrize("code", [code for code in CODES if code not in ("csv", *ADHESIVE)])
def test_commands_come_first_and_equal_warnings_once(mixture, code):
    for name, text in export(mixture, code, 1.0).items():
        assert text.count("WARNING:") == 1, name
        assert "WARNING: all pairs: the grid is coarse at 0 depths (with other" in text, name
        if name.endswith(".txt"):
            continue
        sign = "//" if name.endswith((".h", ".c")) else "#"
        lines = [line for line in _without_xml_comments(text).splitlines() if line.strip()]
        words = [line for line in lines if not line.lstrip().startswith(sign)]
        assert lines.index(words[0]) < 10, name
        if name.startswith("restitution") and code != "edem":
            assert len(words) > 0.5 * len(lines), name


def _without_xml_comments(text):
    return re.sub(r"<!--.*?-->", "#", text, flags=re.DOTALL) if "<mujoco" in text else text
