"""Worker of ContactMechanics. Its tolerance is the tolerance of the gap, divided by δ.

Elastic contact is solved for the pressures by conjugate gradients without restart, which is the
fastest of its solvers for these contacts. Plastic contact is solved by its solver with a hardness.
"""

from importlib.metadata import version

import ContactMechanics  # noqa: F401  (adds make_contact_system to topographies)
import numpy as np
from SurfaceTopography import PlasticTopography, Topography
from worker import serve

MAX_ITERATIONS = 100_000


def prepare(problem):
    """Heights, domain, E*, hardness and indentation in micrometres and MPa."""
    h = float(problem.spacing) * 1e6
    size = tuple(n * h for n in problem.gap.shape)
    return (
        -problem.gap * 1e6,
        size,
        float(problem.contact_modulus) / 1e6,
        float(problem.limit) / 1e6,
        float(problem.indentation) * 1e6,
        h * h,
        "periodic" if problem.periodic else "free",
        float(problem.force) * 1e6,
    )


def solve(inputs, tolerance):
    """One indentation of the free half-space, or one force on a period."""
    heights, size, E_star, hardness, indentation, cell, substrate, force = inputs
    length = tolerance * indentation
    topography = Topography(heights, size)
    # Its periodic half-space is compressed by the mean pressure, so that its offset is not the
    # indentation. The force means the same in all programs (µN in these units).
    periodic = substrate == "periodic"
    given = {"external_force": force} if periodic else {"offset": indentation}
    if np.isinf(hardness) and periodic:
        system = topography.make_contact_system(young=E_star, substrate=substrate)
        result = system.minimize_proxy(
            **given, pentol=length, forcetol=1e-30, maxiter=MAX_ITERATIONS
        )
        forces = result.jac
    elif np.isinf(hardness):
        system = topography.make_contact_system(young=E_star, substrate=substrate)
        result = system.dual_minimize_proxy(
            offset=indentation,
            init_force=np.zeros(heights.shape),
            gtol=length,
            maxiter=MAX_ITERATIONS,
        )
        forces = result.x.reshape(heights.shape)
    else:
        topography = PlasticTopography(topography, hardness)
        system = topography.make_plastic_contact_system(young=E_star, substrate=substrate)
        result = system.minimize_proxy(
            **given,
            pentol=length,
            forcetol=tolerance * hardness * cell,
            thermotol=tolerance,
            maxiter=MAX_ITERATIONS,
        )
        forces = result.jac
    if not result.success:
        raise RuntimeError(result.message)
    return forces / cell * 1e6


serve(version("ContactMechanics"), prepare, solve)
