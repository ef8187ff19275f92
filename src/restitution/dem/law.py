"""The restitution law of one pair: what was found at each impact velocity, and how far to trust it.

Between the velocities that were computed W_u/W_l is interpolated by a monotone cubic (PCHIP) in
ln V. Unlike e, the ratio passes smoothly through zero where the pair begins to stick (W_u < 0
below), so that velocity is found as well. Beyond the velocities that were computed there is no
answer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from restitution.errors import CaseError, DomainError, OutputError
from restitution.studies.quantities import read_positive

Array = NDArray[np.float64]

LAW_FILE = "law.json"


class _Stored(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Particle(_Stored):
    """One body of the pair. `radius` in m, None for a flat wall; other units are SI, too."""

    name: str
    radius: float | None
    youngs_modulus: float
    poissons_ratio: float
    density: float | None

    @property
    def wall(self) -> bool:
        """Whether it is a flat wall."""
        return self.radius is None

    def __str__(self) -> str:
        """Its name and size, as messages and comments show it."""
        size = "flat" if self.radius is None else f"R = {self.radius:.6g} m"
        return f"{self.name} ({size})"


class Point(_Stored):
    """What was found at one impact velocity.

    `ratio` is W_u/W_l, negative where the pair sticks; `error` is that of `restitution`.
    """

    velocity: float
    restitution: float
    error: float
    ratio: float
    loading_work: float
    indentation: float
    force: float
    pull_off_force: float | None
    resolved: bool


class CompactFit(_Stored):
    """e² = Σ c_k L^k − s/V², L = ln(V/V₀)/w, between `lowest` and `highest` velocity.

    Zero where that is negative and below `sticks_below`; 1 up to `elastic_below`. It is fitted to
    the points that are resolved; `worst` is the largest difference to them, `between` the largest
    at one that was left out of the fit.
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
        """Coefficient of restitution at `velocity` (m/s), a number or an array; no range check."""
        V = np.asarray(velocity, dtype=float)
        L = np.log(V / self.centre) / self.width
        e2 = np.polynomial.polynomial.polyval(L, self.coefficients) - self.adhesion / V**2
        e2 = np.clip(e2, 0.0, 1.0)
        if self.elastic_below is not None:
            e2 = np.where(self.elastic_below >= V, 1.0, e2)
        if self.sticks_below is not None:
            e2 = np.where(self.sticks_below >= V, 0.0, e2)
        found: Array = np.sqrt(e2)
        return found


