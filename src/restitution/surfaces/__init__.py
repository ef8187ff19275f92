"""Height maps: generate, read, clean, level, extend, resample and describe surfaces."""

from restitution.surfaces.clean import crop, remove_outliers
from restitution.surfaces.composite import composite
from restitution.surfaces.describe import describe, rms_slope
from restitution.surfaces.extend import extend
from restitution.surfaces.generate import generate_surface
from restitution.surfaces.level import level
from restitution.surfaces.measured import read_surface
from restitution.surfaces.refine import refine
from restitution.surfaces.resample import place_on_grid
from restitution.surfaces.surface import Surface

__all__ = [
    "Surface",
    "composite",
    "crop",
    "describe",
    "extend",
    "generate_surface",
    "level",
    "place_on_grid",
    "read_surface",
    "refine",
    "remove_outliers",
    "rms_slope",
]
