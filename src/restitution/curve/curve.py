"""The curve e(V) of one pair."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from restitution.curve.columns import Array, array
from restitution.curve.interpolation import RatioCurve, root
from restitution.curve.point import PARTS, Point
from restitution.display import counted, quantity, summary_html, summary_text
from restitution.errors import DomainError

_SAME = 1e-9


@dataclass(frozen=True)
class UnloadingCurve:
    """An unloading curve that begins at the depth `start` (m).

    `indentation` (m) and `force` (N) are its points, sorted by increasing indentation.
    """

    start: float
    indentation: Array
    force: Array

    def _summary(self) -> list[str]:
        return [f"{counted(self.force.size, 'point')} from {quantity(self.start, 'm')}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


@dataclass(frozen=True)
class Curve:
    """COR, force and works at increasing depths, with their errors.

    The name of a field of `Point` is an attribute, too: the array of its values, shape (points,).

    Attributes:
        points: Results at each depth.
    """

    points: tuple[Point, ...] = ()

    def __getattr__(self, name: str) -> Array:
        # `pickle` looks for special methods before there are points.
        kind = type(self.points[0]) if not name.startswith("_") and self.points else Point
        if name not in {part.name for part in fields(kind)}:
            raise AttributeError(f"a curve has no {name}")
        return array(self.points, name)

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The rows of `curve.csv`: dictionaries with its headers as keys."""
        return [point.cells() for point in self.points]

    @property
    def impacts(self) -> Curve:
        """The points with positive loading work: an impact has this depth."""
        return Curve(tuple(point for point in self.points if point.loading_work > 0))

    def at(self, velocity: ArrayLike) -> Array:
        """COR at `velocity` (m/s, any shape), interpolated between the points (`RatioCurve`).

        Raises:
            DomainError: A velocity lies outside the computed ones; nothing is extrapolated.
        """
        return self._at(velocity, "ratio")

    def with_losses_at(self, velocity: ArrayLike) -> Array:
        """As `at`, with plates, waves and viscosity (`Point.final`)."""
        return self._at(velocity, "final_ratio")

    def _at(self, velocity: ArrayLike, name: str) -> Array:
        V = np.asarray(velocity, dtype=float)
        span, curve = self.velocities, self._ratios(name)
        if not ((span[0] * (1 - _SAME) <= V) & (span[1] * (1 + _SAME) >= V)).all():
            low, high = (quantity(end, "m/s") for end in span)
            raise DomainError(
                f"velocity: outside the computed velocities, {low} to {high}, and nothing is "
                "extrapolated; choose velocities in this range, or compute more of them"
            )
        inside = np.clip(V.ravel(), *span)
        e = [root(curve.at(v)) for v in inside.tolist()]
        return np.asarray(np.reshape(e, V.shape)[()])

    @property
    def velocities(self) -> tuple[float, float]:
        """The lowest and the highest impact velocity (m/s).

        Raises:
            DomainError: No point has an impact velocity.
        """
        known = self._moving()
        if not known:
            raise DomainError("no impact velocities are known; give the densities of the bodies")
        return known[0].impact_velocity, known[-1].impact_velocity

    @property
    def errors(self) -> dict[str, Array]:
        """The parts of the total error of COR, and the total and model errors, by name."""
        return {name: array(self.points, name) for name in (*PARTS, "total_error", "model_error")}

    def _moving(self) -> list[Point]:
        moving: list[Point] = []
        for point in self.impacts.points:
            if point.impact_velocity > (moving[-1].impact_velocity if moving else 0.0):
                moving.append(point)
        return moving

    def _ratios(self, name: str) -> RatioCurve:
        known = self._moving()
        adhesive = any(point.pull_off_force != 0 for point in known)
        return RatioCurve(array(known, "impact_velocity"), array(known, name), adhesive=adhesive)

    def _summary(self) -> list[str]:
        e = self.restitution[np.isfinite(self.restitution)] if self.points else np.empty(0)
        span = f": COR {e.min():.4f} to {e.max():.4f}" if e.size else ""
        return [f"{counted(len(self.points), 'point')}{span}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


def largest(points: Iterable[Point], name: str) -> float | None:
    """Largest value of the field `name`; None if no point has one."""
    values = (getattr(point, name) for point in points)
    return max((value for value in values if not math.isnan(value)), default=None)


def largest_part(points: Sequence[Point]) -> str:
    """Name of the part of the total error with the largest root mean square over the points.

    Points without a total error are ignored. A missing part counts as zero.
    """
    known = [point for point in points if not math.isnan(point.total_error)]

    def squares(name: str) -> float:
        return float(np.nansum(array(known, name) ** 2)) if known else 0.0

    return max(PARTS, key=squares)


def loses(points: Iterable[Point]) -> bool:
    """Whether plates, waves or viscosity lower the restitution of any point."""
    return any(point.restitution_with_losses < point.restitution for point in points)
