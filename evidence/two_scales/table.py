"""A table of random cases, to which a script adds those that it lacks, and the scripts' options."""

from __future__ import annotations

import argparse
import csv
from collections.abc import Mapping, Sequence
from pathlib import Path


class Table:
    """The table beside a script, with these `columns`."""

    def __init__(self, script: str, columns: Sequence[str]) -> None:
        self._path, self._columns = Path(script).with_suffix(".csv"), columns

    def rows(self) -> list[dict[str, str]]:
        if not self._path.exists():
            return []
        with open(self._path, newline="") as file:
            return list(csv.DictReader(file))

    def cases(self) -> set[int]:
        return {int(row["case"]) for row in self.rows()}

    def append(self, rows: Sequence[Mapping[str, object]]) -> None:
        new = not self._path.exists()
        with open(self._path, "a", newline="") as file:
            writer = csv.DictWriter(file, self._columns, lineterminator="\n")
            if new:
                writer.writeheader()
            writer.writerows(rows)


def options(description: str | None) -> argparse.Namespace:
    """The folder of scans (`topographies`), and whether only the `summary` is asked for."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--topographies", type=Path, default=Path("../shared/topographies"))
    parser.add_argument("--summary", action="store_true")
    given = parser.parse_args()
    given.topographies = given.topographies.resolve()
    return given
