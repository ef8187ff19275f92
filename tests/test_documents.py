"""Every example a reader is shown does what the text beside it says."""

import ast
import json
import pkgutil
import re
import subprocess
import tomllib
from inspect import ismodule
from pathlib import Path
from typing import get_args

import pytest

from document_blocks import blocks, check_fragment, run_page, same_text
from restitution import theory
from restitution.cli.verbs import program
from restitution.errors import CaseError
from tolerance import approx

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


# Blocks that are not run, by page and first line, and why.
NOT_RUN = {
    ("README.md", 'pip install ".[app,measured]"'): "the page waits for Ctrl-C",
    ("docs/app.md", 'pip install ".[app]"'): "the page waits for Ctrl-C",
    ("README.md", "pip install ."): "installs the package",
    ("CONTRIBUTING.md", "make help"): "each target takes minutes",
    ("docs/index.md", "cd restitution"): "installs the package",
    ("docs/tutorials/cluster.md", "dask scheduler --port 8786"): "needs the machines of a cluster",
    ("docs/tutorials/cluster.md", "#!/bin/bash"): "needs Slurm",
    ("docs/developers/recipes.md", "python tests/document_blocks.py docs/developers/recipes.md"): (
        "changes this page"
    ),
    ("docs/dem.md", "python match_velocity.py --wall 2 z 0.0 -- lmp -in my.in"): (
        "needs a simulation of its own"
    ),
    ("docs/any-code.md", "restitution export law --to c -o contact"): (
        "needs the law of another page"
    ),
    ("docs/any-code.md", "cc -O2 collide.c -lm && ./a.out"): "compiles the exported file",
    (
        "docs/other-codes.md",
        "sh evidence/codes/in_own_environment.sh evidence/codes/in_rapier.mjs",
    ): "installs packages",
    ("docs/mixture.md", "restitution mixture mixture.toml -o powders"): "takes minutes",
    (
        "docs/tutorials/sticking.md",
        'restitution new --powder --set material=silica --set radius="5 um" --set rms="10 nm" '
        "-o powder.toml",
    ): "takes minutes",
    ("docs/mixture.md", 'title = "Lactose and glass in a steel drum"'): "is no case",
    (
        "docs/fit.md",
        "restitution fit MEASURED.csv --case case.toml --free yield_strength,rms -o FIT",
    ): ("takes minutes"),
    ("docs/fit.md", "velocity_m_per_s,restitution,restitution_std"): "is a table",
}
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [path for path in PAGES if not {"_build", "auto_gallery"} & set(path.parts)]
RUN = [
    path
    for path in PAGES
    if path.name != "dem.md" or path.parent.name != "docs"  # has a test of its own
    if any(not one.not_run for one in blocks(path.read_text()))
]


def page_id(path):
    return path.relative_to(ROOT).as_posix()


@pytest.mark.programs
@pytest.mark.parametrize("path", RUN, ids=page_id)
def test_the_blocks_of_a_page_run_and_print_what_it_shows(path, tmp_path):
    for block, printed in run_page(path.read_text(), tmp_path):
        assert same_text(block.body, printed), f"line {block.line}: it prints\n{printed}"


def test_blocks_that_are_not_run_are_these():
    left_out = {
        (page_id(path), block.body.splitlines()[0].partition("  ")[0]): block.not_run
        for path in PAGES
        for block in blocks(path.read_text())
        if block.not_run
    }
    assert left_out == NOT_RUN


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("e = 0.56", "e = 0.57", True),
        ("e = 0.56", "e = 0.58", False),
        ("8 nodes", "9 nodes", False),
        ("0.097228433876019 m", "0.097228434159140 m", True),
        ("0.097228433876019 m", "0.097228833876019 m", False),
        ("1e-3 m", "2e-3 m", True),
        ("… nodes", "9 nodes", True),
        ("a\n…\nb", "a\nc\nd\nb", True),
        ("a\n…\nb", "a\nc\nd", False),
        ("a", "a\nb", False),
        (
            "3 convolutions, 4.9 s; largest residual 1e-8",
            "3 convolutions, 5 s; largest residual 2e-8",
            True,
        ),
    ],
)
def test_what_a_page_shows_is_compared_with_what_is_printed(shown, printed, same):
    assert same_text(shown, printed) is same


def test_a_fragment_of_a_case_that_is_wrong_is_found():
    with pytest.raises(CaseError):
        check_fragment("[grid]\nnods = 3\n")


def test_the_api_pages_name_every_public_object():
    import restitution

    pages = "\n".join(path.read_text() for path in (ROOT / "docs" / "api").glob("*.md"))
    named = set(re.findall(r"^\.\. auto\w+:: (?:restitution\.)?([\w.]+)", pages, re.MULTILINE))
    assert {name for name in restitution.__all__ if not ismodule(getattr(restitution, name))} <= (
        named | {"__version__"}
    )
    assert {f"theory.{name}" for name in theory.__all__} <= named


def test_every_page_is_in_a_table_of_contents():
    listed = {ROOT / "docs" / "index.md"}
    for path in PAGES:
        for entries in re.findall(r"```\{toctree\}\n(.*?)```", path.read_text(), re.DOTALL):
            listed |= {path.parent / one for one in entries.splitlines()}
            listed |= {path.parent / f"{one}.md" for one in entries.splitlines()}
    assert {path for path in PAGES if path.is_relative_to(ROOT / "docs")} <= listed


def test_every_folder_of_evidence_says_question_command_answer_and_date():
    folders = [path for path in (ROOT / "evidence").iterdir() if list(path.glob("*.*"))]
    for folder in folders:
        lines = (folder / "README.md").read_text(encoding="utf-8").splitlines()
        begins = [line.partition(":")[0] for line in lines]
        assert begins == ["* Question", "* Command", "* Answer", "* Date"], folder


