"""The stored force law of a run: loading, and unloading from some depths.

The loading force is the derivative of a cubic Hermite spline through the loading work W, so bodies
stop where W is their energy. Unloading curves (PCHIP) are interpolated between the stored depths as
F/F_max against (δ − δ_s)/(δ_max − δ_s), with the indentation δ_s at separation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from restitution.contact.bodies import Pair
from restitution.curve.columns import Array
from restitution.curve.curve import UnloadingCurve
from restitution.display import quantity
from restitution.errors import CaseError, DomainError, OutputError, RestitutionError
from restitution.losses.losses import Losses
from restitution.results.reader import RunResults
from restitution.results.tables import damaged

Force = Callable[[float], float]

# ln W is interpolated against ln δ only if the exponent n in W ∝ δⁿ is below this value (W is the
# loading work). A larger n means that W is nearly zero, because the bodies attract each other.
_STEEPEST = 6.0
_COLUMNS = ("indentation", "force", "loading_work", "impact_velocity", "separation_indentation")
_SAME = 1e-5  # largest relative difference of depths that count as equal


@dataclass(frozen=True, eq=False)
class StoredRoughness:
    """Roughness of a stored contact.

    `patches` is the number of contact patches at the indentations `depths` (m). `lay` is the
    anisotropy of the slopes: 0 if equal in all directions, 1 if all are along one axis.
    """

    depths: Array
    patches: Array
    lay: float


@dataclass(frozen=True)
class StoredForce:
    """The stored force law of one pair: loading, and unloading from some depths.

    `deepest` is the largest indentation (m) with a stored force, and `highest` the impact velocity
    (m/s) that reaches it. `loading` maps indentation (m) to force (N), `separation` maximum
    indentation (m) to the indentation at separation (m). `unloading` has one curve for each depth
    of `unloading_from` (m, increasing): increasing indentations (m) and forces (N). `roughness` is
    None for smooth bodies. `losses` act in addition to the stored forces.
    """

    pair: Pair
    deepest: float
    highest: float
    loading: Force
    separation: Callable[[float], float]
    unloading_from: Array
    unloading: tuple[tuple[Array, Array], ...]
    roughness: StoredRoughness | None = None
    losses: Losses = field(default_factory=Losses)

    def __post_init__(self) -> None:
        if self.pair.mass is None:
            raise CaseError("density: is missing; integrating a collision in time needs the masses")

    def branch(self, deepest: float) -> tuple[Force, float, bool]:
        """Force of unloading from `deepest` (m), end of contact (m), and whether it is blended.

        Raises `DomainError` if `deepest` is outside the depths of the stored curves.
        """
        depths = self.unloading_from
        if not depths[0] * (1 - _SAME) <= deepest <= depths[-1] * (1 + _SAME):
            raise DomainError(
                f"the impact reaches a depth of {quantity(deepest, 'm')}, but unloading curves are "
                f"stored only from {quantity(depths[0], 'm')} to {quantity(depths[-1], 'm')} and "
                "are not extrapolated; give a larger unloading.curves, or choose another velocity"
            )
        end, largest = self.separation(deepest), self.loading(deepest)
        shape, blended = self.shape(deepest)
        return lambda x: largest * shape((x - end) / (deepest - end)), end, blended

    def shape(self, deepest: float) -> tuple[Callable[[Any], Any], bool]:
        """F/F_max against (δ − δ_s)/(δ_max − δ_s) from `deepest` (m), and whether it is blended.

        Outside the stored depths, the nearest stored curve gives the shape.
        """
        below, above, share = self.neighbours(deepest)
        upper = _shape(*self.unloading[above])
        if below == above:
            return upper, False
        lower = _shape(*self.unloading[below])
        return lambda s: (1 - share) * lower(s) + share * upper(s), True

    def neighbours(self, deepest: float) -> tuple[int, int, float]:
        """Numbers of the stored curves around `deepest` (m), and the share of the second."""
        depths = self.unloading_from
        near = np.flatnonzero(np.abs(depths / deepest - 1) < _SAME)
        after = int(near[0]) if near.size else int(np.searchsorted(depths, deepest))
        if near.size or after in (0, depths.size):
            only = min(after, depths.size - 1)
            return only, only, 1.0
        below = depths[after - 1]
        return after - 1, after, math.log(deepest / below) / math.log(depths[after] / below)


def stored_force(out: Path | RunResults) -> StoredForce:
    """Make the force law of a run, or of that in a folder. Raises `OutputError`, `CaseError`."""
    if isinstance(out, RunResults):
        run, out = out, out.folder or Path("the results")
    elif not (out / "results.nc").exists():
        raise OutputError(
            f"{out}: holds no results of a run; give the folder that `restitution run` wrote"
        )
    else:
        run = RunResults(out)
    if not run.unloading:
        raise OutputError(
            f"{out}: holds no unloading curves; run the case with unloading.curves of 1 or more "
            "(for an ensemble, give the folder of one realisation)"
        )
    try:
        force = force_of(run.case.pair(), run.dataset, run.unloading)
        return replace(force, losses=run.case.losses())
    except (ValueError, KeyError, IndexError, TypeError) as error:
        if isinstance(error, RestitutionError):
            raise
        raise damaged(out / "results.nc", f"{type(error).__name__}: {error}") from None


def force_of(pair: Pair, results: xr.Dataset, unloading: Sequence[UnloadingCurve]) -> StoredForce:
    """The force law of `pair` from the results of a run and its unloading curves, by `start`.

    `results` has the variables of `results.nc`, including `height`, `x` and `y`. Raises
    `OutputError` if no unloading reaches separation, and `CaseError` if `pair` has no mass.
    """
    depth = results["indentation"].values
    force = force_of_columns(pair, {name: results[name].values for name in _COLUMNS}, unloading)
    return replace(force, roughness=_roughness(results, depth))


def force_of_columns(
    pair: Pair, columns: Mapping[str, Array], unloading: Sequence[UnloadingCurve]
) -> StoredForce:
    """As `force_of`, from the arrays of a curve named in `_COLUMNS`, without roughness."""
    depth, force, work, velocity, separation = (columns[name] for name in _COLUMNS)
    return StoredForce(
        pair=pair,
        deepest=float(depth[-1]),
        highest=float(np.nanmax(velocity)),
        loading=loading_force(depth, force, work),
        separation=_separation(separation, depth),
        unloading_from=np.array([curve.start for curve in unloading]),
        unloading=tuple((curve.indentation, curve.force) for curve in unloading),
    )


def _roughness(results: xr.Dataset, depth: Array) -> StoredRoughness | None:
    height = results["height"].values
    if not np.ptp(height) > 0:
        return None
    x, y = results["x"].values, results["y"].values
    along_x, along_y = np.gradient(height, x, y)
    xx, yy, xy = (
        float(np.mean(product)) for product in (along_x**2, along_y**2, along_x * along_y)
    )
    lay = math.hypot(xx - yy, 2 * xy) / (xx + yy)
    return StoredRoughness(depth, results["contact_patches"].values, lay)


def loading_force(depth: Array, force: Array, work: Array) -> Force:
    """The force (N) at any indentation (m); its integral is the `work` (J) at each `depth` (m)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        powers = force * depth / work
    if (work > 0).all() and (powers > 0.5).all() and (powers < _STEEPEST).all():
        # ln W is interpolated against ln δ. From δ = 0 to the first stored depth, ln W is linear in
        # ln δ, so W is a power of δ.
        L, slope = np.log(depth), powers
        log_work = _hermite(L, np.log(work), slope)
        first = float(L[0])

        def pushing(x: float) -> float:
            if x <= 0:
                return 0.0
            at = math.log(x)
            if at <= first:
                return float(slope[0] * work[0] / x * math.exp(slope[0] * (at - first)))
            value, exponent = log_work(at)
            return math.exp(value) / x * exponent

        return pushing
    # W is not a power of δ, usually because of adhesion. Up to the first stored depth, the force is
    # assumed to be linear in δ. The force at δ = 0 is chosen such that the work up to the first
    # depth equals the stored work.
    jump_in = 2 * work[0] / depth[0] - force[0]
    curve = _hermite(np.append(0.0, depth), np.append(0.0, work), np.append(jump_in, force))
    return lambda x: curve(max(x, 0.0))[1]


