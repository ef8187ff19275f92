"""A plugin of pytest for `sample.py`: record what each test executes, or run chosen tests only.

With `MUTATION_RECORD` it records the lines that each test executes, and writes the time and the
fixtures of each test to the file `MUTATION_TIMES`. The lines of a fixture that several tests share
belong to all of them. With `MUTATION_CHOSEN`, a file with a list of tests, only these run, in this
order. They may take `MUTATION_SECONDS` of processor time, so that a mutant that never ends is
killed however busy the machine is.
"""

from __future__ import annotations

import contextlib
import json
import os
import resource
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

_SECONDS: Counter[str] = Counter()
_FIXTURES: dict[str, list[str]] = {}
_RECORD = os.environ.get("MUTATION_RECORD")
_COVERAGE: Any = None
_CONTEXTS = [""]

if _RECORD:
    import coverage

    _COVERAGE = coverage.Coverage(
        data_file=_RECORD, include=[str(Path.cwd() / "src" / "*")], concurrency="thread"
    )
    _COVERAGE.start()


@contextlib.contextmanager
def _recorded_as(context: str) -> Iterator[None]:
    _CONTEXTS.append(context)
    if _COVERAGE is not None:
        _COVERAGE.switch_context(context)
    yield
    _CONTEXTS.pop()
    if _COVERAGE is not None:
        _COVERAGE.switch_context(_CONTEXTS[-1])


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Keep the chosen tests, in their order."""
    if "MUTATION_CHOSEN" not in os.environ:
        return
    chosen = json.loads(Path(os.environ["MUTATION_CHOSEN"]).read_text(encoding="utf-8"))
    place = {test: k for k, test in enumerate(chosen)}
    items[:] = sorted(
        (item for item in items if item.nodeid in place), key=lambda item: place[item.nodeid]
    )
    most = round(time.process_time()) + int(os.environ["MUTATION_SECONDS"])
    resource.setrlimit(resource.RLIMIT_CPU, (most, most))


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Record the lines that a test executes as its own."""
    with _recorded_as(item.nodeid):
        yield


@pytest.hookimpl(hookwrapper=True)
def pytest_fixture_setup(fixturedef: Any) -> Iterator[None]:
    """Record the lines of a fixture as those of all tests that use it."""
    shared = fixturedef.scope != "function"
    with _recorded_as(f"fixture {fixturedef.argname}" if shared else _CONTEXTS[-1]):
        yield


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Add the time of a test."""
    _SECONDS[report.nodeid] += report.duration


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Keep the names of the fixtures of a test."""
    _FIXTURES[item.nodeid] = list(getattr(item, "fixturenames", ()))


def pytest_sessionfinish() -> None:
    """Write what was recorded."""
    if _COVERAGE is not None:
        _COVERAGE.stop()
        _COVERAGE.save()
        stored = {"tests": _SECONDS, "fixtures": _FIXTURES}
        Path(os.environ["MUTATION_TIMES"]).write_text(json.dumps(stored), encoding="utf-8")
