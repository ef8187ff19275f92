"""Docstrings of the public API state units and sources; arguments where names do not say them.

pydoclint compares the arguments, results and errors of docstrings that have such sections with the
code. A summary alone is enough where nothing in it needs a unit, or where the class, or the
docstring of its room, gives the units of the arguments. Units and sources are checked here.
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
from restitution.contact.jkr.approach import Approach
from restitution.contact.jkr.detachment import Detachment
from restitution.contact.models import Adhesion, Plasticity

PACKAGE = Path(rs.__file__).parent
MODELS = Plasticity, Adhesion, Approach, Detachment  # these document what their models override
NUMBER = re.compile(r"\b(float|Values|Array|NDArray|ArrayLike)\b")
UNIT = re.compile(
    r"\(([^()]*, )?(kg/m³|kg|m/s|m²|m³|m⁴|1/m|m|s|Pa|N/m|N·s/m|N|J/m²|J|W|Hz|rad/s|rad|°|1|"
    r"SI|any unit|nodes|cells|bytes)(,[^()]*)?\)|dimensionless|\bbool\b"
)


def _objects(owner: object, name: str) -> dict[str, object]:
    """`owner` and what is public inside it, by dotted name."""
    objects = {name: owner}
    if isinstance(owner, ModuleType):
        for part in owner.__all__:
            objects |= _objects(getattr(owner, part), f"{name}.{part}")
    elif inspect.isclass(owner) and not issubclass(owner, MODELS):
        for part, value in vars(owner).items():
            documented = inspect.isroutine(value) or hasattr(value, "__get__")
            if not part.startswith("_") and documented and getattr(value, "__doc__", None):
                objects[f"{name}.{part}"] = value
    return objects


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
            *("--skip-checking-short-docstrings=True", "--allow-init-docstring=True"),
            *sorted(filter(None, files)),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    violations: dict[tuple[str, str], list[str]] = {}
    file = ""
    for line in said.stderr.splitlines() + said.stdout.splitlines():
        if not line.startswith(" "):
            file = line.strip()
        elif (match := re.search(r"`([\w.]+)`", line)) and not _tolerated(line):
            violations.setdefault((file, match[1]), []).append(line.strip())
    return violations


def _tolerated(line: str) -> bool:
    """A function may also document the errors of functions that it calls."""
    if "DOC503" in line:
        documented, raised = re.findall(r"\[(.*?)\]", line)
        return set(raised.split(", ")) <= set(documented.split(", "))
    return (
        "DOC502" in line
        or "DOC601" in line
        or ("DOC603" in line and ("label" in line or "strengths" in line))
    )


@pytest.mark.parametrize("name", OURS)
def test_says_all_arguments_results_and_errors_or_none(name):
    value = _function(OURS[name])
    lines = _violations().get((inspect.getsourcefile(value), value.__qualname__), [])
    if isinstance(OURS[name], cached_property):  # pydoclint knows only `property` as a property
        lines = [line for line in lines if "DOC201" not in line]
    assert lines == []


def _described(documented: object) -> dict[str, str]:
    """What the docstring says of the arguments and attributes, by name."""
    parsed = docstring_parser.parse(inspect.getdoc(documented) or "", docstring_parser.Style.GOOGLE)
    return {part.arg_name: part.description or "" for part in [*parsed.params, *parsed.attrs]}


def _recurring(name: str) -> dict[str, str]:
    """Arguments that the class or room of the object describes once for all of its methods."""
    described: dict[str, str] = {}
    *rooms, _ = name.split(".")
    owner: object = rs
    for room in rooms:
        owner = getattr(owner, room)
        described |= dict(re.findall(r"^- `(\w+)`: (.+)$", inspect.getdoc(owner) or "", re.M))
        described |= _described(owner)
    return described


def _without_unit(value: object, recurring: dict[str, str]) -> list[str]:
    """Names of the numbers, arguments and result, whose unit is not stated."""
    parsed = docstring_parser.parse(inspect.getdoc(value) or "", docstring_parser.Style.GOOGLE)
    described = recurring | _described(value)
    kinds = dict(getattr(_function(value), "__annotations__", {}))
    result = kinds.pop("return", "")
    missing = [
        argument
        for argument, kind in kinds.items()
        if NUMBER.search(str(kind)) and not UNIT.search(described.get(argument, ""))
    ]
    said = parsed.returns.description if parsed.returns else parsed.short_description
    if NUMBER.search(str(result)) and not UNIT.search(said or ""):
        missing.append("return")
    return missing


@pytest.mark.parametrize("name", OURS)
def test_says_units(name):
    assert _without_unit(OURS[name], _recurring(name)) == []


def test_a_number_without_unit_is_missed():
    def speed(length: float, time: float) -> float:
        """Length by time."""
        return length / time

    assert _without_unit(speed, {"length": "distance (m)"}) == ["time", "return"]
    speed.__doc__ = "Speed (m/s)."
    assert _without_unit(speed, {"length": "distance (m)", "time": "duration (s)"}) == []


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
