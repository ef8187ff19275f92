"""Curves of the bodies of a case without their roughness, for comparison with rough bodies."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from restitution.collision import Collision, collide
from restitution.contact.checks.resolution import predicted_radius
from restitution.contact.contact import Contact, smooth
from restitution.contact.loading import solve
from restitution.numerics.grid import Grid
from restitution.theory import FirstYield, Hertz

# Number of nodes along each edge of a grid: 32 nodes per predicted contact radius. Eight nodes per
# contact radius would already keep the error of COR below 0.3 %.
_NODES = 80
_WIDTH = 2.5  # ratio of the width of a grid to the predicted contact radius
_DEPTHS = 20  # number of depths up to yield; the same number of depths is used beyond yield


def smooth_curve(
    contact: Contact, rows: list[dict[str, float]], check: Callable[[], None] = lambda: None
) -> dict[str, Any]:
    """Make the variables of results.nc for the smooth bodies: force, restitution and velocity.

    The curve spans the depths and velocities of `rows`. Up to yield it is Hertz's solution. Beyond
    yield, each depth is solved on a separate small grid. The result is empty for the yield model
    `truncated`, because Thornton and Ning's formulas describe smooth bodies with this model. It is
    also empty for adhesive contacts, because small grids do not resolve adhesion. `check` is called
    before every solve, and may raise an error to end the curve. Raises the errors of `solve`.
    """
    pair, p_y = contact.pair, contact.hardness
    R, E_star = pair.radius, pair.contact_modulus
    if not contact.plasticity.bounds_solve or contact.adhesive or not rows:
        return {}
    last = max(row["max_indentation_m"] for row in rows)
    # Smooth bodies reach the same loading work at a smaller depth than rough bodies, so the smooth
    # curve may begin at a smaller depth.
    least = min(row["loading_work_J"] for row in rows)
    hertz = Hertz(R, E_star)
    first = min(
        float(hertz.indentation_from_energy(least)), *(row["max_indentation_m"] for row in rows)
    )
    first_yield = contact.first_yield_pressure
    elastic = math.isinf(first_yield)
    onset = math.inf if elastic else float(FirstYield(R, E_star, first_yield).indentation)
    between = min(max(first, onset), last)
    ranges = ((first, between), (between, last))
    depths = np.unique([np.geomspace(*ends, _DEPTHS) for ends in ranges])
    force, cor, velocity = (np.empty(depths.size) for _ in range(3))
    for k, depth in enumerate(depths):
        check()
        if depth <= onset:
            work = float(hertz.stored_energy(depth))
            force[k], collision = hertz.force(depth), Collision(work, work, pair.mass)
        else:
            spacing = _WIDTH * predicted_radius(pair, depth, p_y) / _NODES
            grid = Grid((_NODES, _NODES), (spacing, spacing))
            state = solve(replace(contact, surface=smooth(grid)), float(depth))
            force[k], collision = state.force, collide(state)
        cor[k] = collision.restitution
        velocity[k] = math.nan if pair.mass is None else collision.impact_velocity
    return {
        name: ("smooth", values, {"units": unit, "long_name": f"{words}, smooth, same model"})
        for name, values, unit, words in (
            ("smooth_indentation", depths, "m", "maximum indentation"),
            ("smooth_force", force, "N", "normal force"),
            ("smooth_restitution", cor, "1", "coefficient of restitution"),
            ("smooth_impact_velocity", velocity, "m s-1", "impact velocity"),
        )
    }
