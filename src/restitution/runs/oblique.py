"""The oblique impacts of a case, from the curves of its run (`impacts.oblique`).

The run has a depth for the normal velocity V cos θ of each impact, and every depth is unloaded. So
the maximum indentation of each impact is a computed depth, with a computed unloading curve.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain, groupby, product
from operator import itemgetter

import numpy as np
import xarray as xr

from restitution.case.case import Case
from restitution.errors import CaseError, DomainError, NotConvergedError, OutputError
from restitution.impacts.oblique import ObliqueCollision, collide_obliquely, spin_per_impulse
from restitution.impacts.time_integration import StoredForce, force_of
from restitution.results.reader import UnloadingCurve
from restitution.results.writer import ResultsFolder, curve_variables
from restitution.surfaces import Surface

_Row = dict[str, float]
_SAME = 1e-3  # largest relative difference of normal velocities that count as equal


def is_oblique(case: Case) -> bool:
    """Whether `case` asks for oblique impacts."""
    return case.impact is not None and case.impact.oblique


def oblique_rows(case: Case, surface: Surface, out: ResultsFolder) -> tuple[list[_Row], str | None]:
    """Compute the oblique impacts of `case` from the rows and the unloading curves of `out`.

    Returns a row of `oblique.csv` for each impact. The second value is a warning that names the
    impacts that could not be computed, or None if all were computed.
    """
    impact, friction = case.impact, case.interface.friction
    assert impact is not None  # the case is oblique
    assert friction is not None  # checked by Case._check_oblique
    try:
        law = _force(case, surface, out)
    except (CaseError, OutputError, ValueError) as error:
        return [], f"oblique impacts are not computed: {error}"
    rows: list[_Row] = []
    failures: list[str] = []
    for velocity, angle in product(impact.velocities(), impact.angles()):
        try:
            rows.append(_row(law, out.rows, impact.spins(), velocity, angle, friction))
        except (DomainError, NotConvergedError) as error:
            failures.append(f"{velocity:.4g} m/s at {math.degrees(angle):.4g} deg ({error})")
    if not failures:
        return rows, None
    more = f" and {len(failures) - 1} more" if len(failures) > 1 else ""
    return rows, f"oblique impacts without result: {failures[0]}{more}"


def mean_oblique(tables: Sequence[Sequence[_Row]]) -> list[_Row]:
    """Means of the rows of `oblique.csv` over several surfaces, one row per velocity and angle.

    `slides` is true if the contact slides on all surfaces. Additional columns are the number of
    surfaces and the standard deviation of the tangential restitution (NaN for one surface).
    """
    means = []
    impact = itemgetter("impact_velocity_m_per_s", "angle_rad")
    for _, group in groupby(sorted(chain(*tables), key=impact), impact):
        of = list(group)
        row = {name: float(np.mean([each[name] for each in of])) for name in of[0]}
        row["slides"] = all(each["slides"] for each in of)
        row["realisations"] = len(of)
        tangential = [each["tangential_restitution"] for each in of]
        row["tangential_restitution_std"] = (
            float(np.std(tangential, ddof=1)) if len(of) > 1 else math.nan
        )
        means.append(row)
    return means


def _force(case: Case, surface: Surface, out: ResultsFolder) -> StoredForce:
    """Make a force law from the rows and unloading curves that a run has computed so far."""
    curves = [
        UnloadingCurve(start, *np.array(points)[::-1].T)
        for start, points in sorted(out.unloading, key=itemgetter(0))
    ]
    if not curves:
        raise OutputError("the run has no unloading curves")
    results = xr.Dataset(
        curve_variables(out.rows) | {"height": (("x", "y"), surface.height)},
        coords={"x": surface.grid.x, "y": surface.grid.y},
    )
    return force_of(case.pair(), results, curves)


def _row(
    law: StoredForce,
    rows: Sequence[_Row],
    spins: tuple[float, float],
    velocity: float,
    angle: float,
    friction: float,
) -> _Row:
    """Compute one impact.

    If a row of the curve has nearly the prescribed normal velocity, the impact is computed at the
    velocity of this row. The error of the normal restitution is then the total error of this row.
    """
    normal = velocity * math.cos(angle)
    nearest = min(rows, key=lambda row: _apart(row, normal))
    error = math.nan
    if _apart(nearest, normal) < _SAME:
        # A run reaches the prescribed velocities only within the error of the loading work. Use the
        # velocity that the run reached.
        normal = nearest["impact_velocity_m_per_s"]
        error = nearest["total_error"]
    found = collide_obliquely(law, normal / math.cos(angle), angle, friction, spins)
    return _cells(found, velocity, spins, error) | _errors(law, found, error)


def _apart(row: _Row, normal: float) -> float:
    """Relative difference between the velocity of `row` and `normal` (m/s).

    It is infinite if the velocity of `row` is unknown.
    """
    apart = abs(row["impact_velocity_m_per_s"] / normal - 1)
    return math.inf if math.isnan(apart) else apart


def _cells(
    found: ObliqueCollision, velocity: float, before: tuple[float, float], error: float
) -> _Row:
    return {
        "impact_velocity_m_per_s": velocity,
        "angle_rad": found.angle,
        "first_spin_before_rad_per_s": before[0],
        "second_spin_before_rad_per_s": before[1],
        "friction": found.friction,
        "normal_restitution": min(found.normal_restitution, 1.0),  # rounding may give 1 + 1e-16
        "normal_restitution_error": error,
        "tangential_restitution": found.tangential_restitution,
        "rebound_angle_rad": found.rebound_angle,
        "first_spin_rad_per_s": found.spins[0],
        "second_spin_rad_per_s": found.spins[1],
        "friction_loss_J": found.friction_loss,
        "normal_loss_J": max(found.normal_loss, 0.0),
        "slides": found.sliding,
    }


def _errors(law: StoredForce, found: ObliqueCollision, error: float) -> _Row:
    """Errors of the tangential results, which include the `error` of the normal restitution.

    If the normal restitution changes by Δe, the friction impulse changes by at most µ m* V_n Δe.
    This is its change if the whole contact slides. µ is the coefficient of friction, m* the reduced
    mass, and V_n the normal velocity before the impact.
    """
    normal_velocity = found.velocity * math.cos(found.angle)
    impulse = found.friction * error * (law.pair.mass or math.nan) * normal_velocity
    tangent = math.tan(found.angle)
    tangential = math.nan
    if tangent > 0:
        tangential = found.tangential_restitution_error + found.friction * error / tangent
    # The angle of rebound is atan(e_t tan θ/e_n). Here e_t is the tangential restitution, e_n the
    # normal restitution, and θ the angle of impact.
    rebound = math.tan(found.rebound_angle)
    shift = tangent * (tangential if tangent > 0 else 0.0) + abs(rebound) * error
    turned = [
        by_law + impulse * turn
        for by_law, turn in zip(found.spin_errors, spin_per_impulse(law.pair), strict=True)
    ]
    return {
        "tangential_restitution_error": tangential,
        "rebound_angle_error_rad": shift / found.normal_restitution / (1 + rebound**2),
        "first_spin_error_rad_per_s": turned[0],
        "second_spin_error_rad_per_s": turned[1],
    }
