"""The run-in of a case: impacts one after the other, and COR at several coverages."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from restitution.case.case import Case
from restitution.case.impacts import ImpactsTable, Rough
from restitution.case.roughness import Roughness
from restitution.contact.contact import Contact, smooth
from restitution.contact.models import COMPANION
from restitution.curve.columns import array
from restitution.errors import CaseError
from restitution.numerics.intervals import half_interval
from restitution.repeated.points import RepeatedImpact, RunInPoint, SteadyState
from restitution.repeated.run_in import RunIn, repeats
from restitution.results.writer import ResultsFolder, replace_file
from restitution.runs.log import Say, ignore
from restitution.surfaces import Surface, describe
from restitution.surfaces.refine import coarsen

OTHERS = 2  # number of additional sequences, on other surfaces, for the scatter
_OTHER_SURFACE = 500  # added to the seed of the roughness of the second body
_OTHER_SEED = 1000  # seeds of sequences on other surfaces differ by this number
Parts = tuple[Roughness, ...]
_PROBES = 77  # added to the seed of the places at which COR is measured


@dataclass(frozen=True)
class _Sequence:
    """Impacts on one pair of surfaces, and COR at the stated coverages, by velocity."""

    impacts: list[RepeatedImpact]
    points: list[RunInPoint]
    surfaces: tuple[Surface, Surface]


def measurements(case: Case) -> int:
    """Number of coverages at which COR is measured, in all sequences of impacts of `case`."""
    if case.impacts is None or case.impact is None:
        return 0
    count = len(case.impact.series()) if case.impacts.own_surfaces else 1
    levels = 1 + len(set(case.impacts.coverage or [0]))
    return levels * count * (2 + OTHERS if case.total_error else 1)


def require_run_in(case: Case, contact: Contact) -> None:
    """Raise `CaseError` if the surface does not repeat, or the coverages are not possible on it."""
    if case.impacts is None:
        return
    hardness = contact.plasticity.of_smooth(contact.pair).hardness
    case.impacts.require_possible(contact.grid, _velocities(case), contact.pair, hardness)
    if not repeats(contact.surface):
        raise CaseError(
            "roughness.file: opposite edges of the scan do not match, so it does not repeat, as "
            '[impacts] needs; set roughness.extend = "twin", or roughness.periodic = true if '
            'kind = "joined"'
        )


def run_in(
    case: Case, folder: Path, contact: Contact, out: ResultsFolder, progress: Say = ignore
) -> dict[str, Any]:
    """Run the surfaces of `case` in, write the tables and the final surfaces; return the summary.

    `contact` is the contact of the new bodies, which `require_run_in` accepts.
    """
    table = _table(case)
    bodies = _bodies(case, folder)
    own = list(_sequences(case, contact, bodies, table.seed, progress, "run-in"))
    points = [point for one in own for point in one.points]
    if case.total_error:
        points = _with_errors(case, folder, contact, bodies, points, progress)
    out.put_run_in(points, tuple(tuple(one.impacts) for one in own))
    return {
        "place": table.place,
        "rough": _rough_bodies(case),
        "places": table.places,
        "own_surfaces": table.own_surfaces,
        "coverage_means": "number of impacts times the contact area of smooth bodies, divided by "
        "the area of the grid",
        "sequences": [_described(k, one, out) for k, one in enumerate(own, 1)],
        "largest_total_error": max(
            (p.total_error for p in points if math.isfinite(p.total_error)), default=None
        ),
    }


def _table(case: Case) -> ImpactsTable:
    assert case.impacts is not None
    return case.impacts


def _velocities(case: Case) -> list[float]:
    assert case.impact is not None
    return case.impact.series()


def _parts(case: Case) -> tuple[Parts, Parts] | None:
    """The tables of roughness of each body; None if each has half of the variance of all."""
    tables = tuple(case.roughness)
    words = _table(case).rough or [_default_rough(case)]
    if words == ["both"]:
        return (tables[:1], tables[1:]) if len(tables) > 1 else None
    if len(words) == 1:
        words = words * len(tables)
    first, second = (
        tuple(part for part, word in zip(tables, words, strict=True) if word == body)
        for body in ("first", "second")
    )
    return first, second


def _default_rough(case: Case) -> Rough:
    bodies, yields = list(case.bodies().values()), case.yielding().yields
    equal = bodies[0] == bodies[1] and all(part.kind != "measured" for part in case.roughness)
    if equal and case.roughness:
        return "both"
    return "second" if yields == "second" else "first"


def _rough_bodies(case: Case) -> str:
    parts = _parts(case)
    if parts is None or all(parts):
        return "both"
    return next((name for name, part in zip(("first", "second"), parts, strict=True) if part), "")


def _bodies(case: Case, folder: Path) -> tuple[Surface, Surface]:
    """The surfaces of the two bodies."""
    whole, parts = case.surface(folder), _parts(case)
    if parts is None:
        return _scaled(whole), _scaled(_variant(case, _OTHER_SURFACE).surface(folder))
    first, second = (
        case.model_copy(update={"roughness": part}).surface(folder) if part else smooth(whole.grid)
        for part in parts
    )
    return first, second


def _variant(case: Case, number: int) -> Case:
    """The case with other random surfaces; mirror images of a scan do not repeat."""
    parts = tuple(
        part.variant(number) if getattr(part, "seed", None) is not None else part
        for part in case.roughness
    )
    return case.model_copy(update={"roughness": parts})


def _scaled(surface: Surface) -> Surface:
    """Half of the variance, so that two bodies together have the given roughness."""
    return replace(surface, height=surface.height * math.sqrt(0.5))


def _coarser(bodies: tuple[Surface, Surface]) -> tuple[Surface, Surface]:
    first, second = (
        replace(coarse, provenance={**coarse.provenance, COMPANION: "coarser"})
        for coarse in map(coarsen, bodies)
    )
    return first, second


def _sequences(
    case: Case,
    contact: Contact,
    bodies: tuple[Surface, Surface],
    seed: int,
    progress: Say,
    words: str,
) -> Iterator[_Sequence]:
    """One sequence for each velocity, or one for all, as the case says."""
    table, velocities = _table(case), _velocities(case)
    groups = [[V] for V in velocities] if table.own_surfaces else [velocities]
    first, second = bodies
    new = replace(contact, surface=first)
    for measured in groups:
        runs = RunIn(new, second, place=table.place, seed=seed)
        at = f" at {measured[0]:.3g} m/s" if table.own_surfaces else ""
        yield _sequence(runs, table, measured, seed, _after(words + at, progress))


def _after(words: str, progress: Say) -> Say:
    return lambda more: progress(words + more)


def _sequence(
    runs: RunIn, table: ImpactsTable, measured: Sequence[float], seed: int, progress: Say
) -> _Sequence:
    impacts: list[RepeatedImpact] = []

    def measure() -> Iterator[RunInPoint]:
        progress(f", coverage {runs.coverage:.2g}")
        for V in measured:
            yield RunInPoint.of(list(runs.probe(V, table.places, seed + _PROBES)))

    points = list(measure())
    following = runs.impacts(table.velocities(measured[0], seed))
    if table.count is not None:
        impacts += (next(following) for _ in range(table.count))
        points += measure()
    for coverage in sorted(set(table.coverage or [])):
        while not impacts or coverage - runs.coverage > 0.5 * runs.coverage / len(impacts):
            impacts.append(next(following))
        points += measure()
    return _Sequence(impacts, points, runs.surfaces)


def _with_errors(
    case: Case,
    folder: Path,
    contact: Contact,
    bodies: tuple[Surface, Surface],
    points: list[RunInPoint],
    progress: Say,
) -> list[RunInPoint]:
    """Add the errors due to grid and surfaces, from sequences on cells twice as large."""
    table = _table(case)

    def coarse(other: tuple[Surface, Surface], seed: int, words: str) -> np.ndarray[Any, Any]:
        coarser = _coarser(other)
        on = replace(contact, surface=coarser[0])
        runs = _sequences(case, on, coarser, seed, progress, words)
        return array([point for one in runs for point in one.points], "restitution")

    same = coarse(bodies, table.seed, "error: cells twice as large")
    others = [
        coarse(
            _bodies(_variant(case, k), folder),
            table.seed + _OTHER_SEED * k,
            f"error: surface {k} of {OTHERS}",
        )
        for k in range(1, OTHERS + 1)
    ]
    e, coverage = array(points, "restitution"), array(points, "coverage")
    rows = np.array([same, *others])
    half = half_interval(len(rows))
    new = []
    for k, point in enumerate(points):
        # Differences vanish by chance at single velocities, so those of all are combined.
        level = np.isclose(coverage, point.coverage, rtol=0.2, atol=1e-3)
        change = max(abs(float(e[k] - same[k])), math.sqrt(float(np.mean((e - same)[level] ** 2))))
        deviation = math.sqrt(float(np.mean(rows[:, level].var(axis=0, ddof=1))))
        scatter = abs(float(same[k] - rows[:, k].mean())) + half * deviation
        parts = (point.places_error, point.solver_error, change, scatter)
        total = min(math.hypot(*parts), max(point.restitution, 1 - point.restitution))
        new.append(
            replace(
                point,
                discretisation_error=change,
                surface_scatter=scatter,
                total_error=total,
            )
        )
    return new


def _described(number: int, one: _Sequence, out: ResultsFolder) -> dict[str, Any]:
    """Summary of a sequence: its steady state, and its final surfaces, which are stored."""
    steady = SteadyState.of(one.impacts)
    surfaces = {}
    for name, surface in zip(("first", "second"), one.surfaces, strict=True):
        if not surface.height.any():
            continue
        file = f"run-in-{number}-{name}.npz"
        if out.path is not None:
            _store(out.path / file, surface)
        surfaces[name] = {"file": file, **describe(surface)}
    return {
        "sequence": number,
        "impacts": len(one.impacts),
        "coverage": one.impacts[-1].coverage,
        "steady_state": None if steady is None else asdict(steady),
        "surfaces": surfaces,
    }


def _store(path: Path, surface: Surface) -> None:
    """Write a surface as a file that `roughness.file` reads."""

    def write(to: Path) -> None:
        with to.open("wb") as file:
            np.savez_compressed(file, height=surface.height, size=np.array(surface.grid.size))

    replace_file(path, write)
