"""Recognise axes in the first line and the first column of a matrix."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restitution.surfaces.surface import Array

_LEAST = 4  # smallest number of points of an axis
_EVEN = 1e-2  # largest relative difference between the steps of an axis, whose values are rounded


@dataclass(frozen=True)
class Axes:
    """The steps of the axes of x and y, in an unknown unit."""

    x: float
    y: float

    @property
    def steps(self) -> str:
        """The steps in words."""
        return f"steps of {self.x:.6g} along x and {self.y:.6g} along y, in a unit not stated"

    def notice(self, path: Path) -> str:
        """What was done with the axes."""
        return (
            f"{path}: the first line and the first column are taken for the axes of x and y "
            f"({self.steps}) and left out of the heights"
        )


def axes_of(values: Array) -> Axes | None:
    """The axes of a matrix of lines; None if its first line and column are heights.

    Both must have even steps, and their neighbours, the first line and column of heights, must not
    both have them: in a plane, all lines and columns have even steps.
    """
    if min(values.shape) <= _LEAST:
        return None
    x, y = _step(values[0, 1:]), _step(values[1:, 0])
    if x is None or y is None or (_step(values[1, 1:]) and _step(values[1:, 1])):
        return None
    return Axes(abs(x), abs(y))


def _step(points: Array) -> float | None:
    """The step of evenly spaced points; None if they are uneven, equal or undefined."""
    if not np.isfinite(points).all():
        return None
    steps = np.diff(points)
    step = float(steps.mean())
    return step if step and np.abs(steps - step).max() <= _EVEN * abs(step) else None
