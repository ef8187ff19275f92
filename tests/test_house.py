"""The shape of the source: few parameters, frozen data."""

import ast
import tomllib
from pathlib import Path

import pytest

from restitution.curve.oblique import MeanObliquePoint
from restitution.curve.periodic import PeriodicPoint
from restitution.curve.point import MeanPoint

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "restitution"
SOURCES = {path: path.read_text(encoding="utf-8") for path in sorted(PACKAGE.rglob("*.py"))}


def functions(source):
    """The functions in `source`, methods and inner ones included."""
    kinds = ast.FunctionDef, ast.AsyncFunctionDef
    return [node for node in ast.walk(ast.parse(source)) if isinstance(node, kinds)]


def parameters(function):
    """How many parameters a function has, `self` and `cls` not counted."""
    given = function.args
    named = [each.arg for each in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    own = named[:1] in (["self"], ["cls"])
    return len(named) - own + (given.vararg is not None) + (given.kwarg is not None)


def test_no_function_has_more_than_8_parameters():
    found = {
        f"{path.relative_to(PACKAGE)}: {each.name}": parameters(each)
        for path, source in SOURCES.items()
        for each in functions(source)
    }
    assert {name: count for name, count in found.items() if count > 8} == {}


def changeable(source):
    """The dataclasses in `source` that are not frozen."""
    return [
        node.name
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.ClassDef)
        for each in map(ast.unparse, node.decorator_list)
        if each.startswith("dataclass") and "frozen=True" not in each
    ]


def test_dataclasses_are_frozen():
    """All but those that hold the progress of a run, study or search."""
    found = {name for source in SOURCES.values() for name in changeable(source)}
    assert found == {"Tally", "RunLog", "_Run", "CaseModel"}


def test_rows_are_looked_up_by_header_in_the_room_of_results():
    """Elsewhere a row is a point with typed fields."""
    columns = MeanPoint.columns() | MeanObliquePoint.columns() | PeriodicPoint.columns()
    variables = {column.variable for column in columns.values()}
    headers = [header for header in columns if header not in variables]
    assert {"max_indentation_m", "force_N"} <= set(headers)
    lookups = {
        str(path.relative_to(PACKAGE)): count
        for path, source in SOURCES.items()
        if path.parent.name != "results"
        and (count := sum(source.count(f'["{header}"]') for header in headers))
    }
    assert sum(lookups.values()) <= 15, lookups


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ("def f(): pass", 0),
        ("def f(a, /, b, *, c=1): pass", 3),
        ("def f(a, *b, **c): pass", 3),
        ("class C:\n    def f(self, a): pass", 1),
        ("async def f(a, b): pass", 2),
    ],
)
def test_parameters_are_counted(source, count):
    (function,) = functions(source)
    assert parameters(function) == count


def test_every_error_bar_of_the_mutation_tests_stands_once_in_the_source():
    """Otherwise `make mutation` would stop at it, or test nothing."""
    folder = ROOT / "evidence" / "mutation"
    tree = ast.parse((folder / "error_bars.py").read_text())
    (tests,) = (
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and node.targets[0].id == "TESTS"
    )
    bars = tomllib.loads((folder / "bars.toml").read_text())
    for name, bar in bars.items():
        text = (ROOT / "src" / "restitution" / bar["file"]).read_text()
        assert text.count(bar["stands"]) == 1, name
        assert bar["file"] in tests, name
    named = {test for line in tests.values() for test in line.split()}
    assert all((ROOT / "tests" / test).is_file() for test in named)


def test_no_public_class_name_stands_twice():
    names = [
        node.name
        for source in SOURCES.values()
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    ]
    assert len(names) == len(set(names))
