"""The restitution law of one pair: COR at each computed impact velocity, with its error."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, TypeAdapter, model_validator
from pydantic.dataclasses import dataclass as checked_dataclass

from restitution.case.quantities import read_positive
from restitution.curve.interpolation import RatioCurve, root
from restitution.display import counted, quantity, summary_html, summary_text, with_error
from restitution.errors import CaseError, DomainError
from restitution.laws.particle import STRICT, NotNegative, Particle, Positive, Share
from restitution.losses.losses import NAMES

Array = NDArray[np.float64]
Quantiles = tuple[Share, Share, Share, Share, Share]
QUANTILES = (5, 25, 50, 75, 95)
"""The quantiles (%) of a distribution of COR."""

LOSS = 1e-3
"""A law is not fitted if e, or 1 − e, is below this value at every velocity."""
# Largest relative difference of velocities that count as equal. If a run integrates the loading
# work numerically, it reaches the velocities of its case only to within 1e-4 (`solve_at_velocity`).
_SAME = 1.01e-4


@checked_dataclass(frozen=True, kw_only=True, config=STRICT)
class LawPoint:
    """The result at one impact velocity, in SI units.

    `ratio` is W_u/W_l, unloading work over loading work; zero or negative if the pair sticks.
    `error` is that of `restitution`; `indentation` and `force` are the maxima of the impact, and
    `separation` the indentation at which the bodies separate. `restitution` is `quasi_static` times
    `factors`, those of the losses (`losses.NAMES`), and `loss_error` is the part of `error` due to
    this product; laws of older versions have neither.
    `deviation` and `quantiles` (5, 25, 50, 75 and 95 %) are those of COR over places of the
    surfaces; None if it was not measured at several.
    """

    velocity: Positive
    restitution: Share
    error: NotNegative
    ratio: float
    loading_work: Positive
    indentation: float
    force: float
    pull_off_force: float | None
    pull_off_error: NotNegative | None = None
    separation: float | None = None
    resolved: bool
    quasi_static: Share | None = None
    factors: dict[str, Share] = field(default_factory=dict)
    loss_error: NotNegative | None = None
    deviation: NotNegative | None = None
    quantiles: Quantiles | None = None

    @model_validator(mode="after")
    def _one_number(self) -> Self:
        if abs(self.restitution - root(self.ratio)) > 1e-6:
            raise ValueError("restitution: is not the square root of ratio")
        return self


@checked_dataclass(frozen=True, kw_only=True, config=STRICT)
class CoveredPoint:
    """COR at one velocity after impacts that have covered the surfaces `coverage` times.

    The fields are those of `LawPoint`, as means over places of the surfaces.
    """

    velocity: Positive
    coverage: NotNegative
    restitution: Share
    error: NotNegative
    deviation: NotNegative
    quantiles: Quantiles
    indentation: float
    force: float
    pull_off_force: float


@checked_dataclass(frozen=True, kw_only=True, config=STRICT)
class CompactFit:
    """Fit e² = Σ c_k L^k − s/V², L = ln(V/V₀)/w, from `lowest` to `highest` velocity (m/s).

    `coefficients` are c_k, `centre` is V₀, `width` is w and `adhesion` is s (m²/s²). e is 0 for V ≤
    `sticks_below` and where the formula is negative, and 1 for V ≤ `elastic_below`. At
    `adhesive_below`, adhesion lowers e² by 0.01. Only points that the grid resolves are fitted:
    `worst` is the largest difference at them, and `between` estimates the largest error between
    them, from `worst` and the leave-one-out residuals.
    """

    coefficients: tuple[float, ...]
    centre: float
    width: float
    adhesion: float
    sticks_below: float | None
    elastic_below: float | None
    adhesive_below: float | None
    lowest: float
    highest: float
    worst: float
    between: float

    def restitution(self, velocity: ArrayLike) -> Array:
        """COR at `velocity` (m/s, any shape); NaN outside `lowest` to `highest`."""
        V = np.asarray(velocity, dtype=float)
        L = np.log(V / self.centre) / self.width
        polynomial = np.polynomial.polynomial.polyval(L, self.coefficients)
        e2 = np.clip(polynomial - self.adhesion / V**2, 0.0, 1.0)
        if self.elastic_below is not None:
            e2 = np.where(self.elastic_below >= V, 1.0, e2)
        if self.sticks_below is not None:
            e2 = np.where(self.sticks_below >= V, 0.0, e2)
        inside = (self.lowest * (1 - _SAME) <= V) & (self.highest * (1 + _SAME) >= V)
        return np.where(inside, np.sqrt(e2), np.nan)


@checked_dataclass(frozen=True, kw_only=True, config=STRICT)
class FittedLaw:
    """A force law of DEM codes, fitted to the computed COR.

    The keys of `parameters` end with the units. `restitution` is its COR at the computed
    velocities; None where it has no solution, and outside `Law.fitted_range`. `rms` and `worst` are
    differences from the computed COR at resolved points, and `pull_off_misfit` the largest relative
    difference from the computed pull-off force; None if it was not fitted to it.
    """

    name: str
    source: str
    fitted_to: str
    parameters: dict[str, float]
    ends: str
    restitution: tuple[float | None, ...]
    rms: float
    worst: float
    note: str = ""
    pull_off_misfit: float | None = None


@checked_dataclass(frozen=True, kw_only=True, config=STRICT)
class Conventions:
    """Definitions of the quantities of a law, in words."""

    end_of_contact: str
    indentation_zero: str
    restitution: str
    yield_pressure: str
    restitution_error: str


@dataclass(frozen=True)
class Estimate:
    """COR at one velocity, its error, and whether the grid resolves the contact."""

    restitution: float
    error: float
    resolved: bool


@checked_dataclass(frozen=True, kw_only=True, config=STRICT)
class Law:
    """Coefficient of restitution against impact velocity for one pair, in SI units.

    `radius`, `contact_modulus` and `mass` are R*, E* and m*. `friction` is the coefficient of the
    case; e does not depend on it. Smooth bodies yield above `yield_velocity`, and smooth elastic
    bodies stick up to `smooth_sticking_velocity`. This pair rebounds above `sticks_below`; None if
    it sticks at no velocity, or at every computed one. `points` are those of the first impact, or
    at a `coverage` of the surfaces by earlier impacts, for which `run_in` has the data.
    """

    title: str
    first: Particle
    second: Particle
    radius: Positive
    contact_modulus: Positive
    mass: Positive
    yield_pressure: Positive | None
    work_of_adhesion: NotNegative
    friction: NotNegative | None = None
    model: dict[str, str]
    conventions: Conventions
    yield_velocity: float | None
    smooth_sticking_velocity: float | None
    sticks_below: float | None
    sticks_below_error: float | None = None
    points: Annotated[tuple[LawPoint, ...], Field(min_length=1)]
    coverage: NotNegative | None = None
    run_in: tuple[CoveredPoint, ...] = ()
    fit: CompactFit | None = None
    laws: tuple[FittedLaw, ...] = ()
    warnings: tuple[str, ...] = ()
    case: str = ""
    versions: dict[str, str] = field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _of_older_versions(cls, stored: Any) -> Any:
        if isinstance(stored, dict) and "sticking_velocity" in stored:
            stored["smooth_sticking_velocity"] = stored.pop("sticking_velocity")
        return stored

    @model_validator(mode="after")
    def _holds_together(self) -> Self:
        if not (np.diff(self.column("velocity")) > 0).all():
            raise ValueError("points: velocities must increase")
        if self.first.wall and self.second.wall:
            raise ValueError("first, second: both bodies are flat")
        bodies = self.first, self.second
        R = 1 / sum(1 / body.radius for body in bodies if body.radius is not None)
        if abs(self.radius / R - 1) > 1e-6:
            raise ValueError("radius: is not the reduced radius R* of the two bodies")
        return self

    @property
    def lowest(self) -> float:
        """The lowest computed velocity (m/s)."""
        return self.points[0].velocity

    @property
    def highest(self) -> float:
        """The highest computed velocity (m/s)."""
        return self.points[-1].velocity

    @property
    def fitted_range(self) -> tuple[float, float] | None:
        """Lowest and highest resolved velocity (m/s), the range of all fits; None without one."""
        V = self.column("velocity", resolved=True)
        return (float(V[0]), float(V[-1])) if V.size else None

    def fits_hold_at(self, velocity: ArrayLike) -> NDArray[np.bool_]:
        """Whether `velocity` (m/s, any shape) lies within `fitted_range`."""
        V = np.asarray(velocity, dtype=float)
        low, high = self.fitted_range or (math.inf, -math.inf)
        return np.asarray((low * (1 - _SAME) <= V) & (high * (1 + _SAME) >= V))

    def column(self, name: str, *, resolved: bool = False) -> Array:
        """Values of the field `name`, shape (points,); only of `resolved` points if asked for."""
        points = [point for point in self.points if point.resolved or not resolved]
        return np.array([getattr(point, name) for point in points], dtype=float)

    def at(self, velocity: float) -> Estimate:
        """Interpolate COR at `velocity` (m/s).

        The error is that of the points, linear in ln V, plus that of the interpolation
        (`RatioCurve.error`). Raises `DomainError` outside the computed velocities.
        """
        if not self.lowest * (1 - _SAME) <= velocity <= self.highest * (1 + _SAME):
            raise DomainError(
                f"velocity: {velocity:.6g} m/s is outside the computed velocities of {self.pair} "
                f"({self.lowest:.4g} to {self.highest:.4g} m/s), and nothing is extrapolated; "
                "choose a velocity in this range, or compute a law for more velocities"
            )
        nearest = min(self.points, key=lambda point: abs(point.velocity / velocity - 1))
        if abs(nearest.velocity / velocity - 1) <= _SAME:
            return Estimate(nearest.restitution, nearest.error, nearest.resolved)
        curve = self.curve()
        ratio, off = curve.at(velocity), curve.error(velocity)
        after, share = curve.interval(velocity)
        below, above = self.points[after - 1 : after + 1]
        e = root(ratio)
        between = max(abs(root(ratio + off) - e), abs(e - root(ratio - off)))
        return Estimate(
            e,
            (1 - share) * below.error + share * above.error + between,
            below.resolved and above.resolved,
        )

    def restitution(self, velocity: ArrayLike) -> Array:
        """COR at `velocity` (m/s, any shape), as by `at`. Raises `DomainError`."""
        V = np.asarray(velocity, dtype=float)
        e = [self.at(v).restitution for v in V.ravel().tolist()]
        return np.asarray(np.reshape(e, V.shape)[()])

    @property
    def losses(self) -> tuple[str, ...]:
        """Names of the losses that lower the restitution at any velocity."""
        return tuple(
            name for name in NAMES if any(point.factors.get(name, 1.0) < 1 for point in self.points)
        )

    def curve(self) -> RatioCurve:
        """W_u/W_l, interpolated between the velocities."""
        return RatioCurve(
            self.column("velocity"), self.column("ratio"), adhesive=self.work_of_adhesion > 0
        )

    @property
    def sticking(self) -> str:
        """`sticks_below` with its error, in words."""
        if self.sticks_below is None:
            return "unknown"
        if self.sticks_below_error is None:
            return quantity(self.sticks_below, "m/s")
        return with_error(self.sticks_below, self.sticks_below_error, "m/s")

    @property
    def sticks_everywhere(self) -> bool:
        """Whether the pair sticks at every computed velocity."""
        return all(point.ratio <= 0 for point in self.points)

    @property
    def pair(self) -> str:
        """The names of the two bodies."""
        return f"{self.first} and {self.second}"

    def _summary(self) -> list[str]:
        low, high = quantity(self.lowest, "m/s"), quantity(self.highest, "m/s")
        e = self.column("restitution")
        parts = [
            f"sticks below {self.sticking}" if self.sticks_below else "",
            f"fits: {', '.join(fit.name for fit in self.laws)}" if self.laws else "not fitted",
            counted(len(self.warnings), "warning") if self.warnings else "",
        ]
        return [
            self.pair,
            f"COR {e.min():.4f} to {e.max():.4f} at {len(e)} velocities, {low} to {high}",
            "; ".join(filter(None, parts)),
        ]

    __repr__ = __str__ = summary_text
    _repr_html_ = summary_html


STORED_LAW = TypeAdapter(Law)
"""Reads and writes a `Law` as JSON."""


def velocity_of(text: str) -> float:
    """The velocity (m/s) that a text such as "0.5 m/s" gives. Raises `CaseError`."""
    try:
        return read_positive(text, "m/s")
    except ValueError as error:
        raise CaseError(f"velocity: {error}") from None
