"""Errors of COR near sticking: those of the lost energy, carried to COR."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from restitution.contact.patch.law import PatchAttraction
from restitution.curve.columns import Array, array
from restitution.curve.point import Point
from restitution.runs.attraction import errors_by_kind
from restitution.runs.companions import Companions


def carried(ratio: Array, error: Array) -> Array:
    """Error of COR due to the `error` of W_u/W_l; `ratio` is negative where the bodies stick."""
    here, *ends = (np.sqrt(np.clip(r, 0.0, 1.0)) for r in (ratio, ratio - error, ratio + error))
    return np.asarray(np.max([np.abs(end - here) for end in ends], axis=0))


def with_sticking(
    columns: Mapping[str, Array],
    companions: Companions,
    points: Sequence[Point],
    *,
    scattered: bool = True,
) -> dict[str, Array]:
    """Widen the errors of COR in `columns` where those of the lost energy allow a larger change.

    COR is 0 at any loss above the kinetic energy, so the differences between the curves of bodies
    that all stick are 0, however far their losses differ. The errors of the loss are combined, and
    the error of COR by all of them is divided as their squares are. For contacts with patches that
    attract each other; other `columns` stay as they are.
    """
    if not isinstance(companions.coarse.adhesion, PatchAttraction):
        return dict(columns)
    work, ratio = array(points, "loading_work"), array(points, "ratio")
    kinds = errors_by_kind(companions, lambda c: c.ratio(work), ratio, scattered=scattered)
    squares = {name: sum((error**2 for error in of), 0 * work) for name, of in kinds.items()}
    whole = np.sqrt(sum(squares.values()))
    share = carried(ratio, whole) / np.where(whole > 0, whole, 1.0)
    return {
        name: np.maximum(error, share * np.sqrt(squares[name])) for name, error in columns.items()
    }
