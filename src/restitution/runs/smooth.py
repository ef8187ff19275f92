"""Curves of the bodies of a case without their roughness, for comparison with rough bodies."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from restitution.collision import Collision
from restitution.contact.checks.resolution import predicted_radius
from restitution.contact.contact import Contact, smooth
from restitution.contact.loading import solve
from restitution.contact.state import State
from restitution.curve.columns import Array
from restitution.curve.follow import Load, Unloading, follow
from restitution.curve.point import Point
from restitution.numerics.grid import Grid
from restitution.theory import FirstYield, Hertz

# Number of nodes along each edge of a grid: 32 nodes per predicted contact radius. Eight nodes per
# contact radius would already keep the error of COR below 0.3 %.
_NODES = 80
_WIDTH = 2.5  # ratio of the width of a grid to the predicted contact radius
_DEPTHS = 20  # number of depths up to yield; the same number of depths is used beyond yield


def smooth_curve(
    contact: Contact, points: Sequence[Point], check: Callable[[], None] = lambda: None
) -> dict[str, Any]:
    """Make the variables of `results.nc` for the smooth bodies: force, restitution and velocity.

    The curve spans the depths and velocities of `points`. Up to yield it is Hertz's solution;
    beyond, each depth is solved on a small grid. Empty for the model `truncated` (Thornton and
    Ning's formulas describe it) and for adhesive contacts (small grids do not resolve adhesion).
    `check` is called before every solve, and may raise an error to end the curve.
    """
    pair = contact.pair
    if not contact.plasticity.bounds_solve or contact.adhesive or not points:
        return {}
    contact = replace(contact, plasticity=contact.plasticity.of_smooth(pair))
    depths, onset = _depths(contact, points)
    hertz, elastic = Hertz(pair.radius, pair.contact_modulus), depths <= onset

    def load(depth: float) -> Load:
        spacing = _WIDTH * predicted_radius(pair, depth, contact.hardness) / _NODES
        on = smooth(Grid((_NODES, _NODES), (spacing, spacing)))
        bodies = replace(contact, surface=on, adhesion=None)

        def to(_: State | None) -> State:
            check()
            return solve(bodies, depth)

        return Load(bodies, to, depth)

    force = [float(hertz.force(depth)) for depth in depths[elastic]]
    works = [float(hertz.stored_energy(depth)) for depth in depths[elastic]]
    collisions = [Collision(work, work, pair.mass) for work in works]
    for impact in follow(map(load, depths[~elastic].tolist()), Unloading()):
        force.append(impact.state.force)
        collisions.append(impact.collision)
    values = {
        "indentation": ("m", "maximum indentation", depths),
        "force": ("N", "normal force", force),
        "restitution": ("1", "coefficient of restitution", [c.restitution for c in collisions]),
        "impact_velocity": (
            "m s-1",
            "impact velocity",
            [math.nan if pair.mass is None else c.impact_velocity for c in collisions],
        ),
    }
    return {
        f"smooth_{name}": (
            "smooth",
            np.array(of, dtype=float),
            {"units": unit, "long_name": f"{words}, smooth, same model"},
        )
        for name, (unit, words, of) in values.items()
    }


def _depths(contact: Contact, points: Sequence[Point]) -> tuple[Array, float]:
    """Depths (m) of the smooth curve, and the depth at which smooth bodies begin to yield."""
    R, E_star = contact.pair.radius, contact.pair.contact_modulus
    deepest = max(point.indentation for point in points)
    # Smooth bodies reach the same loading work at a smaller depth than rough bodies, so the smooth
    # curve may begin at a smaller depth.
    least = min(point.loading_work for point in points)
    begin = float(Hertz(R, E_star).indentation_from_energy(least))
    first = min(begin, *(point.indentation for point in points))
    first_yield = contact.plasticity.first_yield_pressure(contact.pair)
    onset = math.inf
    if math.isfinite(first_yield):
        onset = float(FirstYield(R, E_star, first_yield).indentation)
    between = min(max(first, onset), deepest)
    ranges = ((first, between), (between, deepest))
    return np.unique([np.geomspace(*ends, _DEPTHS) for ends in ranges]), onset
