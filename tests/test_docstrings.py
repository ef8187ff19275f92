"""Docstrings of the public API state arguments, units, results, errors and sources.

pydoclint compares arguments, results and errors with the code; units and sources are checked here.
"""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from functools import cache, cached_property
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import docstring_parser
import pytest

import restitution as rs

PACKAGE = Path(rs.__file__).parent
NUMBER = re.compile(r"\b(float|Values|Array|NDArray|ArrayLike)\b")
UNIT = re.compile(
    r"\(([^()]*, )?(kg/m³|kg|m/s|m²|m³|m⁴|1/m|m|s|Pa|N/m|N·s/m|N|J/m²|J|W|Hz|rad/s|rad|°|1|"
    r"SI|any unit|nodes|cells|bytes)(,[^()]*)?\)|dimensionless|\bbool\b"
)


def _objects(owner: object, name: str) -> dict[str, object]:
    """`owner` and what is public inside it, by dotted name."""
    found = {name: owner}
    if isinstance(owner, ModuleType):
        for part in owner.__all__:
            found |= _objects(getattr(owner, part), f"{name}.{part}")
    elif inspect.isclass(owner):
        for part, value in vars(owner).items():
            documented = inspect.isroutine(value) or hasattr(value, "__get__")
            if not part.startswith("_") and documented and getattr(value, "__doc__", None):
                found[f"{name}.{part}"] = value
    return found


PUBLIC = {
    name: value for part in rs.__all__ for name, value in _objects(getattr(rs, part), part).items()
}
OURS = {
    name: value
    for name, value in PUBLIC.items()
    if inspect.isclass(value)
    or inspect.isfunction(value)
    or isinstance(value, property | cached_property)
}


def _function(value: object) -> object:
    if isinstance(value, property):
        return value.fget
    return value.func if isinstance(value, cached_property) else value


@cache
def _violations() -> dict[tuple[str, str], list[str]]:
    """Violations that pydoclint finds, by file and by name of the object in it."""
    files = {inspect.getsourcefile(_function(value)) for value in OURS.values()}
    said = subprocess.run(
        [
            *(sys.executable, "-m", "pydoclint.main", "--quiet", "--style=google"),
            *("--arg-type-hints-in-docstring=False", "--check-return-types=False"),
            "--check-yield-types=False",
            *("--skip-checking-short-docstrings=False", "--allow-init-docstring=True"),
            *sorted(filter(None, files)),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    found: dict[tuple[str, str], list[str]] = {}
    file = ""
    for line in said.stderr.splitlines() + said.stdout.splitlines():
        if not line.startswith(" "):
            file = line.strip()
        elif (match := re.search(r"`([\w.]+)`", line)) and not _tolerated(line):
            found.setdefault((file, match[1]), []).append(line.strip())
    return found


def _tolerated(line: str) -> bool:
    """A function may also document the errors of functions that it calls."""
    if "DOC503" in line:
        documented, raised = re.findall(r"\[(.*?)\]", line)
        return set(raised.split(", ")) <= set(documented.split(", "))
    return "DOC502" in line


@pytest.mark.parametrize("name", OURS)
def test_says_arguments_results_and_errors(name):
    value = _function(OURS[name])
    found = _violations().get((inspect.getsourcefile(value), value.__qualname__), [])
    if isinstance(OURS[name], cached_property):  # pydoclint knows only `property` as a property
        found = [line for line in found if "DOC201" not in line]
    assert found == []


@pytest.mark.parametrize("name", OURS)
def test_says_units(name):
    value = OURS[name]
    parsed = docstring_parser.parse(inspect.getdoc(value) or "", docstring_parser.Style.GOOGLE)
    parts = [*parsed.params, *parsed.attrs]
    described = {part.arg_name: part.description or "" for part in parts}
    function = _function(value)
    kinds = dict(getattr(function, "__annotations__", {}))
    result = kinds.pop("return", "")
    missing = [
        argument
        for argument, kind in kinds.items()
        if NUMBER.search(str(kind)) and not UNIT.search(described.get(argument, ""))
    ]
    assert missing == []
    if NUMBER.search(str(result)):
        said = parsed.returns.description if parsed.returns else parsed.short_description
        assert UNIT.search(said or ""), "the result has no unit"


@pytest.mark.parametrize("name", OURS)
def test_napoleon_reads_no_description_as_a_type(name):
    """Napoleon takes the text before a colon, in the first line of a property, as its type."""
    lines = (inspect.getdoc(OURS[name]) or "").splitlines()
    firsts = [after for line, after in pairwise(lines) if line == "Returns:"]
    if isinstance(OURS[name], property | cached_property):
        firsts += lines[:1]
    assert not [line for line in firsts if re.search(r"(?<!:):(?!:)", line)]


@pytest.mark.parametrize(
    "name", [name for name in OURS if re.fullmatch(r"theory\.(?!ImpactLaw)\w+", name)]
)
def test_closed_forms_name_their_source(name):
    assert "Source:" in (inspect.getdoc(OURS[name]) or "")