def _hermite(x: Array, y: Array, slope: Array) -> Callable[[float], tuple[float, float]]:
    """Value and slope of a cubic Hermite spline, which goes on as a straight line."""
    from scipy.interpolate import CubicHermiteSpline

    if x.size == 1:
        return lambda at: (float(y[0] + slope[0] * (at - x[0])), float(slope[0]))
    curve = CubicHermiteSpline(x, y, slope)
    rate = curve.derivative()
    last = float(x[-1])

    def at(where: float) -> tuple[float, float]:
        inside = min(where, last)
        slope_there = float(rate(inside))
        return float(curve(inside)) + slope_there * (where - inside), slope_there

    return at


def _separation(separation: Array, depth: Array) -> Callable[[float], float]:
    ratio = separation / depth
    known = np.isfinite(ratio)
    if not known.any():
        raise OutputError(
            "the results contain no unloading that ends in separation; run the case with "
            'unloading.method = "path"'
        )
    share = _pchip(np.log(depth[known]), ratio[known])
    return lambda x: share(math.log(x)) * x


def _shape(x: Array, F: Array) -> Force:
    return _pchip((x - x[0]) / (x[-1] - x[0]), F / F[-1])


def _pchip(x: Array, y: Array) -> Force:
    from scipy.interpolate import PchipInterpolator

    if x.size == 1:
        return lambda _: float(y[0])
    curve = PchipInterpolator(x, y)
    low, high = float(x[0]), float(x[-1])
    # The integrator also evaluates points slightly beyond the ends; the curve is constant there.
    return lambda where: curve(np.minimum(np.maximum(where, low), high))