def test_scripts_of_the_gallery_are_thirteen_with_a_title():
    scripts = sorted((ROOT / "docs" / "gallery").glob("*.py"))
    assert len(scripts) == 13
    for script in scripts:
        _, title, line = ast.get_docstring(ast.parse(script.read_text()), clean=False).split("\n")[
            :3
        ]
        assert set(line) == {"="}
        assert len(line) == len(title)


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


def misread_lines(text):
    """Lines of prose that MyST drops as comments (%), or makes items of a list (+)."""
    prose = re.sub(r"^ *```.*?^ *```|\$\$.*?\$\$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.findall(r"^ *%.*|(?<=\S\n) *\+ .*", prose, re.MULTILINE)


@pytest.mark.parametrize("path", [*PAGES, ROOT / "CHANGELOG.md"], ids=page_id)
def test_no_line_of_a_paragraph_is_a_comment_or_an_item(path):
    assert misread_lines(path.read_text()) == []


def test_lines_that_myst_misreads_are_found():
    assert misread_lines("Within 7\n%.\n\ng = K p\n  + h\n\n```\n% x\n```\n") == ["%.", "  + h"]


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

    names = set(keys(Case))
    assert {"from", "detrend", "rms", "plasticity"} <= names
    for key in names:
        assert f"`{key}`" in text or f"`[{key}]`" in text, key


def test_every_column_is_documented():
    from restitution.curve.oblique import MeanObliquePoint
    from restitution.curve.periodic import PeriodicPoint
    from restitution.curve.point import MeanPoint

    text = (ROOT / "docs" / "results.md").read_text()
    kinds = MeanPoint, MeanObliquePoint, PeriodicPoint
    for column in (header for kind in kinds for header in kind.columns()):
        assert f"`{column}`" in text


def test_make_targets_named_to_readers_exist():
    makefile = (ROOT / "Makefile").read_text()
    for document in ("README.md", "CONTRIBUTING.md"):
        for target in re.findall(r"^make (\w+)", (ROOT / document).read_text(), re.MULTILINE):
            assert f"\n{target}:" in makefile


def test_the_readme_says_what_to_run_first_and_what_it_writes():
    assert (ROOT / "examples" / "steel.toml").exists()
    assert "restitution run examples/steel.toml" in README
    for name in ("curve.csv", "unloading.csv", "summary.json", "results.nc"):
        assert f"`{name}`" in README


@pytest.mark.programs
def test_the_way_to_a_dem_code_gives_the_table_of_its_page(tmp_path):
    page = (ROOT / "docs" / "dem.md").read_text()
    for block, printed in run_page(page, tmp_path):
        assert same_text(block.body, printed), f"line {block.line}: it prints\n{printed}"
    for law in json.loads((tmp_path / "law" / "law.json").read_text())["laws"]:
        row = re.search(rf"^\| `{law['name']}` \| .* \| (.*) \| (.*) \|$", page, re.MULTILINE)
        assert [float(cell) for cell in row.groups()] == approx(
            [law["rms"], law["worst"]], abs=0.002
        )
    assert (tmp_path / "input" / "restitution.lmp").is_file()


# The CHANGELOG tells of names that are gone.
DOCUMENTS = [*PAGES, *ROOT.glob("benchmarks/*.md"), *ROOT.glob("evidence/*/*.md")]
FOLDERS = "src|tests|docs|examples|evidence|benchmarks"


def code(document):
    """What stands in a document as code, in blocks and within lines."""
    text = document.read_text()
    blocks = re.findall(r"```\w*\n(.*?)```", text, re.DOTALL)
    within = re.findall(r"`([^`]+)`", re.sub(r"```.*?```", "", text, flags=re.DOTALL))
    return [piece.replace("\n", " ") for piece in within] + blocks


@pytest.mark.parametrize("document", DOCUMENTS, ids=page_id)
def test_modules_and_commands_that_a_document_names_exist(document):
    text = "\n".join(code(document))
    for name in re.findall(r"\brestitution(?:\.[a-z_]\w*)+", text):
        if name.split(".")[1] not in {"csv", "liggghts", "lmp", "png"}:  # files of an export
            pkgutil.resolve_name(name)
    verbs = {command.callback.__name__.replace("_", "-") for command in program.registered_commands}
    for verb in re.findall(r"(?:^|/bin/)restitution ([a-z][a-z-]*)", text, re.MULTILINE):
        assert verb in verbs


@pytest.mark.parametrize("document", DOCUMENTS, ids=page_id)
def test_files_that_a_document_names_exist(document):
    text = document.read_text()
    for link in re.findall(r"\]\((?!https?:)([^)#]+)", text):
        if not link.startswith(("auto_gallery/", "../auto_gallery/")):  # made by `make docs`
            assert (document.parent / link).exists(), link
    for path in re.findall(rf"(?<![\w/.])(?:{FOLDERS})/[\w/-]+(?:\.\w+)?", text):
        if not path.startswith("docs/_build"):  # made by `make docs`
            assert (ROOT / path).exists() or (document.parent / path).exists(), path


def test_modules_of_the_rooms_are_those_that_the_design_names():
    text = (ROOT / "docs" / "design.md").read_text()
    package = ROOT / "src" / "restitution"
    for room, row in re.findall(r"^\| `(\w+)/` \| (.*) \|$", text, re.MULTILINE):
        names = {"errors", *(path.stem for path in (package / room).rglob("*"))}
        for name in re.findall(r"`([a-z_]+)`", row):
            assert name in names, f"{room}: {name}"
