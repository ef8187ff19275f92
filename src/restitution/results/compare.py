"""Compare two runs or two studies: COR with its errors, and the inputs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.case.case_file import parse_toml
from restitution.curve.columns import array
from restitution.curve.point import MeanPoint, Point
from restitution.errors import OutputError
from restitution.results.reader import RunResults, StudyResults
from restitution.results.tables import require_restitution

_SAME = 1e-9  # largest relative difference of two depths that count as equal


@dataclass(frozen=True)
class Comparison:
    """The comparison of two runs or studies, a and b.

    Attributes:
        rows: A row for each compared depth, with COR of a and of b, the `difference` (b minus a)
            with its `error`, and `force_ratio` (b divided by a). Rows of studies also contain the
            swept values.
        inputs: The keys of the input files whose values differ, with the values in a and in b.
        notes: Remarks on the comparison.
    """

    rows: list[dict[str, Any]]
    inputs: list[tuple[str, str, str]]
    notes: list[str]


def compare(a: Path, b: Path) -> Comparison:
    """Compare the results in the folders `a` and `b`. Raises `OutputError`."""
    kinds = {_kind(a), _kind(b)}
    if len(kinds) > 1:
        raise OutputError(
            f"cannot compare a run with a study ({a}, {b}); give two runs or two studies"
        )
    if kinds == {"run"}:
        (of_a, case_a), (of_b, case_b) = _run(a), _run(b)
        rows, notes = _curves(of_a, of_b, {})
        return Comparison(rows, _inputs(case_a, case_b), notes)
    return _studies(a, b)


def _kind(folder: Path) -> str:
    if (folder / "study.toml").is_file():
        return "study"
    if (folder / "curve.csv").is_file():
        return "run"
    require_restitution(folder)
    raise OutputError(f"{folder}: holds no results of a run or study; give a results folder")


def _studies(a: Path, b: Path) -> Comparison:
    studies = StudyResults(a), StudyResults(b)
    of_a, of_b = map(_complete_cases, studies)
    common = [key for key in of_a if key in of_b]
    if not common:
        raise OutputError(
            f"no case has the same swept values in both studies ({a}, {b}); give studies with "
            "common values"
        )
    compared = [_curves(of_a[key], of_b[key], dict(key)) for key in common]
    rows = [row for curve, _ in compared for row in curve]
    notes = list(dict.fromkeys(note for _, said in compared for note in said))
    for name, this, other in ((a, of_a, of_b), (b, of_b, of_a)):
        if alone := len(this.keys() - other.keys()):
            notes.append(f"{alone} of {len(this)} cases are in {name} only")
    return Comparison(rows, _inputs(*(study.text for study in studies)), notes)


def _curves(
    a: Sequence[Point], b: Sequence[Point], swept: Mapping[str, str]
) -> tuple[list[dict[str, Any]], list[str]]:
    """Compare two curves at the depths of `a` inside the range of `b`, which is interpolated."""
    depth_b = array(b, "indentation")
    weights = [_weights(depth_b, point.indentation) for point in a]
    rows = [
        {**swept, **_difference(point, [b[k] for k in weight], list(weight.values()))}
        for point, weight in zip(a, weights, strict=True)
        if weight
    ]
    notes = []
    if any(len(weight) > 1 for weight in weights):
        notes.append("depths differ: the second result is interpolated")
    if not all(weights):
        notes.append("depths of the first result outside the range of the second are left out")
    if any(math.isnan(point.discretisation_error) for point in (*a, *b)):
        notes.append(
            "where discretisation_error is empty, the errors do not include the error due to the "
            "grid (set total_error = true, or use restitution converge)"
        )
    return rows, notes


def _weights(depths: NDArray[np.float64], depth: float) -> dict[int, float]:
    """The weights, by number, of the points that interpolate a curve at `depth` (m).

    Empty if `depth` lies outside the range of `depths`.
    """
    same = np.flatnonzero(np.abs(depths - depth) <= _SAME * depth)
    if same.size:
        return {int(same[0]): 1.0}
    if depths.size < 2 or not depths[0] < depth < depths[-1]:
        return {}
    k = int(np.searchsorted(depths, depth))
    # Between neighbouring depths COR is nearly linear in the logarithm of depth.
    share = math.log(depth / depths[k - 1]) / math.log(depths[k] / depths[k - 1])
    return {k - 1: 1 - share, k: share}


def _difference(point: Point, other: Sequence[Point], weights: Sequence[float]) -> dict[str, Any]:
    """Compare a point with the weighted mean of the points `other`."""
    cor_a = point.restitution
    cor_b, force_b = (
        float(np.dot(weights, array(other, name))) for name in ("restitution", "force")
    )
    error = math.hypot(_error(point), max(map(_error, other)))
    return {
        "max_indentation_m": point.indentation,
        "restitution_a": cor_a,
        "restitution_b": cor_b,
        "difference": cor_b - cor_a,
        "error": error,
        "significant": abs(cor_b - cor_a) > error,
        "resolved": all(one.resolved for one in (point, *other)),
        "force_ratio": force_b / point.force if point.force else math.nan,
    }


def _error(point: Point) -> float:
    """Error of COR: its numerical error, grid error and ensemble error in quadrature."""
    parts = [point.restitution_error, point.discretisation_error]
    if isinstance(point, MeanPoint):
        parts.append(0.5 * (point.restitution_high - point.restitution_low))
    return math.hypot(*(part for part in parts if not math.isnan(part)))


def _complete_cases(
    study: StudyResults,
) -> dict[tuple[tuple[str, str], ...], tuple[Point, ...]]:
    return {
        tuple(case.swept.items()): case.curve.points
        for case in study.cases
        if case.status == "complete"
    }


def _run(folder: Path) -> tuple[tuple[Point, ...], str]:
    """Return the rows of the curve of a run, and the text of its case file.

    The text is empty if the run was killed and left only its curve.
    """
    run = RunResults(folder)
    if not (folder / "summary.json").exists() and not (folder / "results.nc").exists():
        return run.curve.points, ""
    run.check()
    return run.curve.points, run.case_text


def _inputs(a: str, b: str) -> list[tuple[str, str, str]]:
    flat_a, flat_b = (dict(_flat(parse_toml(text))) for text in (a, b))
    return [
        (key, flat_a.get(key, "–"), flat_b.get(key, "–"))
        for key in dict.fromkeys([*flat_a, *flat_b])
        if flat_a.get(key) != flat_b.get(key)
    ]


def _flat(table: Any, before: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(table, dict):
        for key, value in table.items():
            yield from _flat(value, f"{before}.{key}" if before else key)
    elif isinstance(table, list) and table and isinstance(table[0], dict):
        for number, value in enumerate(table, 1):
            yield from _flat(value, f"{before}.{number}")
    else:
        yield before, str(table)
