"""The oblique impacts of a case, from the curves of its run (`impacts.oblique`).

The run has a depth, with an unloading curve, for the normal velocity V cos θ of each impact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields
from itertools import chain, groupby, product
from operator import attrgetter, itemgetter
from typing import Any

import numpy as np
import xarray as xr

from restitution.case.case import Case
from restitution.curve.columns import array
from restitution.curve.curve import Curve, UnloadingCurve
from restitution.curve.oblique import MeanObliquePoint, ObliquePoint
from restitution.curve.point import Point
from restitution.errors import CaseError, DomainError, NotConvergedError, OutputError
from restitution.impacts.oblique import ObliqueCollision, collide_obliquely, spin_per_impulse
from restitution.impacts.stored_force import StoredForce, force_of
from restitution.results.writer import ResultsFolder, curve_variables
from restitution.surfaces import Surface

_SAME = 1e-3  # largest relative difference of normal velocities that count as equal


def is_oblique(case: Case) -> bool:
    return case.impact is not None and case.impact.oblique


def oblique_points(
    case: Case, surface: Surface, out: ResultsFolder
) -> tuple[list[ObliquePoint], str | None]:
    """Compute the oblique impacts of `case` from the curve and the unloading curves of `out`.

    The second result is a warning that names the impacts without a result, or None.
    """
    impact, friction = case.impact, case.interface.friction
    assert impact is not None  # the case is oblique
    assert friction is not None  # checked with the tables of the case
    try:
        law = _force(case, surface, out)
    except (CaseError, OutputError, ValueError) as error:
        return [], f"oblique impacts are not computed: {error}"
    points: list[ObliquePoint] = []
    failures: list[str] = []
    for velocity, angle in product(impact.velocities(), impact.angles()):
        try:
            points.append(_point(law, out.curve, impact.spins(), velocity, angle, friction))
        except (DomainError, NotConvergedError) as error:
            failures.append(f"{velocity:.4g} m/s at {math.degrees(angle):.4g} deg ({error})")
    if not failures:
        return points, None
    more = f" and {len(failures) - 1} more" if len(failures) > 1 else ""
    return points, f"oblique impacts without result: {failures[0]}{more}"


def mean_oblique(curves: Sequence[Sequence[ObliquePoint]]) -> list[MeanObliquePoint]:
    """Means of oblique impacts over several surfaces, one for each velocity and angle."""
    means = []
    impact = attrgetter("velocity", "angle")
    for _, group in groupby(sorted(chain(*curves), key=impact), impact):
        surfaces = list(group)
        values: dict[str, Any] = {
            part.name: float(array(surfaces, part.name).mean()) for part in fields(ObliquePoint)
        }
        tangential = array(surfaces, "tangential_restitution")
        means.append(
            MeanObliquePoint(
                **values | {"slides": all(point.slides for point in surfaces)},
                realisations=len(surfaces),
                tangential_restitution_std=(
                    float(tangential.std(ddof=1)) if len(surfaces) > 1 else math.nan
                ),
            )
        )
    return means


def _force(case: Case, surface: Surface, out: ResultsFolder) -> StoredForce:
    curves = [
        UnloadingCurve(start, *np.array(points)[::-1].T)
        for start, points in sorted(out.unloading, key=itemgetter(0))
    ]
    if not curves:
        raise OutputError("the run has no unloading curves")
    results = xr.Dataset(
        curve_variables(out.curve.points) | {"height": (("x", "y"), surface.height)},
        coords={"x": surface.grid.x, "y": surface.grid.y},
    )
    return force_of(case.pair(), results, curves)


def _point(
    law: StoredForce,
    curve: Curve,
    spins: tuple[float, float],
    velocity: float,
    angle: float,
    friction: float,
) -> ObliquePoint:
    """Compute one impact.

    If a point of the curve has nearly the prescribed normal velocity, the impact is computed at its
    velocity, with its total error: a run reaches the prescribed velocities only within the error of
    the loading work.
    """
    normal = velocity * math.cos(angle)
    nearest = min(curve.points, key=lambda point: _apart(point, normal))
    error = math.nan
    if _apart(nearest, normal) < _SAME:
        # A run reaches the prescribed velocities only within the error of the loading work. Use the
        # velocity that the run reached.
        normal, error = nearest.impact_velocity, nearest.total_error
    collision = collide_obliquely(law, normal / math.cos(angle), angle, friction, spins)
    return ObliquePoint(
        velocity=velocity,
        angle=collision.angle,
        first_spin_before=spins[0],
        second_spin_before=spins[1],
        friction=collision.friction,
        normal_restitution=min(collision.normal_restitution, 1.0),  # rounding may give 1 + 1e-16
        normal_restitution_error=error,
        tangential_restitution=collision.tangential_restitution,
        rebound_angle=collision.rebound_angle,
        first_spin=collision.spins[0],
        second_spin=collision.spins[1],
        friction_loss=collision.friction_loss,
        normal_loss=max(collision.normal_loss, 0.0),
        slides=bool(collision.sliding),
        **_errors(law, collision, error),
    )


def _apart(point: Point, normal: float) -> float:
    """Relative difference between the velocity of `point` and `normal` (m/s); inf if unknown."""
    apart = abs(point.impact_velocity / normal - 1)
    return math.inf if math.isnan(apart) else apart


def _errors(law: StoredForce, collision: ObliqueCollision, error: float) -> dict[str, float]:
    """Errors of the tangential results, which include the `error` of the normal restitution.

    If the normal restitution changes by Δe, the friction impulse changes by at most µ m* V_n Δe:
    its change if the whole contact slides.
    """
    normal_velocity = collision.velocity * math.cos(collision.angle)
    impulse = collision.friction * error * (law.pair.mass or math.nan) * normal_velocity
    tangent = math.tan(collision.angle)
    tangential = math.nan
    if tangent > 0:
        tangential = collision.tangential_restitution_error + collision.friction * error / tangent
    # The angle of rebound is atan(e_t tan θ/e_n). Here e_t is the tangential restitution, e_n the
    # normal restitution, and θ the angle of impact.
    rebound = math.tan(collision.rebound_angle)
    shift = tangent * (tangential if tangent > 0 else 0.0) + abs(rebound) * error
    turned = [
        by_law + impulse * turn
        for by_law, turn in zip(collision.spin_errors, spin_per_impulse(law.pair), strict=True)
    ]
    return {
        "tangential_restitution_error": tangential,
        "rebound_angle_error": shift / collision.normal_restitution / (1 + rebound**2),
        "first_spin_error": turned[0],
        "second_spin_error": turned[1],
    }
