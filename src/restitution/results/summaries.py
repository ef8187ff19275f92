"""Short descriptions of stored results, for `repr` and notebooks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from restitution.display import counted, quantity


def curve_lines(rows: Sequence[Mapping[str, float]]) -> list[str]:
    """Describe a curve by its number of rows and its first columns."""
    columns = f": {', '.join(list(rows[0])[:3])}, …" if rows else ""
    return [f"{counted(len(rows), 'row')}{columns}"]


def run_lines(
    folder: Path, rows: Sequence[Mapping[str, float]], summary: Mapping[str, Any]
) -> list[str]:
    """Describe a run in lines: title, status, number of warnings, deepest depth, range of COR."""
    depths = [row["max_indentation_m"] for row in rows]
    e = [row["restitution"] for row in rows]
    span = f" to {quantity(max(depths), 'm')}, COR {min(e):.4f} to {max(e):.4f}" if e else ""
    warned = counted(len(summary["warnings"]), "warning")
    return [
        f'"{summary["title"]}", {summary["status"]}, {warned}; {folder}',
        f"{len(rows)} of {counted(summary['depths_asked'], 'depth')}{span}",
    ]


def study_lines(
    folder: Path, status: Sequence[str], swept: Sequence[Mapping[str, str]]
) -> list[str]:
    """Describe a study in lines: how many cases have each status, and which keys are swept."""
    count = ", ".join(f"{number} {ended}" for ended, number in Counter(status).items())
    values = {key: len({each[key] for each in swept}) for key in swept[0]}
    keys = ", ".join(f"{key} ({counted(n, 'value')})" for key, n in values.items())
    return [f"{counted(len(status), 'case')}, {count}; {folder}", f"swept: {keys}"]
