"""A plugin of pytest: test files in the order of the time that they took, the shortest first.

`sample.py` uses it, so that a mutant is killed early by whatever kills it. A run without the file
that `MUTATION_TIMES` names writes that file; one with it may take three times as much time of the
processor, so that a mutant that never ends is killed however busy the machine is.
"""

from __future__ import annotations

import json
import os
import resource
import time
from collections import Counter
from pathlib import Path

import pytest

_SECONDS: Counter[str] = Counter()


def _file() -> Path:
    return Path(os.environ["MUTATION_TIMES"])


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort by file, so that fixtures of a file are made once."""
    if _file().exists():
        stored = json.loads(_file().read_text())
        items.sort(key=lambda item: stored["files"][item.nodeid.partition("::")[0]])
        most = 60 + 3 * round(stored["processor"])
        resource.setrlimit(resource.RLIMIT_CPU, (most, most))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Add the time of a test to that of its file."""
    _SECONDS[report.nodeid.partition("::")[0]] += report.duration


def pytest_sessionfinish() -> None:
    """Keep the times of the first run."""
    if not _file().exists():
        stored = {"files": _SECONDS, "processor": time.process_time()}
        _file().write_text(json.dumps(stored))
