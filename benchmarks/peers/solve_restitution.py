"""Worker of this program. Its tolerance is the `residual` of a solve."""

import sys
from importlib.metadata import version

from worker import serve

from restitution import (
    Body,
    ConstantBound,
    Contact,
    Grid,
    Pair,
    Surface,
    operator_cache,
    solve,
    solve_at_pressure,
)


def prepare(problem):
    """The contact: the bodies, and the surface that together with the sphere gives the gap."""
    h = float(problem.spacing)
    grid = Grid(problem.gap.shape, (h, h))
    sphere = (grid.x[:, None] ** 2 + grid.y**2) / (2 * problem.radius)
    body = Body(2 * float(problem.radius), 2 * float(problem.contact_modulus), 0.0)
    surface = Surface(sphere - problem.gap, grid)
    model = {
        "plasticity": ConstantBound(float(problem.limit)),
        "periodic": bool(problem.periodic),
    }
    return Pair(body, body), surface, model, float(problem.indentation), float(problem.force)


def solve_once(inputs, tolerance):
    """One indentation of the undeformed bodies, or one force on a period."""
    pair, surface, model, indentation, force = inputs
    contact = Contact(pair, surface, **model)
    if contact.periodic:
        area = contact.grid.cell_area * surface.height.size
        return solve_at_pressure(contact, force / area, residual=tolerance).pressure
    return solve(contact, indentation, residual=tolerance).pressure


def forget():
    """Empty every cache of the package."""
    for name, module in list(sys.modules.items()):
        if name.startswith("restitution"):
            for value in vars(module).values():
                if hasattr(value, "cache_clear"):
                    value.cache_clear()
    operator_cache.clear()


serve(version("restitution"), prepare, solve_once, forget)
