"""The command line says where no compiled kernels run."""

import json
import os
import subprocess
import sys

import pytest

from restitution.numerics.kernels import instruction_set


def call(*arguments, **environment):
    return subprocess.run(
        [sys.executable, "-m", "restitution", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        env=os.environ | environment,
    )


@pytest.fixture
def case(case_text, tmp_path):
    path = tmp_path / "case.toml"
    small = case_text.replace("steps = 4", "steps = 2").replace("curves = 2", "curves = 0")
    path.write_text("total_error = false\n" + small)
    return path


@pytest.mark.parametrize("more", ["", "\n[roughness]\nrealisations = 2\n"])
def test_a_run_without_compiled_kernels_says_so_once(case, tmp_path, more):
    case.write_text(case.read_text().replace("[roughness]\n", more or "[roughness]\n"))
    done = call("run", case, "-o", tmp_path / "out", RESTITUTION_KERNELS="numpy")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("Hint: NumPy replaces the compiled kernels") == 1
    assert "RESTITUTION_KERNELS is numpy; unset it" in done.stderr
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["kernels"] == "none"


@pytest.mark.skipif(instruction_set == "none", reason="built without a compiler")
def test_a_run_with_them_names_them_in_its_summary(case, tmp_path, cli):
    status, _, said = cli("run", case, "-o", tmp_path / "out")
    assert (status, "Hint" in said) == (0, False)
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["kernels"] == instruction_set


def test_the_version_says_why_there_are_none():
    hidden = (
        "import sys; sys.modules['restitution.numerics.loops'] = None; sys.argv[1:] = ['--version']"
        "; from restitution.cli import main; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", hidden],
        capture_output=True,
        text=True,
        timeout=300,
        env=os.environ | {"RESTITUTION_KERNELS": ""},
    )
    _, kernels, hint = done.stdout.splitlines()
    assert kernels == "compiled kernels: none"
    assert "not compiled when the package was installed; install with a C++ compiler" in hint


def test_kernels_that_do_not_exist_are_one_line(case, tmp_path):
    done = call("run", case, "-o", tmp_path / "out", RESTITUTION_KERNELS="sse9")
    assert done.returncode == 1
    assert done.stderr.startswith('Error: RESTITUTION_KERNELS: "sse9" is not known; unset it')
    assert done.stderr.count("\n") == 1
