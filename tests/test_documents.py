"""Every example a reader is shown does what the text beside it says."""

import json
import pkgutil
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from restitution.cli.app import app
from tolerance import approx

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def block(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_the_python_example_prints_what_the_readme_says():
    (code,) = block("python")
    printed = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.strip()
    assert f"It prints `{printed}`" in README


def test_the_case_file_of_the_readme_runs(cli, tmp_path):
    (text,) = block("toml")
    (tmp_path / "case.toml").write_text(text)
    x = np.linspace(0, 10e-6, 128)[:, None]
    y = x.T
    scan = 5e-9 * np.cos(4e6 * x) * np.cos(5e6 * y) - (x**2 + y**2) / (2 * 100e-6)
    np.save(tmp_path / "bead.npy", scan)
    status, said, warned = cli("run", tmp_path / "case.toml", "-o", tmp_path / "results")
    assert status == 0, warned
    assert "20 depths" in said


def test_the_version_is_the_same_wherever_it_stands():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    headings = re.findall(r"^## (.*)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert headings[0] == version


def test_make_help_lists_every_target():
    makefile = (ROOT / "Makefile").read_text()
    (targets,) = re.findall(r"^\.PHONY: (.*)", makefile, re.MULTILINE)
    listed = subprocess.run(
        ["make", "-s", "help"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    assert [line.split()[0] for line in listed.splitlines()] == targets.split()


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.toml")), ids=lambda p: p.name)
def test_bundled_examples_are_valid(cli, path):
    status, said, warned = cli("check", path)
    assert status == 0
    assert "The case is valid." in said
    assert not warned


def test_every_key_of_a_case_is_documented():
    from restitution.case.case import Case

    text = (ROOT / "docs" / "case-file.md").read_text()

    def keys(kind):
        for name, field in getattr(kind, "model_fields", {}).items():
            yield field.alias or name
            yield from keys(field.annotation)
        for part in get_args(kind):
            yield from keys(part)

    found = set(keys(Case))
    assert {"from", "detrend", "rms", "plasticity"} <= found
    for key in found:
        assert f"`{key}`" in text or f"`[{key}]`" in text, key


def test_every_column_is_documented():
    from restitution.results.schema import COLUMNS, SPREAD_COLUMNS

    text = (ROOT / "docs" / "results.md").read_text()
    for column in (*COLUMNS, *SPREAD_COLUMNS):
        assert f"`{column}`" in text


def test_make_targets_named_to_readers_exist():
    makefile = (ROOT / "Makefile").read_text()
    for document in ("README.md", "CONTRIBUTING.md"):
        for target in re.findall(r"^make (\w+)", (ROOT / document).read_text(), re.MULTILINE):
            assert f"\n{target}:" in makefile


def test_the_version_is_stated_once_everywhere():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f"version: {version}" in (ROOT / "CITATION.cff").read_text()
    assert f"## {version}" in (ROOT / "CHANGELOG.md").read_text()


def test_the_readme_says_what_to_run_first_and_what_it_writes():
    assert (ROOT / "examples" / "steel.toml").exists()
    assert ".venv/bin/restitution run examples/steel.toml" in README
    for name in ("curve.csv", "unloading.csv", "summary.json", "results.nc"):
        assert f"`{name}`" in README


def test_the_way_to_a_dem_code_is_as_its_page_says(cli, tmp_path, monkeypatch):
    page = (ROOT / "docs" / "dem.md").read_text()
    commands = re.findall(r"```sh\n(.*?)```", page, re.DOTALL)[0]
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    said = {}
    for line in commands.splitlines():
        program, *arguments = shlex.split(line, comments=True)
        assert program == "restitution"
        status, said[arguments[0]], _ = cli(*arguments)
        assert status == 0, line
    # What the page shows of it.
    for law in json.loads((tmp_path / "law" / "law.json").read_text())["laws"]:
        row = re.search(rf"^\| `{law['name']}` \| .* \| (.*) \| (.*) \|$", page, re.MULTILINE)
        assert [float(cell) for cell in row.groups()] == approx(
            [law["rms"], law["worst"]], abs=0.002
        )
    assert (tmp_path / "input" / "restitution.lmp").is_file()


# The CHANGELOG tells of names that are gone.
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
FOLDERS = "src|tests|docs|examples|validation|benchmarks"


def code(document):
    """What stands in a document as code, in blocks and within lines."""
    text = document.read_text()
    blocks = re.findall(r"```\w*\n(.*?)```", text, re.DOTALL)
    within = re.findall(r"`([^`]+)`", re.sub(r"```.*?```", "", text, flags=re.DOTALL))
    return [piece.replace("\n", " ") for piece in within] + blocks


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_modules_and_commands_that_a_document_names_exist(document):
    text = "\n".join(code(document))
    for name in re.findall(r"\brestitution(?:\.[a-z_]\w*)+", text):
        if name.split(".")[1] not in {"csv", "liggghts", "lmp", "png"}:  # files of an export
            pkgutil.resolve_name(name)
    verbs = {command.callback.__name__.replace("_", "-") for command in app.registered_commands}
    for verb in re.findall(r"(?:^|/bin/)restitution ([a-z][a-z-]*)", text, re.MULTILINE):
        assert verb in verbs


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_files_that_a_document_names_exist(document):
    text = document.read_text()
    for link in re.findall(r"\]\((?!https?:)([^)#]+)", text):
        assert (document.parent / link).exists(), link
    for path in re.findall(rf"(?<![\w/.])(?:{FOLDERS})/[\w/-]+(?:\.\w+)?", text):
        assert (ROOT / path).exists() or (document.parent / path).exists(), path


def test_modules_of_the_rooms_are_those_that_the_design_names():
    text = (ROOT / "docs" / "design.md").read_text()
    package = ROOT / "src" / "restitution"
    for room, row in re.findall(r"^\| `(\w+)/` \| (.*) \|$", text, re.MULTILINE):
        names = {"errors", *(path.stem for path in (package / room).rglob("*"))}
        for name in re.findall(r"`([a-z_]+)`", row):
            assert name in names, f"{room}: {name}"
