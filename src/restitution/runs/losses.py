"""The columns of a curve for plates, waves and viscosity (`impacts.losses`)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from restitution.case.case import Case
from restitution.contact.bodies import Pair
from restitution.contact.jkr.unloading_curve import complete_curve
from restitution.curve.columns import Array, array
from restitution.curve.curve import UnloadingCurve
from restitution.curve.follow import Impact
from restitution.curve.point import Point
from restitution.display import quantity
from restitution.impacts.losses import LossFactors, loss_factors
from restitution.impacts.stored_force import force_of_columns
from restitution.losses.losses import Losses
from restitution.theory import Hertz

_NODES = 33  # of an unloading curve made from its work
_HERTZ = 1.5  # exponent of an unloading curve whose end is unknown
_TRIPS = 3  # fewest round trips of a wave across a plate during which bending waves form
_FLATTEST = 0.1  # smallest exponent


def unloading_of(impact: Impact) -> UnloadingCurve | None:
    """The unloading curve of `impact`, if one was computed and the bodies touch."""
    if not impact.unloading or not impact.state.contact_nodes:
        return None
    touch = impact.load.touch
    x, F = np.array(complete_curve(impact.unloading))[::-1].T
    return UnloadingCurve(impact.state.indentation + touch, x + touch, F)


def loss_information(case: Case) -> str:
    """What the pair loses beside yielding and adhesion, in words; "" for nothing."""
    losses, pair = case.losses(), case.pair()
    if pair.mass is None or pair.flat:
        return ""
    said = []
    if plate := losses.plate:
        longest, _ = _durations(case, pair.mass)
        said.append(
            f"bending waves in the wall of {quantity(plate.thickness, 'm')}, which must be free of "
            f"edges and supports within {quantity(plate.reach(longest), 'm')}"
        )
    if losses.waves:
        said.append("waves in the wall" if not losses.plate else "waves as in a thick wall")
    if losses.viscosity:
        said.append("internal friction")
    without = any(body.radius is None and body.density is None for body in case.bodies().values())
    if without:
        said.append("no waves in the wall, because its density is not given")
    return f"Losses beside yielding and adhesion: {', '.join(said)}." if said else ""


def loss_warnings(case: Case) -> list[str]:
    """Warnings about losses outside the range of their theories."""
    losses, pair = case.losses(), case.pair()
    plate = losses.plate
    if pair.mass is None or plate is None:
        return []
    _, shortest = _durations(case, pair.mass)
    if shortest >= _TRIPS * plate.round_trip:
        return []
    return [
        f"thickness: at the highest velocity, the contact of smooth bodies lasts "
        f"{quantity(shortest, 's')}, less than {_TRIPS} round trips of a wave across the wall "
        f"({quantity(plate.round_trip, 's')}), so plate_factor may be off by as much as it differs "
        "from waves_factor; a wall as thick as this can be given without thickness"
    ]


def _durations(case: Case, mass: float) -> tuple[float, float]:
    """Duration (s) of the slowest and the fastest impact, estimated for smooth elastic bodies."""
    pair, velocities = case.pair(), np.array([case.depths()[0], case.depths()[-1]])
    smooth = Hertz(pair.radius, pair.contact_modulus)
    if case.impact is None:
        depths = smooth.indentation(velocities) if case.load else velocities
        velocities = smooth.impact_velocity(depths, mass)
    longest, shortest = smooth.duration(velocities, mass).tolist()
    return longest, shortest


def with_losses(
    pair: Pair,
    losses: Losses,
    points: Sequence[Point],
    unloading: Mapping[float, UnloadingCurve],
) -> list[Point]:
    """Fill in the columns of the losses of `points`; they stay empty without impact velocities.

    `unloading` has the computed unloading curves by their `Point.indentation`; those of other
    points are made from the work of unloading.
    """
    known: list[Point] = []
    velocity = depth = 0.0  # adhesion alone reaches negative depths
    for point in points:
        if point.impact_velocity > velocity and point.indentation > depth:
            known.append(point)
            velocity, depth = point.impact_velocity, point.indentation
    if not known:
        return list(points)
    velocities = array(known, "impact_velocity")
    factors = LossFactors.without(velocities)
    curves = [c for p in known if (c := unloading.get(p.indentation) or _made(p)) is not None]
    if losses.present and curves:
        columns = {name: array(known, name) for name in ("indentation", "force", "loading_work")}
        columns["impact_velocity"] = velocities
        columns["separation_indentation"] = np.array([_separation(point) for point in known])
        factors = loss_factors(force_of_columns(pair, columns, curves), losses, velocities)
    rows = zip(*factors.columns().values(), strict=True)
    filled = {
        id(point): _filled(point, dict(zip(factors.columns(), row, strict=True)))
        for point, row in zip(known, np.array(list(rows)).tolist(), strict=True)
    }
    return [filled.get(id(point), point) for point in points]


def _filled(point: Point, factors: Mapping[str, float]) -> Point:
    product = 1.0 if math.isnan(factors["product"]) else factors["product"]  # the bodies stick
    error = point.restitution * abs(product - factors["together"])
    return replace(
        point,
        plate_factor=factors["plate_factor"],
        waves_factor=factors["waves_factor"],
        viscosity_factor=factors["viscosity_factor"],
        restitution_with_losses=point.restitution * product,
        loss_error=0.0 if math.isnan(error) else error,
    )


def _separation(point: Point) -> float:
    """Indentation (m) at separation; of Hertz's curve with the same work if it is not known."""
    if not math.isnan(point.separation_indentation):
        return point.separation_indentation
    return point.indentation - (_HERTZ + 1) * max(point.unloading_work, 0.0) / abs(point.force)


def _made(point: Point) -> UnloadingCurve | None:
    """The power law F ∝ (δ − δ_s)ⁿ that returns the work of unloading."""
    end = _separation(point)
    way = point.indentation - end
    if not (point.unloading_work > 0 and point.force > 0 and way > 0):
        return None
    s: Array = np.linspace(0.0, 1.0, _NODES)
    power = max(point.force * way / point.unloading_work - 1, _FLATTEST)
    return UnloadingCurve(point.indentation, end + way * s, point.force * s**power)
