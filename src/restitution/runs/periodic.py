"""Run a periodic case: load to every depth, and write the results."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from restitution.case.case import Case
from restitution.case.derived import deepest_indentation, derived_quantities
from restitution.case.measured import MeasuredRoughness
from restitution.contact.interface import interface_of
from restitution.contact.prescribed.stiffness import normal_stiffness
from restitution.contact.state import State
from restitution.curve.follow import loaded
from restitution.curve.periodic import Histogram, PeriodicPoint
from restitution.errors import NotConvergedError
from restitution.results.interruption import hold_signals
from restitution.results.maps import DepthMaps, write_maps
from restitution.results.periodic import periodic_dataset
from restitution.results.schema import PERIODIC_FILE
from restitution.results.writer import (
    ResultsFolder,
    case_attributes,
    status_attributes,
    versions,
)
from restitution.runs.depths import loads_of
from restitution.runs.log import RunLog, Say, ignore, solved_with
from restitution.runs.messages import input_warnings, require_possible
from restitution.runs.result_warnings import unresolved
from restitution.surfaces import describe

_MAPS_ALONG = {"indentation_m": "depth", "nominal_pressure_Pa": "nominal_pressure"}
CONVENTIONS = {
    "indentation": "approach of the mean planes of the two surfaces since first touch",
    "nominal_pressure": "normal force divided by the area of one period",
    "stiffness": "nominal pressure per approach of the mean planes, at a constant contact area",
    "works": "of one period, without the work of uniform compression by the mean pressure",
}


def run_periodic(
    case: Case,
    text: str,
    folder: Path,
    out: ResultsFolder,
    progress: Say = ignore,
    warn: Say = ignore,
) -> dict[str, Any]:
    """Run the periodic `case` and return the summary; the arguments are those of `run_case`.

    A depth that cannot be solved ends the curve; its error is raised after the results are written.
    """
    log, deepest = RunLog(progress, warn), list[State]()
    histograms: list[Histogram] = []
    maps: list[DepthMaps] = []

    def keep() -> dict[str, Any]:
        if not deepest:
            return {}
        write_maps(out.path, maps, out.periodic, _MAPS_ALONG)
        return _write_results((case, text), out, log, deepest[-1], histograms)

    with log.record(out, keep):
        contact = case.contact(folder)
        last = deepest_indentation(case)
        require_possible(contact, last)
        for warning in _edges_of_scans(case) + input_warnings(contact, last):
            log.warn(warning)
        count = len(case.depths())
        for number, (_, state) in enumerate(loaded(loads_of(case, folder, contact)), 1):
            point = PeriodicPoint.of(state, _stiffness(state))
            with hold_signals():  # an interruption leaves a complete row or no row
                out.periodic.append(point)
                if case.maps == "all":
                    maps.append(DepthMaps.of(state))
                histograms.append(Histogram.of(state))
                deepest[:] = [state]
                out.put_table(PERIODIC_FILE, out.periodic)
            progress(f"{number} of {count} depths")
    return log.summary


def _edges_of_scans(case: Case) -> list[str]:
    """A warning for each scan without `extend`, because its opposite edges do not match."""
    return [
        f"roughness.file: the opposite edges of {part.file} do not match, so the surface has steps "
        'along the edges of the grid; set roughness.extend = "twin" for a periodic surface with '
        "the spectrum of the scan"
        for part in case.roughness
        if isinstance(part, MeasuredRoughness) and part.extend is None
    ]


def _stiffness(state: State) -> float:
    with suppress(NotConvergedError):
        return normal_stiffness(state)
    return math.nan


def _write_results(
    read: tuple[Case, str],
    out: ResultsFolder,
    log: RunLog,
    deepest: State,
    histograms: Sequence[Histogram],
) -> dict[str, Any]:
    (case, text), contact, points = read, deepest.contact, out.periodic
    summary: dict[str, Any] = {
        **log.head(case),
        "depths_asked": len(case.depths()),
        "depths_computed": len(points),
        "warnings": [*log.warnings, *unresolved(points)],
        "model": {
            "plasticity": contact.plasticity.label,
            "adhesion": interface_of(contact).label,
            "half_space": "periodic, 2/(E* |q|), no mean displacement, FFT without padding",
            **asdict(contact.grid),
            "refine": case.grid.refine,
            "yield_pressure": case.yielding().source,
        },
        "conventions": CONVENTIONS,
        "derived": derived_quantities(case, contact),
        "surface": dict(contact.surface.provenance),
        "surface_statistics": describe(contact.surface),
        "diagnostics": {"largest_residual": max(point.residual for point in points)},
        **solved_with(points),
        "seconds": log.seconds,
        "versions": versions(),
    }
    dataset = periodic_dataset(points, histograms, deepest)
    dataset.attrs = status_attributes(summary) | case_attributes(summary, text)
    out.write(dataset, summary)
    return summary
