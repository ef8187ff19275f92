"""Run one case: load to every depth, unload from some, and write the results."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from restitution.case.below_grid import notice_of
from restitution.case.case import Case
from restitution.case.derived import deepest_indentation, derived_quantities
from restitution.case.omissions import omissions
from restitution.collision import Collision, collide
from restitution.contact.contact import Contact
from restitution.contact.interface import interface_of
from restitution.contact.jkr.unloading_curve import unloading_curve
from restitution.contact.plasticity.cavity import FULL_CONSTRAINT
from restitution.contact.state import State
from restitution.curve.curve import UnloadingCurve, largest
from restitution.curve.follow import Impact, follow
from restitution.errors import DomainError, NotConvergedError, RestitutionError
from restitution.results.interruption import hold_signals
from restitution.results.maps import DepthMaps, write_maps
from restitution.results.writer import (
    ResultsFolder,
    case_attributes,
    results_dataset,
    status_attributes,
    versions,
)
from restitution.runs.attraction import Sticking, sticking, summary_of, with_errors
from restitution.runs.depths import CaseUnloading, loads_of
from restitution.runs.error_budget import (
    ErrorBudget,
    band_warning,
    interrupted_errors,
    total_error_summary,
)
from restitution.runs.log import RunLog, Say, ignore, solved_with
from restitution.runs.losses import loss_warnings, unloading_of, with_losses
from restitution.runs.messages import input_warnings, require_possible
from restitution.runs.oblique import is_oblique, oblique_points
from restitution.runs.refinement import with_chosen_adhesion, with_chosen_grids
from restitution.runs.result_warnings import (
    imprecise,
    too_coarse_for_adhesion,
    unbalanced,
    unresolved,
    velocities_missed,
)
from restitution.runs.run_in import require_run_in, run_in
from restitution.runs.size_effect import left_out
from restitution.runs.smooth import smooth_curve
from restitution.runs.two_scales import (
    patch_curve,
    patches_that_jump,
    solve_patches,
    told,
    too_small_for_patches,
)
from restitution.surfaces import describe

CONVENTIONS = {
    "end_of_contact": "separation, where the force is back to zero",
    "indentation_zero": "first touch of the undeformed bodies (highest asperity)",
    "restitution": "sqrt(unloading work / loading work), quasi-static normal impact",
}
YIELD_PRESSURE = "largest contact pressure, a hardness: about 2.8 times the yield strength"
FULL_PRESSURE = (
    f"pressure of a fully plastic contact, {FULL_CONSTRAINT} times the yield strength; contacts "
    "begin to yield at about 1.6 times the yield strength"
)

_MAPS_ALONG = {
    "max_indentation_m": "indentation_max",
    "impact_velocity_m_per_s": "impact_velocity",
}


@dataclass
class _Run(RunLog):
    """The log of a run, with data of its depths for the warnings and the summary."""

    errors: bool = True  # whether the run computes the total error
    deepest: State | None = None
    loading_work_errors: list[float] = field(default_factory=list)
    prescribed: list[float] = field(default_factory=list)
    band_errors: list[float] = field(default_factory=list)
    depth_seconds: list[float] = field(default_factory=list)
    unloading_checks: list[dict[str, float]] = field(default_factory=list)
    sticking: Sticking | None = None
    maps: list[DepthMaps] = field(default_factory=list)
    run_in: dict[str, Any] = field(default_factory=dict)
    unloading: dict[float, UnloadingCurve] = field(default_factory=dict)


def run_case(
    case: Case,
    text: str,
    folder: Path,
    out: ResultsFolder,
    progress: Say = ignore,
    warn: Say = ignore,
    *,
    errors: bool = True,
) -> dict[str, Any]:
    """Run `case`, which has one surface, and return the summary.

    `text` is the text of the case file, and its files are relative to `folder`. With `errors`, a
    depth that does not converge is left out, and the total errors are computed unless the case has
    `total_error = false`. Without `errors`, it ends the curve, because several runs are compared by
    the number of their point. Contact at the edge of the grid always ends the curve.

    Results so far are written before the first error is raised; a folder without results is
    removed. `progress` is called after every depth. `warn` is called with the warnings about the
    input before the first solve, and with those about the results at the end.
    """
    case.require_impact()
    run = _Run(progress, warn, errors=errors)

    with run.record(
        out, lambda: _write_results(case, text, out, run, run.deepest) if run.deepest else {}
    ):
        case = with_chosen_grids(case, folder, run.warn)
        contact = case.contact(folder)
        require_run_in(case, contact)
        if (notice := notice_of(case, folder)) is not None:
            run.warn(notice)
        solve_patches(contact, run.progress)
        case = with_chosen_adhesion(case, contact, run.warn)
        deepest = deepest_indentation(case)
        require_possible(contact, deepest)
        for warning in _input_warnings(case, contact, deepest):
            run.warn(warning)
        with out.tables():
            failure = _load_and_unload(case, folder, contact, out, run, go_on=errors)
        out.put_curve(with_losses(case.pair(), case.losses(), out.curve.points, run.unloading))
        run.sticking = sticking(case, folder, out.curve, run.deepest)
        if errors and case.total_error and out.curve.points:
            budget = ErrorBudget(case, folder, out.curve.points, run.progress, run.material_parts)
            try:
                budget.add(contact.surface)
                if run.sticking is not None:
                    run.sticking = with_errors(run.sticking, budget.finest, scattered=True)
            except RestitutionError as error:
                run.warn(f"total_error is unknown: {error}")
            finally:
                run.band_errors = budget.band
                out.put_curve(budget.points)
            if run.deepest is not None:
                with suppress(RestitutionError):  # the companion curve cannot be computed
                    if finding := left_out(case, folder, out.curve, run.deepest):
                        run.warn(finding.text())
        if is_oblique(case) and out.curve.points:
            oblique, missing = oblique_points(case, contact.surface, out)
            out.put_oblique(oblique)
            run.warnings += [missing] if missing else []
        if case.impacts is not None:
            run.run_in = run_in(case, folder, contact, out, run.progress)
        if failure is not None:
            raise failure
    return run.summary


def _input_warnings(case: Case, contact: Contact, deepest: float) -> list[str]:
    of_contact = input_warnings(contact, deepest, case.prescribed)
    return [*omissions(case), *loss_warnings(case), *of_contact]


def _write_results(
    case: Case, text: str, out: ResultsFolder, run: _Run, deepest: State
) -> dict[str, Any]:
    summary = _summarise(case, deepest.contact, out, run)
    summary["seconds"] = run.seconds
    dataset = results_dataset(out, deepest)
    with suppress(RestitutionError):  # if the smooth curve fails, the results omit it
        dataset = dataset.assign(smooth_curve(deepest.contact, out.curve.points))
    dataset = dataset.assign(patch_curve(deepest.contact))
    dataset.attrs = status_attributes(summary) | case_attributes(summary, text)
    points = out.curve.points
    write_maps(out.path, run.maps[: len(points)], points, _MAPS_ALONG)
    out.write(dataset, summary)
    return summary


def _load_and_unload(
    case: Case, folder: Path, contact: Contact, out: ResultsFolder, run: _Run, *, go_on: bool
) -> RestitutionError | None:
    """Compute the depths one after the other; return the error of the first depth that failed."""
    count = len(case.depths())
    failures: list[RestitutionError] = []
    computed = 0

    def failed(error: RestitutionError) -> bool:
        if not isinstance(error, (NotConvergedError, DomainError)):
            raise error
        failures.append(error)
        # A contact that reaches the edge of the grid ends the curve, because deeper contacts reach
        # the edge, too.
        if not go_on or isinstance(error, DomainError):
            return False
        run.progress(f"{computed + len(failures)} of {count} depths")
        return True

    loads = loads_of(case, folder, contact, unloaded=count if is_oblique(case) else None)
    began = time.perf_counter()
    for computed, impact in enumerate(follow(loads, CaseUnloading.of_case(case), failed), 1):
        _keep(impact, case, out, run)
        run.depth_seconds.append(round(time.perf_counter() - began, 4))
        began = time.perf_counter()
        run.progress(f"{computed + len(failures)} of {count} depths")
    return failures[0] if failures else None


def _keep(impact: Impact, case: Case, out: ResultsFolder, run: _Run) -> None:
    """Write the point of an impact, and its unloading curve if the case asks for it."""
    state, collision = impact.state, impact.collision
    with hold_signals():  # an interruption leaves a complete row or no row
        run.prescribed.append(impact.load.prescribed)
        run.loading_work_errors.append(state.work_error / max(abs(state.loading_work), 1e-300))
        if case.maps == "all":
            run.maps.append(DepthMaps.of(state))
        out.add(impact.point)
        run.deepest = state
    if (back := unloading_of(impact)) is not None:
        run.unloading[impact.point.indentation] = back
    if impact.load.unload and state.contact_nodes:
        out.add_unloading(impact.unloading, impact.load.touch)
        run.unloading_checks.append(_check(state, impact.unloading, collision))


def _check(state: State, back: Sequence[State], collision: Collision) -> dict[str, float]:
    """The energy balance of an unloading curve, for the diagnostics of the run."""
    work, lost = unloading_curve(list(back)).work(), collision.adhesive_loss
    unbalance = interface_of(state.contact).unbalance(state, back[-1], work, lost)
    return {
        "max_indentation_m": state.indentation,
        "unloading_work_J": work,
        "adhesive_loss_J": lost,
        "relative_to_stored_energy": unbalance,
        "restitution_from_energy_estimate": collide(state, method="energy-estimate").restitution,
        "separation_indentation_m": back[-1].indentation,
    }


def _summarise(case: Case, contact: Contact, out: ResultsFolder, run: _Run) -> dict[str, Any]:
    points = out.curve.points
    one_pressure = contact.first_yield_pressure == contact.hardness
    return {
        **run.head(case),
        "depths_asked": len(case.depths()),
        "depths_computed": len(points),
        "warnings": [*run.warnings, *_result_warnings(case, contact, out, run)],
        "model": {
            "plasticity": contact.plasticity.label,
            **interface_of(contact).describe(case.unloading.method),
            "half_space": "free, Love cells, zero-padded FFT",
            "below_grid": told(contact),
            **asdict(contact.grid),
            "refine": case.grid.refine,
            "yield_pressure": case.yielding().source,
            "yields": contact.yields or "unknown",
            **({"size_effect_m": size} if (size := case.yielding().size_effect) else {}),
        },
        "materials": _materials(case),
        "conventions": {
            **CONVENTIONS,
            "yield_pressure": YIELD_PRESSURE if one_pressure else FULL_PRESSURE,
        },
        "derived": derived_quantities(case, contact),
        "sticking": summary_of(run.sticking),
        "surface": dict(contact.surface.provenance),
        "surface_statistics": describe(contact.surface),
        "diagnostics": {
            "largest_residual": largest(points, "residual"),
            "largest_loading_work_error": max(run.loading_work_errors),
            "largest_restitution_error": largest(points, "restitution_error"),
            **total_error_summary(case, points, run.material_parts),
            "unloading_checks": run.unloading_checks,
        },
        **({"run_in": run.run_in} if run.run_in else {}),
        **solved_with(points),
        "seconds_by_depth": run.depth_seconds,
        "versions": versions(),
    }


def _materials(case: Case) -> dict[str, Any]:
    """Material values that come from the library, with their spread and source."""
    adhesion = case.library_adhesion()
    return {
        name: {
            "material": body.material,
            **{key: value.model_dump() for key, value in body.from_library().items()},
        }
        for name, body in case.bodies().items()
        if body.material is not None
    } | ({"interface": {"work_of_adhesion": adhesion.model_dump()}} if adhesion else {})


def _result_warnings(case: Case, contact: Contact, out: ResultsFolder, run: _Run) -> Iterator[str]:
    points = out.curve.points
    yield from unresolved(points)
    yield from too_coarse_for_adhesion(case, contact.grid, points, run.seconds)
    yield from band_warning(contact.surface, run.band_errors, case.grid.factor)
    yield from too_small_for_patches(case, contact, points)
    yield from patches_that_jump(case, contact)
    if run.errors:
        yield from interrupted_errors(case, points, run.status)
    yield from imprecise(points, case)
    yield from velocities_missed(points, case, run.prescribed)
    if not contact.adhesive:
        yield from unbalanced(run.unloading_checks)
