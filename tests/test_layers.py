"""Imports point up the list of rooms in docs/design.md only, and never in a circle."""

import ast
import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "restitution"
ROOMS = (
    "errors",
    "arguments",
    "display",
    "theory",
    "numerics",
    "surfaces",
    "contact",
    "collision",
    "curve",
    "repeated",
    "losses",
    "case",
    "results",
    "laws",
    "impacts",
    "compare",
    "runs",
    "sweeps",
    "mixtures",
    "fit",
    "dem",
    "api",
    "plots",
    "pages",
    "app",
    "reproduce",
    "cli",
    "__main__",
)
PHYSICS = {"theory", "numerics", "surfaces", "contact"}
FINDINGS = "contact.checks.findings"  # what the command line says of a contact
CASE_KEY = re.compile(r"\b(roughness|interface|indentation|load|unloading|sweep)\.\w|(^| )--[a-z]")
SOLVERS = {
    "solve",
    "step",
    "solve_at_force",
    "solve_at_velocity",
    "solve_batch",
    "loading_path",
    "unloading_path",
    "separate",
    "collide",
    "solve_pressure",
    "elastic_pressure",
}


def name_of(path):
    """The module in the file `path`, without the name of the package: "case.schema"."""
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts)


MODULES = {name_of(path): path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
del MODULES["__init__"]  # the names for Python users, from any room


def for_types(tree):
    """What is imported for type checkers alone, as a model is by the contact that it is part of."""
    blocks = (node for node in ast.walk(tree) if isinstance(node, ast.If))
    only = (block for block in blocks if ast.unparse(block.test) == "TYPE_CHECKING")
    return {id(node) for block in only for node in ast.walk(block)}


def imported(module, source):
    """Module and name of every import from this package, those in functions included."""
    tree = ast.parse(source)
    left_out = for_types(tree) if room(module) == "contact" else set()
    for node in ast.walk(tree):
        if id(node) in left_out:
            continue
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = f"restitution.{module}".split(".")[: -node.level] if node.level else []
            of = ".".join([*above, *filter(None, [node.module])])
            yield from ((of, alias.name) for alias in node.names)


def graph(modules):
    """The modules that each of `modules` (their sources by name) imports."""

    def one(of, name):
        inner = of.removeprefix("restitution").removeprefix(".")
        candidates = (f"{inner}.{name}".strip("."), inner, f"{inner}.__init__")
        return next(each for each in candidates if each in modules)

    return {
        module: {
            one(of, name)
            for of, name in imported(module, source)
            if of.split(".")[0] == "restitution"
        }
        for module, source in modules.items()
    }


def room(module):
    return module.split(".")[0]


def wrong_way(edges):
    """Imports of a room from one that is not above it in the list."""
    return [
        f"{module} imports {other}"
        for module, others in edges.items()
        for other in sorted(others)
        if room(module) != room(other) and ROOMS.index(room(other)) > ROOMS.index(room(module))
    ]


def test_imports_point_up_the_list_only():
    assert {room(module) for module in MODULES} == set(ROOMS)
    assert wrong_way(graph(MODULES)) == []


MODELS = ("plasticity", "jkr", "cohesive", "patch")
MODEL_NAMES = re.compile(
    r"Elastic|ConstantBound|ExpandingCavity|Truncated|JKRLimit|Cohesive|CrackClosure|PohrtPopov"
    r"|isinstance\(.*(State|Plasticity|Adhesion)\)|\.(adhesive|grows|bounds_solve|exact_work|"
    r"for_periodic|follows_path|by_energy|in_equilibrium|attracts|label)\b"
    r"|\.adhesion is (not )?None|\.adhesion or\b"
)


def branches(source):
    """Conditions that ask for the model of a contact, or for a property of it."""
    kinds = ast.If, ast.IfExp, ast.While
    tests = [node.test for node in ast.walk(ast.parse(source)) if isinstance(node, kinds)]
    tests += [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.BoolOp)]
    return [text for text in map(ast.unparse, tests) if MODEL_NAMES.search(text)]


def core():
    """The modules of contacts outside the rooms of the models, by name."""
    return {
        name: source
        for name, source in MODULES.items()
        if room(name) == "contact" and name.split(".")[1] not in MODELS
    }


def test_the_core_of_contacts_seldom_asks_for_the_model():
    count = {name: len(branches(source)) for name, source in core().items()}
    assert sum(count.values()) <= 15, count
    assert branches("if contact.adhesion is None: pass\nx = 1 if a.grows else 2") != []


def test_the_core_of_contacts_imports_no_model():
    """`Contact` alone knows the default, bodies that do not yield."""
    found = {
        (name, of)
        for name, source in core().items()
        for of, _ in imported(name, source)
        if of.split(".")[1:2] == ["contact"] and set(of.split(".")[2:3]) & set(MODELS)
    }
    assert found == {("contact.contact", "restitution.contact.plasticity.bound")}


def test_no_modules_import_each_other_in_a_circle():
    TopologicalSorter(graph(MODULES)).prepare()


def test_the_case_calls_no_solver():
    names = {
        name
        for module, source in MODULES.items()
        if room(module) == "case"
        for _, name in imported(module, source)
    }
    assert names.isdisjoint(SOLVERS)


def texts(source):
    """The strings in `source`, without docstrings."""
    tree = ast.parse(source)
    docstrings = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    constants = (node for node in ast.walk(tree) if isinstance(node, ast.Constant))
    yield from (
        node.value
        for node in constants
        if isinstance(node.value, str) and id(node) not in docstrings
    )


def test_messages_of_physics_name_arguments_not_keys_of_a_case_or_options():
    found = [
        f"{module}: {text}"
        for module, source in MODULES.items()
        if room(module) in PHYSICS and module != FINDINGS
        for text in texts(source)
        if CASE_KEY.search(text)
    ]
    assert found == []
    for text in ("roughness.rms: 1 m", "raise unloading.curves", "or use --device cpu"):
        assert CASE_KEY.search(text)


def test_the_design_names_the_rooms_in_this_order():
    text = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    named = re.findall(r"^\| `(\w+)(?:/|\.py)` \|", text, flags=re.MULTILINE)
    assert named == [name for name in ROOMS if name != "__main__"]


@pytest.mark.parametrize(
    "line",
    [
        "from restitution.case.case import Case",
        "import restitution.case.case",
        "from restitution.case import case",
        "from ..case import case",
        "def late():\n    from restitution.case.case import Case",
    ],
)
def test_an_import_down_the_list_and_a_circle_are_found(line):
    modules = {"contact.contact": line, "case.case": "from restitution.contact.contact import x"}
    assert wrong_way(graph(modules)) == ["contact.contact imports case.case"]
    with pytest.raises(CycleError):
        TopologicalSorter(graph(modules)).prepare()
