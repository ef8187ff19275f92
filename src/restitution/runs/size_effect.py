"""What a run without the size effect of its material leaves out."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from restitution.case.case import Case
from restitution.contact.checks.findings import PatchesBelowSizeEffect
from restitution.contact.plasticity.size_effect import sharpness
from restitution.contact.state import State
from restitution.curve.curve import Curve
from restitution.runs.companions import Companions

_MATTERS = 0.005  # change of COR


def left_out(
    case: Case, folder: Path, curve: Curve, deepest: State
) -> PatchesBelowSizeEffect | None:
    """Finding if h* of the library would change COR; None if the case has a size effect.

    The change comes from companion curves on cells twice as large.
    """
    known = None
    if case.interface.size_effect is None:
        known = case.library_size_effect()
    if known is None or not case.yielding().model.bounds_solve:
        return None
    name, length = known[0], known[1].value
    depth = yielding_depth(deepest)
    if not depth < length:
        return None
    interface = case.interface.model_copy(update={"size_effect": length})
    harder = case.model_copy(update={"interface": interface})
    companions = Companions.of(case, folder, curve.points)
    coarse = companions.coarse
    work = np.array([point.loading_work for point in curve.points])
    off = companions.curve(coarse).at(work)
    on = companions.curve(replace(coarse, plasticity=harder.yielding().model)).at(work)
    k = int(np.argmax(np.abs(on - off)))
    if not abs(change := float(on[k] - off[k])) > _MATTERS:
        return None
    own = curve.points[k].restitution
    mass = case.pair().mass
    velocity = math.nan if mass is None else math.sqrt(2 * float(work[k]) / mass)
    return PatchesBelowSizeEffect(name, length, depth, velocity, own, own + change)


def yielding_depth(state: State) -> float:
    """Depth (m) of the Berkovich indent that is as sharp as the median of what has yielded.

    The median is that of the plastic work; inf if nothing has yielded.
    """
    inverse, given = sharpness(state)
    if not given.size:
        return math.inf
    order = np.argsort(inverse)
    work = np.cumsum(given[order])
    median = inverse[order][np.searchsorted(work, 0.5 * work[-1])]
    return float(1 / median) if median > 0 else math.inf
