"""Coefficient of restitution of rough elastic-plastic particles from their surface topography."""

from restitution.collision import Collision, collide
from restitution.contact.bodies import Body, Pair
from restitution.contact.contact import Contact, smooth
from restitution.contact.equilibrium import solve, step
from restitution.contact.load import solve_at_force
from restitution.contact.path import loading_path, unloading_path
from restitution.contact.state import State
from restitution.errors import RestitutionError
from restitution.numerics.grid import Grid
from restitution.surfaces import (
    Surface,
    describe,
    generate_surface,
    level,
    place_on_grid,
    read_surface,
)

__all__ = [
    "Body",
    "Collision",
    "Contact",
    "Grid",
    "Pair",
    "RestitutionError",
    "State",
    "Surface",
    "collide",
    "describe",
    "generate_surface",
    "level",
    "loading_path",
    "place_on_grid",
    "read_surface",
    "smooth",
    "solve",
    "solve_at_force",
    "step",
    "unloading_path",
]
