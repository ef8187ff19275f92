"""Coefficient of restitution of rough elastic-plastic particles from their surface topography."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import restitution.theory as theory
    from restitution.api import collide_obliquely, export, law_of, open_results, run
    from restitution.case.materials import material, materials
    from restitution.collision import Collision, collide
    from restitution.contact.bodies import Body, Pair
    from restitution.contact.cohesive.law import Cohesive, CohesiveLaw
    from restitution.contact.contact import Contact, smooth
    from restitution.contact.jkr.approach import (
        AdhesiveApproach,
        HertzianApproach,
        PullIncrements,
    )
    from restitution.contact.jkr.detachment import CrackClosure, PohrtPopov
    from restitution.contact.jkr.limit import JKRLimit
    from restitution.contact.loading import solve, step
    from restitution.contact.models import Plasticity
    from restitution.contact.path import loading_path, unloading_path
    from restitution.contact.plasticity.bound import ConstantBound, Elastic
    from restitution.contact.plasticity.cavity import ExpandingCavity
    from restitution.contact.plasticity.truncated import Truncated
    from restitution.contact.prescribed.force import solve_at_force
    from restitution.contact.prescribed.pressure import solve_at_pressure
    from restitution.contact.prescribed.velocity import solve_at_velocity
    from restitution.contact.state import State
    from restitution.errors import RestitutionError
    from restitution.laws.oblique import ObliqueCollision
    from restitution.numerics.convolution.cache import operator_cache
    from restitution.numerics.convolution.device import on_device
    from restitution.numerics.grid import Grid
    from restitution.surfaces import (
        Surface,
        composite,
        crop,
        describe,
        extend,
        generate_surface,
        level,
        place_on_grid,
        read_surface,
        refine,
        remove_outliers,
    )

    __version__: str

__all__ = [
    "AdhesiveApproach",
    "Body",
    "Cohesive",
    "CohesiveLaw",
    "Collision",
    "ConstantBound",
    "Contact",
    "CrackClosure",
    "Elastic",
    "ExpandingCavity",
    "Grid",
    "HertzianApproach",
    "JKRLimit",
    "ObliqueCollision",
    "Pair",
    "Plasticity",
    "PohrtPopov",
    "PullIncrements",
    "RestitutionError",
    "State",
    "Surface",
    "Truncated",
    "collide",
    "collide_obliquely",
    "composite",
    "crop",
    "describe",
    "export",
    "extend",
    "generate_surface",
    "law_of",
    "level",
    "loading_path",
    "material",
    "materials",
    "on_device",
    "open_results",
    "operator_cache",
    "place_on_grid",
    "read_surface",
    "refine",
    "remove_outliers",
    "run",
    "smooth",
    "solve",
    "solve_at_force",
    "solve_at_pressure",
    "solve_at_velocity",
    "step",
    "theory",
    "unloading_path",
]

# Modules and the public names that each of them defines. A module is imported when one of its names
# is first used, so `import restitution` does not load NumPy. The command line also imports this
# package, and loading NumPy would delay its help texts and its reaction to Ctrl-C.
_MODULES = {
    "api": ("collide_obliquely", "export", "law_of", "open_results", "run"),
    "case.materials": ("material", "materials"),
    "collision": ("Collision", "collide"),
    "contact.bodies": ("Body", "Pair"),
    "contact.cohesive.law": ("Cohesive", "CohesiveLaw"),
    "contact.contact": ("Contact", "smooth"),
    "contact.jkr.detachment": ("CrackClosure", "PohrtPopov"),
    "contact.jkr.approach": ("AdhesiveApproach", "HertzianApproach", "PullIncrements"),
    "contact.jkr.limit": ("JKRLimit",),
    "contact.models": ("Plasticity",),
    "contact.plasticity.bound": ("ConstantBound", "Elastic"),
    "contact.plasticity.cavity": ("ExpandingCavity",),
    "contact.plasticity.truncated": ("Truncated",),
    "contact.prescribed.velocity": ("solve_at_velocity",),
    "contact.prescribed.force": ("solve_at_force",),
    "contact.prescribed.pressure": ("solve_at_pressure",),
    "contact.loading": ("solve", "step"),
    "contact.path": ("loading_path", "unloading_path"),
    "contact.state": ("State",),
    "errors": ("RestitutionError",),
    "laws.oblique": ("ObliqueCollision",),
    "numerics.convolution.cache": ("operator_cache",),
    "numerics.convolution.device": ("on_device",),
    "numerics.grid": ("Grid",),
    "surfaces": (
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
    ),
}

if not TYPE_CHECKING:

    def __getattr__(name):
        from importlib import import_module, metadata

        if name == "__version__":
            return metadata.version(__name__)
        if name == "theory":
            return import_module(f"{__name__}.theory")
        for module, names in _MODULES.items():
            if name in names:
                return getattr(import_module(f"{__name__}.{module}"), name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__():
        return sorted({*globals(), *__all__, "__version__"})
