"""Mutate random places of one room and count the mutants that its tests kill.

    python mutation/sample.py contact --mutants 60 --seed 7

needs cosmic-ray and coverage in the Python that runs it (`pip install cosmic-ray coverage`), and
`make test` once before. It works on a copy of the repository. First all tests of the room run once,
which shows the tests that execute each line and their times. Then each mutant runs only the tests
that execute its line, the shortest first. Each survivor is printed with its difference, and the
last line is the share that was killed. docs/mutation.md has the results so far, with a word on the
survivors.
"""

from __future__ import annotations

import argparse
import ast
import difflib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import coverage
from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names

HERE = Path(__file__).resolve().parents[1]
ROOMS = {
    "contact": "tests/contact tests/test_collision.py tests/runs/test_messages.py "
    "tests/test_house.py",
    "numerics": "tests/numerics tests/contact/test_equilibrium.py tests/contact/test_periodic.py "
    "tests/contact/test_threads.py tests/contact/test_device.py tests/test_house.py",
    "laws": "tests/laws tests/test_house.py",
}
BITS = ("BitOr", "BitAnd", "BitXor", "LShift", "RShift")


class Mutant(NamedTuple):
    """A place in a file and the operator that changes it."""

    file: str
    operator: str
    occurrence: int
    line: int


