"""Parts shared by all figures of COR: the axes, and the bars of the total error."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from restitution.plots.figure import Array, Axis, Band, Chart, Mark, Points, Series, has_error

_STEP = 0.1  # the limits of the axis are multiples of this value
_MARGIN = 0.02  # smallest distance of the values from the ends of the axis


class Abscissa(NamedTuple):
    """The x axis of a COR figure: `variable` of a dataset and of `Point`, times `scale`."""

    name: str
    variable: str
    scale: float
    axis: Axis


INDENTATION = Abscissa(
    "indentation",
    "indentation",
    1e6,
    Axis("maximum indentation", "µm", "log"),
)
IMPACT_VELOCITY = Abscissa(
    "velocity",
    "impact_velocity",
    1.0,
    Axis("impact velocity", "m/s", "log"),
)


def cor_axis(series: Sequence[Series]) -> Axis:
    """Make an axis of COR that spans `series` and their error bars."""
    shown: Array = np.concatenate([np.ravel(y) for part in series for y in _values(part)])
    values = shown[np.isfinite(shown)] if np.isfinite(shown).any() else np.array([0.0, 1.0])
    low = max(_STEP * np.floor((values.min() - _MARGIN) / _STEP), 0.0)
    high = _STEP * np.ceil((values.max() + _MARGIN) / _STEP)
    # The margin keeps lines at COR = 0 (sticking) and at COR = 1 (elastic) visible.
    return Axis(
        "coefficient of restitution",
        low=-_MARGIN if values.min() <= 0 else float(low),
        high=float(high) if high < 1 else 1 + _MARGIN,
    )


def cor_chart(x: Axis, series: Sequence[Series], title: str = "") -> Chart:
    return Chart(x, cor_axis(series), series, title)


def bars(cor: Array, error: Array) -> tuple[Array, str]:
    """Lengths of the error bars below and above `cor`, shape (2, n), and a legend text."""
    lengths = np.clip([np.minimum(error, cor), np.minimum(error, 1 - cor)], 0, None)
    cut = bool((error > lengths + 1e-12).any())
    return lengths, "total error (cut at 0 and 1)" if cut else "total error"


_ONSET = 40  # number of points of a curve above the sticking velocity


def onset(V: Array, e: Array) -> tuple[Array, Array]:
    """Velocities and COR of a curve between the last point that sticks and the first rebound.

    The energy loss L is that of the first rebound, e² = 1 − 2 L/(m* V²) (Thornton & Ning 1998), so
    that COR rises at the sticking velocity like a step. Empty if COR is nowhere 0 before a rebound.
    """
    steps = np.flatnonzero((e[:-1] <= 0) & (e[1:] > 0))
    if not steps.size:
        return np.empty(0), np.empty(0)
    last, first = V[steps[-1]], V[steps[-1] + 1]
    sticks = first * np.sqrt(1 - e[steps[-1] + 1] ** 2)
    begins = max(float(last), float(sticks))
    x = begins + (first - begins) * np.linspace(0, 1, _ONSET, endpoint=False) ** 2
    y = np.sqrt(np.maximum(1 - (sticks / x) ** 2, 0.0))
    return np.insert(x, 0, begins), np.insert(y, 0, 0.0)


def _values(part: Series) -> Iterable[Array]:
    if isinstance(part, Band):
        return part.low, part.high
    if isinstance(part, Mark):
        return ()
    if isinstance(part, Points) and part.error is not None and has_error(part):
        below, above = np.broadcast_to(part.error, (2, np.size(part.y)))
        return part.y, part.y - below, part.y + above
    return (part.y,)