class FittedLaw(_Stored):
    """A force law that DEM codes have, with the parameters that come nearest to ours.

    `parameters` are keyed with their units; `restitution` is what it gives at the velocities of
    the points, None where it has no answer; `rms` and `worst` are its differences to ours where
    ours is resolved.
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


@dataclass(frozen=True)
class Estimate:
    """The coefficient of restitution at one velocity, its error, and whether it was resolved."""

    restitution: float
    error: float
    resolved: bool


class Law(_Stored):
    """Coefficient of restitution against impact velocity for one pair, in SI units.

    `radius`, `contact_modulus`, `mass` are R*, E*, m*; `yield_velocity` and `sticking_velocity`
    those of the smooth bodies; `sticks_below` the velocity at which this pair begins to rebound.
    """

    title: str
    first: Particle
    second: Particle
    radius: float
    contact_modulus: float
    mass: float
    yield_pressure: float | None
    work_of_adhesion: float
    model: dict[str, str]
    conventions: dict[str, str]
    yield_velocity: float | None
    sticking_velocity: float | None
    sticks_below: float | None
    points: Annotated[tuple[Point, ...], Field(min_length=1)]
    fit: CompactFit | None = None
    laws: tuple[FittedLaw, ...] = ()
    warnings: tuple[str, ...] = ()
    case: str = ""
    versions: dict[str, str] = {}

    @property
    def lowest(self) -> float:
        """The lowest velocity that was computed, m/s."""
        return self.points[0].velocity

    @property
    def highest(self) -> float:
        """The highest velocity that was computed, m/s."""
        return self.points[-1].velocity

    def column(self, name: str, *, resolved: bool = False) -> Array:
        """One field of all points, as numbers; or of those that are resolved."""
        points = [point for point in self.points if point.resolved or not resolved]
        return np.array([getattr(point, name) for point in points], dtype=float)

    def at(self, velocity: float) -> Estimate:
        """The estimate at `velocity` (m/s).

        Its error is the larger of those of the neighbouring points, and what a straight line
        between them would give instead of the cubic. Raises `DomainError` beyond the velocities
        that were computed.
        """
        if not self.lowest * (1 - 1e-9) <= velocity <= self.highest * (1 + 1e-9):
            raise DomainError(
                f"velocity: {velocity:.6g} m/s is outside what was computed for {self.pair} "
                f"({self.lowest:.4g} to {self.highest:.4g} m/s), and nothing is extrapolated; "
                "compute the law further, or ask for a velocity within"
            )
        V = self.column("velocity")
        velocity = min(max(velocity, V[0]), V[-1])
        ratio, line = interpolate_ratio(V, self.column("ratio"), velocity)
        k = min(max(int(np.searchsorted(V, velocity)), 1), max(V.size - 1, 1))
        near = self.points[k - 1 : k + 1] if V.size > 1 else self.points
        on = [point for point in near if abs(point.velocity / velocity - 1) < 1e-9]
        if on:
            return Estimate(on[0].restitution, on[0].error, on[0].resolved)
        between = abs(_root(ratio) - _root(line))
        return Estimate(
            _root(ratio),
            max(point.error for point in near) + between,
            all(point.resolved for point in near),
        )

    @property
    def pair(self) -> str:
        """The names of the two bodies."""
        return f"{self.first} and {self.second}"


def interpolate_ratio(velocities: Array, ratios: Array, velocity: float) -> tuple[float, float]:
    """W_u/W_l at `velocity` by a monotone cubic in ln V, and by straight lines."""
    from scipy.interpolate import PchipInterpolator

    if velocities.size == 1:
        return float(ratios[0]), float(ratios[0])
    L, at = np.log(velocities), math.log(velocity)
    return float(PchipInterpolator(L, ratios)(at)), float(np.interp(at, L, ratios))


def crossing(velocities: Sequence[float], ratios: Sequence[float]) -> float | None:
    """The velocity (m/s) below which the pair sticks: where the ratio last rises through zero.

    None where no computed impact sticks, the highest velocity where all do.
    """
    sticking = [k for k, ratio in enumerate(ratios) if ratio <= 0]
    if not sticking:
        return None
    last = sticking[-1]
    if last == len(ratios) - 1:
        return velocities[last]
    from scipy.optimize import brentq

    V, r = np.array(velocities), np.array(ratios)

    def ratio(L: float) -> float:
        return interpolate_ratio(V, r, math.exp(L))[0]

    ends = math.log(velocities[last]), math.log(velocities[last + 1])
    return math.exp(brentq(ratio, *ends)) if ratio(ends[0]) < 0 else velocities[last]


def read_law(folder: Path) -> Law:
    """The law in `folder` (of `restitution law`). Raises `OutputError`, `CaseError`."""
    path = folder / LAW_FILE if folder.is_dir() else folder
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        raise OutputError(
            f"{folder}: holds no law ({LAW_FILE}); name the folder of -o of `restitution law`"
        ) from None
    try:
        return Law.model_validate_json(text)
    except ValidationError as error:
        where = ".".join(map(str, error.errors()[0]["loc"])) or "the whole"
        raise CaseError(
            f"{path}: is not a law of this version ({where} is wrong); make it again with "
            "`restitution law`"
        ) from None


def velocity_of(text: str) -> float:
    """A velocity of the command line, such as "0.5 m/s", in m/s. Raises `CaseError`."""
    try:
        return read_positive(text, "m/s")
    except ValueError as error:
        raise CaseError(f"velocity: {error}") from None


def _root(ratio: float) -> float:
    return math.sqrt(min(max(ratio, 0.0), 1.0))
