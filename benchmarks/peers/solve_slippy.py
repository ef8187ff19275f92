"""Worker of SlipPy. Its tolerance is that of a step: the relative change of the pressures.

Its default kernel, made in the frequency domain, includes periodic images; the spatial kernel does
not. SlipPy detects contact by an absolute tolerance of 1e-14 in the unit of length, so micrometres
are used. It caches kernels by the name of the material, so every solve needs a new name.
"""

import itertools

import numpy as np
import slippy
import slippy.contact
import slippy.surface
from worker import serve

MAX_ITERATIONS = 100_000
# FFTW's threads wait for each other. On fewer nodes they save no time, and beside other processes
# they take many times as long.
NODES_WORTH_THREADS = 256**2
cores = slippy.CORES
names = (f"steel {i}" for i in itertools.count())


def prepare(problem):
    """Heights, spacing, E*, limit and indentation in micrometres and MPa."""
    return (
        -problem.gap * 1e6,
        float(problem.spacing) * 1e6,
        float(problem.contact_modulus) / 1e6,
        float(problem.limit) / 1e6,
        float(problem.indentation) * 1e6,
    )


def solve(inputs, tolerance):
    """One static step to an interference."""
    heights, spacing, E_star, limit, indentation = inputs
    slippy.CORES = cores if heights.size > NODES_WORTH_THREADS else 1
    steel = slippy.contact.Elastic(
        next(names), {"E": 2 * E_star, "v": 0.0}, max_load=limit, use_frequency_domain=False
    )
    rough = slippy.surface.Surface(profile=heights, grid_spacing=spacing)
    flat = slippy.surface.FlatSurface(shift=(0, 0))
    rough.material = flat.material = steel
    model = slippy.contact.ContactModel("contact", rough, flat)
    model.add_step(
        slippy.contact.StaticStep(
            "load", interference=indentation, tolerance=tolerance, max_it=MAX_ITERATIONS
        )
    )
    return np.asarray(model.solve()["loads_z"]) * 1e6


def forget():
    """Drop the kernels of earlier materials."""
    memory = slippy.contact.Elastic.influence_matrix
    memory.cache.clear()
    memory.spec.clear()


serve(slippy.__version__, prepare, solve, forget)
