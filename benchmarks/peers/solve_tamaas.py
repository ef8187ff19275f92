"""Worker of Tamaas. Its tolerance limits the solver's error, an energy divided by an energy scale.

The non-periodic problem accepts only a force, so it gets the correct force. `model.E` must be set
before the operator is registered, and the operator must be chosen by name; otherwise the periodic
problem is solved. The steps of `KatoSaturated` depend on the units. With E* = 1 and a spacing a
little below 1 it converges in tens of iterations, with a larger spacing or in SI units hardly ever.
It always returns an error of 0, even if it has not converged.
"""

import numpy as np
import tamaas as tm
from worker import serve

MAX_ITERATIONS = 100_000
SPACING = 0.7  # in the unit of length


def prepare(problem):
    """The heights in the unit of length, the limit and the mean pressure over E*."""
    h, E = problem.spacing, problem.contact_modulus
    mean = problem.force / (problem.gap.size * h**2) / E
    return -problem.gap * (SPACING / h), problem.limit / E, mean, E, bool(problem.periodic)


def solve(inputs, tolerance):
    """One load: `PolonskyKeerRey` for elastic contact, `KatoSaturated` below a limit."""
    heights, limit, mean, E, periodic = inputs
    nodes = list(heights.shape)
    size = [n * SPACING for n in nodes]
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, size, nodes)
    model.E, model.nu = 1.0, 0.0
    if not periodic:
        tm.ModelFactory.registerNonPeriodic(model, "free")
    if np.isinf(limit):
        solver = tm.PolonskyKeerRey(model, heights, tolerance)
    else:
        solver = tm.KatoSaturated(model, heights, tolerance, limit)
    if not periodic:
        solver.setIntegralOperator("free")
    solver.max_iter = MAX_ITERATIONS
    solver.solve(mean)
    return E * np.array(model.traction)


tm.set_log_level(tm.LogLevel.error)
serve(tm.__version__, prepare, solve)
