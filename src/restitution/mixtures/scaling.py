"""Interpolate the laws of all pairs of a family between laws at a few reduced radii R*.

W_u/W_l is interpolated at equal W_l/R*³, by a monotone cubic in ln R*. A leave-one-out residual can
be zero by chance, so the error is the largest of those at this velocity and the next ones.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from restitution.curve.interpolation import RatioCurve, root
from restitution.laws.compact_fit import compact_fit
from restitution.laws.law import Law, LawPoint, Quantiles
from restitution.losses.losses import NAMES
from restitution.mixtures.family import Family, ParticlePair

Array = NDArray[np.float64]

# An interpolation error of COR is accepted up to the limit given for the mixture. A larger error is
# accepted, too, if it is at most _MOST and also at most the error of the computed laws times
# _SHARE.
_SHARE, _MOST = 0.25, 0.05
_SAME = 1e-9  # largest relative difference of radii that count as equal


@dataclass(frozen=True)
class FamilyLaws:
    """The computed laws of a family, by increasing reduced radius."""

    family: Family
    laws: tuple[Law, ...]

    @cached_property
    def radii(self) -> Array:
        """Reduced radii of the laws (m), shape (radii,)."""
        return np.array([law.radius for law in self.laws])

    def has(self, radius: float) -> bool:
        """Whether a law was computed at the reduced `radius` (m)."""
        return bool((np.abs(self.radii / radius - 1) < _SAME).any())

    def is_good(self, pair: ParticlePair) -> bool:
        """Whether the law of the pair is accurate enough without a law at another reduced radius.

        Its interpolation error may be `interpolation_error` of the mixture, or a quarter of the
        error of the computed laws, at most 0.05.
        """
        points, errors = self._points(pair), self.interpolation_errors(pair)
        limit = self.family.mixture.interpolation_error
        return all(
            error <= max(limit, min(_SHARE * (point.error - error), _MOST))
            for point, error in zip(points, errors, strict=True)
        )

    def interpolation_errors(self, pair: ParticlePair) -> list[float]:
        """The error of COR due to interpolation in R*, at each velocity of the mixture."""
        curves = self._curves(pair)
        if self.has(pair.radius):
            return [0.0] * len(curves)
        return [
            _error_of(curve, pair.radius, curves[max(k - 1, 0) : k + 2])
            for k, curve in enumerate(curves)
        ]

    def law(self, pair: ParticlePair) -> Law:
        """The law of one pair at the velocities of the mixture, with its interpolation error."""
        nearest = self.laws[int(np.abs(np.log(self.radii / pair.radius)).argmin())]
        kappa = nearest.mass / nearest.radius**3
        slower = (pair.radius / nearest.radius) ** (2 / 3)
        slower *= math.sqrt(nearest.mass / pair.mass)
        how = "computed" if self.has(pair.radius) else "interpolated in R* at equal W/R*^3"
        harder = self._harder(pair, nearest)
        faster = math.sqrt(kappa / pair.kappa) * harder**2.5
        law = replace(
            nearest,
            title=self.family.mixture.title or self.family.name,
            first=pair.first,
            second=pair.second,
            radius=pair.radius,
            mass=pair.mass,
            model={**nearest.model, "pair": how},
            yield_pressure=_scaled(nearest.yield_pressure, harder),
            yield_velocity=_scaled(nearest.yield_velocity, faster),
            smooth_sticking_velocity=_scaled(nearest.smooth_sticking_velocity, slower),
            sticks_below_error=_scaled(nearest.sticks_below_error, slower),
            points=self._points(pair),
            fit=None,
            laws=(),
        )
        below = law.curve().begins() or _scaled(nearest.sticks_below, slower)
        law = replace(law, sticks_below=None if law.sticks_everywhere else below)
        return replace(law, fit=compact_fit(law))

    def _harder(self, pair: ParticlePair, than: Law) -> float:
        """Ratio of the yield pressures of smooth bodies; their squares are linear in 1/R*."""
        if than.yield_pressure is None:
            return 1.0
        squares = np.array([law.yield_pressure or math.inf for law in self.laws]) ** 2
        square = np.interp(-1 / pair.radius, -1 / self.radii, squares)
        return math.sqrt(square) / than.yield_pressure

    def _points(self, pair: ParticlePair) -> tuple[LawPoint, ...]:
        velocities, curves = self.family.mixture.velocities, self._curves(pair)
        errors = self.interpolation_errors(pair)
        return tuple(
            self._point(pair, V, curve, error)
            for V, curve, error in zip(velocities, curves, errors, strict=True)
        )

    def _curves(self, pair: ParticlePair) -> list[RatioCurve]:
        ratios = (
            np.array([law.curve().at(_of(law, V, pair)) for law in self.laws], dtype=float)
            for V in self.family.mixture.velocities
        )
        return [RatioCurve(self.radii, ratio, adhesive=False) for ratio in ratios]

    def _point(self, pair: ParticlePair, V: float, curve: RatioCurve, between: float) -> LawPoint:
        ratio = _value(curve, pair.radius)
        after, t = curve.interval(pair.radius) if len(self.laws) > 1 else (1, 0.0)
        laws = self.laws[after - 1 : after + 1]
        shares = (1 - t, t)[: len(laws)]
        estimates = [law.at(_of(law, V, pair)) for law in laws]
        used = [k for k, share in enumerate(shares) if share > _SAME]

        def mean(name: str, power: int) -> float:
            """Interpolate the field `name` over R*^power between the laws at the next R*."""
            R = pair.radius
            return R**power * sum(
                shares[k]
                * _column_at(laws[k], name, _of(laws[k], V, pair))
                / laws[k].radius ** power
                for k in used
            )

        def factor(name: str) -> float | None:
            known = [name in point.factors for law in laws for point in law.points]
            if not all(known):
                return None
            return sum(shares[k] * _factor_at(laws[k], name, _of(laws[k], V, pair)) for k in used)

        def quantiles() -> Quantiles | None:
            if any(point.quantiles is None for law in laws for point in law.points):
                return None
            table = sum(shares[k] * _quantiles_at(laws[k], _of(laws[k], V, pair)) for k in used)
            return cast(Quantiles, tuple(np.asarray(table).tolist()))

        factors = {name: of for name in NAMES if (of := factor(name)) is not None}
        pull_off = [point.pull_off_force for law in laws for point in law.points]
        return LawPoint(
            velocity=V,
            restitution=root(ratio),
            error=sum(shares[k] * estimates[k].error for k in used) + between,
            ratio=ratio,
            loading_work=0.5 * pair.mass * V * V,
            indentation=mean("indentation", 1),
            force=mean("force", 2),
            pull_off_force=None if None in pull_off else mean("pull_off_force", 1),
            resolved=all(estimates[k].resolved for k in used),
            quasi_static=_quasi_static(root(ratio), factors),
            factors=factors,
            deviation=None if self.laws[0].coverage is None else mean("deviation", 0),
            quantiles=quantiles(),
        )


def _of(law: Law, V: float, pair: ParticlePair) -> float:
    """Velocity (m/s) at which W/R*³ of `law` equals that of `pair` at `V` (m/s).

    The nearest velocity of `law` if it is outside by at most 1e-3.
    """
    velocity = V * math.sqrt(pair.kappa / (law.mass / law.radius**3))
    near = law.lowest * (1 - 1e-3) <= velocity <= law.highest * (1 + 1e-3)
    return min(max(velocity, law.lowest), law.highest) if near else velocity


def _value(curve: RatioCurve, radius: float) -> float:
    return float(curve.at(min(max(radius, curve.velocities[0]), curve.velocities[-1])))


def _error_of(curve: RatioCurve, radius: float, near: list[RatioCurve]) -> float:
    ratio = _value(curve, radius)
    off = max(other.error(radius) for other in near)
    e = root(ratio)
    return max(abs(root(ratio + off) - e), abs(e - root(ratio - off)))


def _column_at(law: Law, name: str, velocity: float) -> float:
    """The field `name` at `velocity` (m/s): a power of it or, if not positive, linear in ln V."""
    L, values = np.log(law.column("velocity")), law.column(name)
    if (values <= 0).any():
        return float(np.interp(math.log(velocity), L, values))
    return math.exp(np.interp(math.log(velocity), L, np.log(values)))


def _factor_at(law: Law, name: str, velocity: float) -> float:
    L, values = np.log(law.column("velocity")), [point.factors[name] for point in law.points]
    return float(np.interp(math.log(velocity), L, values))


def _quantiles_at(law: Law, velocity: float) -> Array:
    L, x = np.log(law.column("velocity")), math.log(velocity)
    table = np.array([point.quantiles for point in law.points], dtype=float).T
    return np.array([np.interp(x, L, values) for values in table])


def _quasi_static(restitution: float, factors: Mapping[str, float]) -> float:
    product = math.prod(factors.values())
    return min(restitution / product, 1.0) if product > 0 else restitution


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor
