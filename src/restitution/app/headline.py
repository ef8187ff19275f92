"""The numbers at the top of the page: e(V) between the points, pull-off force and sticking."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from restitution.curve.columns import array
from restitution.curve.curve import Curve
from restitution.curve.point import Point
from restitution.errors import DomainError

_FINE = 160  # velocities between the lowest and the highest
_JUMP = 8  # velocities just above the one at which the pair begins to rebound


def headline(points: Sequence[Point], sticking: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """`between`: e and its errors at many velocities (m/s), interpolated as in a restitution law.

    `sticking` is that of `summary.json`. Empty if no velocity is known.
    """
    curve = Curve(tuple(points))
    try:
        low, high = curve.velocities
    except DomainError:
        return {}
    known = [point for point in curve.impacts.points if point.impact_velocity > 0]
    V = np.unique([*np.geomspace(low, high, _FINE), *(p.impact_velocity for p in known)])
    V = V.clip(low, high)
    e = curve.with_losses_at(V)
    if e[0] == 0 and e[-1] > 0:  # resolve the jump
        first = int(np.flatnonzero(e > 0)[0])
        V = np.insert(V, first, np.geomspace(V[first - 1], V[first], _JUMP + 2)[1:-1])
        e = curve.with_losses_at(V)
    at, log = np.log(array(known, "impact_velocity")), np.log(V)
    errors = {
        name: np.interp(log, at, array(known, name)) for name in ("total_error", "model_error")
    }
    return {
        "between": {
            "velocity": V.tolist(),
            "restitution": e.tolist(),
            "quasi_static": curve.at(V).tolist(),
            **{name: values.tolist() for name, values in errors.items()},
        },
        "sticking": dict(sticking or {}),
    }
