"""Waves below the grid in runs: progress of their patches, and their law in words."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from restitution.case.case import Case
from restitution.contact.checks.resolution import divisions
from restitution.contact.contact import Contact
from restitution.contact.patch.law import PatchAttraction, PatchLaw, law_of_patches
from restitution.curve.point import Point
from restitution.display import counted, duration, quantity
from restitution.numerics.grid import Grid
from restitution.runs.log import Say, ignore
from restitution.runs.refinement import MOST_NODES
from restitution.surfaces.refine import FACTORS, divided

_DRAWN = 400  # points of a drawn law
_LONG = 0.05  # time (s) from which a patch counts as solved now


REFINED = (
    "The grid is refined where the contact is small beside the patches, up to 2²⁰ nodes; "
    "grid.refine = 1 keeps it."
)

# Errors of COR above this are told, with a grid on which they are smaller. They are proportional to
# the longest wave of the patches, which should be at most this fraction of the contact radius.
_WIDE, _LONGEST = 0.05, 0.5

# Share of the work of adhesion that patches may lose in jumps without a warning.
_LOST = 0.05


def solve_patches(contact: Contact, progress: Say = ignore) -> None:
    """Solve the patches of `contact`, and report those that were not known."""
    law = law_of_patches(contact)
    if law is None:
        return
    for number, patch in enumerate(law.patches, 1):
        began = time.perf_counter()
        law.curve(patch)
        if time.perf_counter() - began > _LONG:
            progress(f"patch {number} of {len(law.patches)}")


def told(contact: Contact) -> dict[str, Any]:
    """Entries of `summary.json` about waves below the grid; empty if there are none."""
    law = law_of_patches(contact)
    if law is None:
        return {}
    patch = law.patches[0].grid
    return {
        "split_m": law.wavelength,
        "patches": len(law.patches),
        "patch_nodes": list(patch.nodes),
        "patch_spacing_m": patch.spacing[0],
        "patch_rms_m": float(np.sqrt(np.mean([p.height.var() for p in law.patches]))),
        **law.summary(),
    }


def patch_curve(contact: Contact) -> dict[str, Any]:
    """Make the variables of `results.nc` for the law of patches; empty without patches."""
    law = law_of_patches(contact)
    if law is None:
        return {}
    gap = law.table.drawn(_DRAWN)
    values = {
        "gap": ("m", "distance of the mean planes of the patches before deformation", gap),
        "pressure": ("Pa", "nominal pressure of the patches during loading", law.table.at(gap)),
    }
    return {
        f"patch_{name}": ("patch", of, {"units": unit, "long_name": words})
        for name, (unit, words, of) in values.items()
    }


def cost_in_words(law: PatchLaw) -> str:
    """What is split, and the time that the patches take."""
    nx, ny = law.patches[0].grid.nodes
    seconds = law.seconds_per_node * nx * ny * len(law.patches)
    return (
        f"Waves below {quantity(law.wavelength, 'm')} are computed on {len(law.patches)} periodic "
        f"patches of {nx} x {ny} nodes, in about {duration(seconds)} the first time."
    )


def too_small_for_patches(case: Case, contact: Contact, points: Sequence[Point]) -> Iterator[str]:
    """Yield a warning if the contact is small beside dry patches, with a grid and its error."""
    law, grid = law_of_patches(contact), case.grid.grid()
    if law is None or law.attracts or grid is None or not isinstance(case.grid.refine, int):
        return
    wide = [
        point
        for point in points
        if point.discretisation_error > _WIDE and 0 < _LONGEST * _radius(point) < law.wavelength
    ]
    if not wide:
        return
    largest = max(point.discretisation_error for point in wide)
    times = divisions(law.wavelength, _LONGEST * min(map(_radius, wide)))
    if (keys := _finer(case, grid, times)) is None:
        return
    yield (
        "the radius of the real contact area is below two wavelengths of the patches "
        f"({quantity(law.wavelength, 'm')}) at {len(wide)} of {counted(len(points), 'depth')}, "
        f"where the error of COR by the grid is up to {largest:.2g}; with {keys}, it would be "
        f"about {largest / times:.1g}"
    )


def patches_that_jump(case: Case, contact: Contact) -> Iterator[str]:
    """Yield a warning if patches that attract each other lose energy in jumps."""
    law, grid = law_of_patches(contact), case.grid.grid()
    if not isinstance(law, PatchAttraction):
        return
    if (lost := law.lost_in_jumps / law.work_of_adhesion) <= _LOST:
        return
    times = divisions(max(contact.grid.spacing), law.patches[0].grid.spacing[0])
    keys = None if grid is None else _cells(case, grid, times)
    remedy = "leave out short waves (roughness.shortest)" if keys is None else f"use {keys}"
    yield (
        f"the patches lose {lost:.0%} of the work of adhesion in jumps, which adds to the errors "
        f"of pull-off force and COR; {remedy}, without patches"
    )


def _finer(case: Case, grid: Grid, times: int) -> str | None:
    """Keys with which patches have shorter waves; None if they take too many nodes."""
    keys = _cells(case, grid, times)
    split = keys is not None and any(part.split for part in case.roughness)
    return "a shorter roughness.split" if split else keys


def _cells(case: Case, grid: Grid, times: int) -> str | None:
    """Keys of a grid with cells smaller by the factor `times`; None if it has too many nodes."""
    factor = times * case.grid.factor
    nx, ny = divided(grid, factor).nodes
    if nx * ny > MOST_NODES:
        return None
    if any(part.needs_patches(grid) for part in case.roughness):
        finer = divided(grid, times)
        (nx, ny), spacing = finer.nodes, quantity(min(finer.spacing), "m")
        return f'grid.nodes = [{nx}, {ny}] and grid.spacing = "{spacing}"'
    return None if factor > FACTORS[-1] else f"grid.refine = {factor} ({nx} x {ny} nodes)"


def _radius(point: Point) -> float:
    return math.sqrt(point.contact_area / math.pi)