def main() -> None:
    """Draw, run and report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("room", choices=ROOMS)
    parser.add_argument("--mutants", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=60, help="start no mutant after these")
    parser.add_argument("--python", type=Path, default=HERE / ".venv" / "bin" / "python")
    options = parser.parse_args()
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        shutil.copytree(HERE, copy, ignore=shutil.ignore_patterns(".git", ".venv*", "demo"))
        mutants = sorted(every_mutant(copy, Path("src/restitution") / options.room))
        random.Random(options.seed).shuffle(mutants)
        drawn = mutants[: options.mutants]
        print(f"{len(drawn)} of {len(mutants)} mutants", flush=True)
        room = Room(copy, options.python, ROOMS[options.room].split())
        run = killed = 0
        for mutant in drawn:
            if time.monotonic() - begin > 60 * options.minutes:
                break
            outcome, difference = room.outcome(mutant)
            run, killed = run + 1, killed + (outcome == "killed")
            place = f"{mutant.file}:{mutant.line} {mutant.operator}"
            print(f"{outcome}: {place}", flush=True)
            if outcome != "killed":
                print(difference, flush=True)
    print(f"{killed} of {run} killed ({killed / max(run, 1):.0%})")


def every_mutant(copy: Path, room: Path) -> list[Mutant]:
    """All mutants of a room, without those whose outcome is known."""
    found = []
    for path in (copy / room).rglob("*.py"):
        lines = path.read_text(encoding="utf-8").splitlines()
        nodes = list(ast_nodes(get_ast_from_path(path)))
        for name in operator_names():
            kind = get_operator(name)
            if kind.arguments():
                continue
            places = (place for node in nodes for place in kind().mutation_positions(node))
            found += [
                Mutant(str(path.relative_to(copy)), name, k, row)
                for k, ((row, _), _) in enumerate(places)
                if not pointless(name, lines[row - 1])
            ]
    return found


def pointless(operator: str, line: str) -> bool:
    """Whether a mutation of `line` is known to change nothing, or known to be noticed.

    A mutated `|` is nearly always in a type hint, which is not evaluated. Arithmetic on floats that
    becomes a bit operation raises a TypeError at once. `strict` of `zip` guards against lengths
    that differ, which they never do. A `*` or `/` between commas marks keyword-only arguments.
    """
    if re.search(r"(^|[,(])\s*[*/]\s*,", line):
        return True
    if "ReplaceBinaryOperator" in operator:
        before, after = operator.split("_")[1:]
        return before == "BitOr" or (after in BITS and before not in BITS)
    return "ReplaceTrueWithFalse" in operator and "strict=True" in line


class Room:
    """The tests of a room: which of them execute each line, and how long they take."""

    def __init__(self, copy: Path, python: Path, tests: list[str]) -> None:
        self._copy, self._python = copy, python
        data, times = copy / "coverage.data", copy / "times.json"
        # Tests run in an environment of their own, which need not have `coverage`.
        (copy / "plugins").mkdir()
        (copy / "plugins" / "coverage").symlink_to(Path(coverage.__file__).parent)
        if self._pytest(tests, MUTATION_RECORD=str(data), MUTATION_TIMES=str(times)):
            raise SystemExit("the tests of the room fail without a mutant")
        self._stored = json.loads(times.read_text(encoding="utf-8"))
        self._data = coverage.CoverageData(basename=str(data))
        self._data.read()

    def outcome(self, mutant: Mutant) -> tuple[str, str]:
        """Whether the tests notice `mutant`, and its difference."""
        path = self._copy / mutant.file
        text = path.read_text(encoding="utf-8")
        changed = mutate_code(text, get_operator(mutant.operator)(), mutant.occurrence)
        assert changed is not None
        difference = "\n".join(
            difflib.unified_diff(text.split("\n"), changed.split("\n"), lineterm="", n=0)
        )
        chosen = self._tests_of(path, text, mutant.line)
        if not chosen:
            return "not executed", difference
        (self._copy / "chosen.json").write_text(json.dumps(chosen), encoding="utf-8")
        path.write_text(changed, encoding="utf-8")
        try:
            files = sorted({test.partition("::")[0] for test in chosen})
            seconds = sum(self._stored["tests"][test] for test in chosen)
            failed = self._pytest(
                files,
                MUTATION_CHOSEN=str(self._copy / "chosen.json"),
                MUTATION_SECONDS=str(60 + 3 * round(seconds)),
            )
        finally:
            path.write_text(text, encoding="utf-8")
        return "killed" if failed else "survived", difference

    def _tests_of(self, path: Path, text: str, line: int) -> list[str]:
        """The tests that execute the statement at `line`, the shortest first.

        All tests that execute a line of the function belong to its defaults and decorators, and all
        tests that execute a line of a function of the module belong to its constants.
        """
        contexts = self._data.contexts_by_lineno(str(path))
        lines = statement_lines(ast.parse(text), line)
        executed = {test for at in lines for test in contexts.get(at, ())}
        names = {name.removeprefix("fixture ") for name in executed if name.startswith("fixture ")}
        house = [test for test in self._stored["tests"] if test.startswith("tests/test_house.py")]
        chosen = {
            test
            for test, fixtures in self._stored["fixtures"].items()
            if test in executed or names & set(fixtures)
        }
        seconds = self._stored["tests"]
        return [*house, *sorted(chosen - set(house), key=lambda test: seconds.get(test, 0.0))]

    def _pytest(self, tests: list[str], **more: str) -> int:
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(
                str(self._copy / part) for part in ("src", "mutation", "plugins")
            ),
            "DUCC0_NUM_THREADS": "1",
            "PYTHONDONTWRITEBYTECODE": "1",
            **more,
        }
        command = [self._python, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
        ended = subprocess.run(
            [*command, "-p", "chosen_tests", *tests],
            cwd=self._copy,
            env=environment,
            capture_output="MUTATION_CHOSEN" in more,
            check=False,
        )
        return ended.returncode


def statement_lines(tree: ast.Module, line: int) -> set[int]:
    """Lines whose execution shows that the code at `line` has an effect."""
    functions = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.Lambda)]
    inside = [n for n in functions if body_of(n)[0].lineno <= line <= n.end_lineno]
    if not inside:
        heads = [
            n
            for n in functions
            if isinstance(n, ast.FunctionDef)
            and min([n.lineno, *(d.lineno for d in n.decorator_list)]) <= line < n.body[0].lineno
        ]
        return {
            at
            for n in heads or functions
            for at in range(body_of(n)[0].lineno, (n.end_lineno or 0) + 1)
        }
    statements = [
        n
        for n in ast.walk(tree)
        if isinstance(n, ast.stmt) and n.lineno <= line <= (n.end_lineno or 0)
    ]
    innermost = min(statements, key=lambda n: (n.end_lineno or 0) - n.lineno)
    body = getattr(innermost, "body", None)
    last = body[0].lineno - 1 if isinstance(body, list) else innermost.end_lineno or 0
    return set(range(innermost.lineno, max(last, innermost.lineno) + 1))


def body_of(function: ast.FunctionDef | ast.Lambda) -> list[ast.AST]:
    """The statements of a function, or the expression of a lambda."""
    return list(function.body) if isinstance(function, ast.FunctionDef) else [function.body]


if __name__ == "__main__":
    sys.exit(main())
