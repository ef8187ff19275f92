"""Run one case: every depth loaded, some unloaded, everything kept."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from restitution.contact.contact import Contact
from restitution.contact.path import loading_path, unloading_path
from restitution.contact.resolution import foreseen_warnings, unresolved_warning
from restitution.contact.state import State
from restitution.errors import RestitutionError
from restitution.numerics.quadrature import integrate_curve
from restitution.studies.case import Case
from restitution.studies.derived import deepest_indentation, derived_quantities
from restitution.studies.results import ResultsFolder, results_dataset, versions
from restitution.surfaces import describe

CONVENTIONS = {
    "end_of_contact": "separation, where the force is back to zero",
    "indentation_zero": "first touch of the undeformed bodies (highest asperity)",
    "restitution": "sqrt(unloading work / loading work), quasi-static normal impact",
    "yield_pressure": "largest contact pressure, a hardness: about 2.8 times the yield strength",
}


def run_case(
    case: Case,
    text: str,
    folder: Path,
    out: ResultsFolder,
    progress: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Run `case` (whose text was `text`, with files relative to `folder`) and return the summary.

    `progress` is called with a few words after every depth. Whatever stops the run, what was
    computed until then is in the folder, and the reason in its summary; then it is raised again.
    """
    began = time.perf_counter()
    contact = case.contact(folder)
    warnings = foreseen_warnings(contact, deepest_indentation(case))
    state: State | None = None
    checks: list[dict[str, float]] = []
    work_errors: list[float] = []
    status, reason = "complete", ""
    try:
        with out.tables():
            depths = case.depths()
            unloaded = _spread(len(depths), case.unloading.curves)
            path = (
                loading_path(contact, forces=depths) if case.load else loading_path(contact, depths)
            )
            for number, state in enumerate(path):
                out.add(state)
                work_errors.append(state.plastic_work_error / state.loading_work)
                if number in unloaded:
                    checks.append(_unload(state, case.unloading.steps, out))
                progress(f"{number + 1} of {len(depths)} depths")
    except KeyboardInterrupt:
        status, reason = "interrupted", "stopped by the user"
        raise
    except RestitutionError as error:
        status, reason = "failed", str(error)
        raise
    finally:
        if out.rows:
            largest = [int(row["largest_patch_nodes"]) for row in out.rows]
            unresolved = unresolved_warning([row["indentation_m"] for row in out.rows], largest)
            warnings += [unresolved] if unresolved else []
        summary = {
            "title": case.title,
            "status": status,
            "reason": reason,
            "depths_asked": len(case.depths()),
            "depths_computed": len(out.rows),
            "warnings": warnings,
            "model": _model(contact),
            "conventions": CONVENTIONS,
            "derived": derived_quantities(case, contact),
            "surface": dict(contact.surface.provenance),
            "surface_statistics": describe(contact.surface),
            "trust": {
                "largest_residual": max((row["residual"] for row in out.rows), default=None),
                "largest_loading_work_error": max(work_errors, default=None),
                "unloading_checks": checks,
            },
            "convolutions": sum(int(row["convolutions"]) for row in out.rows),
            "seconds": round(time.perf_counter() - began, 3),
            "versions": versions(),
        }
        dataset = results_dataset(out, state)
        dataset.attrs = _attributes(summary, text)
        out.write(dataset, summary)
    return summary


def _spread(count: int, curves: int) -> set[int]:
    """Indices of `curves` of `count` depths, evenly apart, the deepest among them."""
    return {count - 1 - (k * count) // curves for k in range(min(curves, count))}


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


def _model(contact: Contact) -> dict[str, Any]:
    grid = contact.grid
    return {
        "plasticity": contact.plasticity if contact.yield_pressure < float("inf") else "elastic",
        "adhesion": "none",
        "half_space": "free, Love cells, zero-padded FFT",
        "nodes": list(grid.nodes),
        "spacing_m": list(grid.spacing),
    }


def _attributes(summary: dict[str, Any], text: str) -> dict[str, str]:
    """Attributes of results.nc: flat texts."""
    flat = {
        f"{group}_{key}": str(value)
        for group in (
            "model",
            "conventions",
            "derived",
            "surface",
            "surface_statistics",
            "versions",
        )
        for key, value in summary[group].items()
    }
    return {
        "title": summary["title"],
        "status": summary["status"],
        "warnings": "\n".join(summary["warnings"]),
        "case": text,
        **flat,
    }
