"""Cohesive contacts of two spheres, smooth or with waves."""

import math

import numpy as np

from contact_keys import contact_of
from restitution.contact.bodies import Body, Pair
from restitution.contact.cohesive.loading import load_cohesive
from restitution.contact.cohesive.steps import follow
from restitution.contact.contact import smooth
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface

W, Z0, E_STAR = 0.05, 0.3e-9, 1e11
LENGTH = E_STAR * Z0**2 / W  # of the cohesive zone


def pair_of(tabor):
    """Two equal spheres with a Tabor parameter."""
    radius = tabor**3 * E_STAR**2 * Z0**3 / W**2
    body = Body(2 * radius, 2 * E_STAR * (1 - 0.3**2), 0.3, 2500.0)
    return Pair(body, body)


def sphere(tabor, depth, *, cells=0.3, rough=0.0, seed=0, **options):
    """A cohesive contact on a grid for loading to `depth` (in z0); `cells` over the zone length."""
    pair = pair_of(tabor)
    h = min(cells * LENGTH, 0.25 * math.sqrt(pair.radius * Z0))
    reach = math.sqrt(2 * pair.radius * Z0 * (9 + tabor + max(depth, 0.0)))
    n = 2 * int(reach / h + 2)
    surface = smooth(Grid(n, h))
    if rough:
        rng, x = np.random.default_rng(seed), surface.grid.x
        height = np.zeros((n, n))
        for _ in range(8):
            q = 2 * np.pi * rng.integers(-4, 5, 2) / (n * h)
            height += np.cos(q[0] * x[:, None] + q[1] * x + rng.uniform(0, 6.3))
        surface = Surface(rough * Z0 * height / max(height.std(), 1e-30), surface.grid)
    options = {"adhesion": "cohesive", "work_of_adhesion": W, **options}
    return contact_of(pair, surface, equilibrium_separation=Z0, **options)


def approach(contact):
    """The states of loading to half of z0."""
    begin = load_cohesive(contact, -math.inf, start=None, residual=1e-8)
    yield from follow(begin, 0.5 * Z0, residual=1e-8)
