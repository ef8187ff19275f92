"""Run one case: every depth loaded, some unloaded, everything kept."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from restitution.contact.contact import Contact
from restitution.contact.path import loading_path, unloading_path
from restitution.contact.plausibility import implausible
from restitution.contact.resolution import (
    foreseen_warnings,
    refuse_coarse_scan,
    unresolved_warning,
)
from restitution.contact.state import State
from restitution.errors import RestitutionError, one_line
from restitution.numerics.quadrature import integrate_curve
from restitution.studies.case import Case
from restitution.studies.derived import deepest_indentation, derived_quantities
from restitution.studies.results import ResultsFolder, results_dataset, versions
from restitution.studies.smooth import smooth_curve
from restitution.surfaces import describe

CONVENTIONS = {
    "end_of_contact": "separation, where the force is back to zero",
    "indentation_zero": "first touch of the undeformed bodies (highest asperity)",
    "restitution": "sqrt(unloading work / loading work), quasi-static normal impact",
    "yield_pressure": "largest contact pressure, a hardness: about 2.8 times the yield strength",
}

_BALANCE = 0.01  # difference of unloading work and stored energy that is worth a warning


@dataclass
class _Progress:
    """What a run has come to: how it ended, and what bears on how far it can be trusted."""

    status: str = "failed"
    reason: str = "stopped by an unforeseen error"
    deepest: State | None = None
    warnings: list[str] = field(default_factory=list)
    loading_work_errors: list[float] = field(default_factory=list)
    unloading_checks: list[dict[str, float]] = field(default_factory=list)


def run_case(
    case: Case,
    text: str,
    folder: Path,
    out: ResultsFolder,
    progress: Callable[[str], None] = lambda _: None,
    warn: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Run `case` (whose text was `text`, with files relative to `folder`) and return the summary.

    `progress` is called with a few words after every depth, `warn` with every warning: what is
    foreseen before the first solve, what the results show at the end, whichever end it is.
    Whatever stops the run is raised again once everything computed until then, and the reason, are
    in the folder; when nothing was, the folder is taken back.
    """
    began = time.perf_counter()
    run = _Progress()
    try:
        contact = case.contact(folder)
        foreseen = deepest_indentation(case)
        refuse_coarse_scan(contact, foreseen)
        run.warnings += foreseen_warnings(contact, foreseen) + implausible(contact, foreseen)
        for warning in run.warnings:
            warn(warning)
        with out.tables():
            _load_and_unload(contact, case, out, run, progress)
        run.status, run.reason = "complete", ""
    except KeyboardInterrupt:
        run.status, run.reason = "interrupted", "stopped by the user"
        raise
    except RestitutionError as error:
        run.reason = str(error)
        raise
    except Exception as error:
        run.reason = one_line(f"{run.reason}: {type(error).__name__} {error}".strip())
        raise
    finally:
        if run.deepest is None:
            out.discard()
        else:
            summary = _summarise(case, run.deepest.contact, out, run)
            summary["seconds"] = round(time.perf_counter() - began, 3)
            dataset = results_dataset(out, run.deepest)
            with suppress(RestitutionError):  # a reference that fails is no reason to fail
                dataset = dataset.assign(smooth_curve(run.deepest.contact, out.rows))
            dataset.attrs = _attributes(summary, text)
            out.write(dataset, summary)
            for warning in summary["warnings"][len(run.warnings) :]:
                warn(warning)
    return summary


def _load_and_unload(
    contact: Contact,
    case: Case,
    out: ResultsFolder,
    run: _Progress,
    progress: Callable[[str], None],
) -> None:
    depths, curves = case.depths(), case.unloading.curves
    # Evenly apart in number, the deepest among them.
    unloaded = {len(depths) - 1 - (k * len(depths)) // curves for k in range(curves)}
    path = loading_path(contact, forces=depths) if case.load else loading_path(contact, depths)
    for number, state in enumerate(path):
        out.add(state)
        run.deepest = state
        run.loading_work_errors.append(state.plastic_work_error / state.loading_work)
        if number in unloaded:
            run.unloading_checks.append(_unload(state, case.unloading.steps, out))
        progress(f"{number + 1} of {len(depths)} depths")


def _unload(state: State, steps: int, out: ResultsFolder) -> dict[str, float]:
    """Unload in steps, write the curve, and compare its work with the stored energy."""
    path = list(unloading_path(state, steps=steps))
    out.add_unloading(path)
    work = -integrate_curve([s.indentation for s in path], [s.force for s in path])
    return {
        "indentation_m": state.indentation,
        "unloading_work_J": work,
        "relative_to_stored_energy": work / state.stored_energy - 1,
        "separation_indentation_m": state.separation_indentation,
    }


def _summarise(case: Case, contact: Contact, out: ResultsFolder, run: _Progress) -> dict[str, Any]:
    patches = [int(row["largest_patch_nodes"]) for row in out.rows]
    unresolved = unresolved_warning([row["indentation_m"] for row in out.rows], patches)
    found = [unresolved, _unbalanced(run.unloading_checks)]
    elastic = math.isinf(contact.yield_pressure)
    return {
        "title": case.title,
        "status": run.status,
        "reason": run.reason,
        "depths_asked": len(case.depths()),
        "depths_computed": len(out.rows),
        "warnings": run.warnings + [warning for warning in found if warning],
        "model": {
            "plasticity": "none" if elastic else contact.plasticity,
            "adhesion": "none",
            "half_space": "free, Love cells, zero-padded FFT",
            **asdict(contact.grid),
        },
        "conventions": CONVENTIONS,
        "derived": derived_quantities(case, contact),
        "surface": dict(contact.surface.provenance),
        "surface_statistics": describe(contact.surface),
        "trust": {
            "largest_residual": max(row["residual"] for row in out.rows),
            "largest_loading_work_error": max(run.loading_work_errors),
            "unloading_checks": run.unloading_checks,
        },
        "convolutions": sum(int(row["convolutions"]) for row in out.rows),
        "versions": versions(),
    }


def _unbalanced(checks: list[dict[str, float]]) -> str | None:
    """One line on unloading curves whose work is not the stored energy, or None."""
    off = [check for check in checks if not abs(check["relative_to_stored_energy"]) <= _BALANCE]
    if not off:
        return None
    worst = max(off, key=lambda check: abs(check["relative_to_stored_energy"]))
    return (
        f"{len(off)} of {len(checks)} unloading curves return another work than was stored, at "
        f"worst {worst['relative_to_stored_energy']:+.1%} from "
        f"{1e9 * worst['indentation_m']:.4g} nm: raise unloading.steps, or refine the grid"
    )


def _attributes(summary: dict[str, Any], text: str) -> dict[str, str]:
    """Attributes of results.nc: flat texts."""
    groups = ("model", "conventions", "derived", "surface", "surface_statistics", "versions")
    return {
        "title": summary["title"],
        "status": summary["status"],
        "warnings": "\n".join(summary["warnings"]),
        "case": text,
        **{
            f"{group}_{key}": str(value)
            for group in groups
            for key, value in summary[group].items()
        },
    }
