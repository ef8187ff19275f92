"""Weighted least squares over the logarithms of parameters, from several first guesses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.model import CaseModel, Cells
from restitution.errors import CaseError, RestitutionError

Array = NDArray[np.float64]

RANGE = 30.0  # factor that the search may go from the first guess, up and down
# ln of a parameter, of the central differences. The solver's noise is 1e-8, but single nodes that
# begin to yield make COR of shallow contacts uneven over changes of about one percent.
_STEP = 0.03
_SPREAD = 4.0  # factor between the first guess and the other starts
_STARTS = 4
_FAILED = 1e3  # residual, in standard deviations, where the case cannot be solved
_EVALUATIONS = 40
# Relative, of the sum of squares and of x; on coarser cells a start for the next search is enough.
_TOLERANCE: dict[Cells, float] = {"own": 1e-4, "coarser": 1e-3}


@dataclass(frozen=True)
class Data:
    """Restitution at impact velocities (m/s) with the deviations that weigh them."""

    velocity: Array
    restitution: Array
    deviation: Array


@dataclass(frozen=True)
class Minimum:
    """The end of a search: x = ln(value/first guess), and the sum of squared weighted residuals."""

    x: Array
    squares: float


def jacobian(model: CaseModel, x: Array, velocity: Array, cells: Cells = "own") -> Array:
    """∂COR/∂x at `velocity` (m/s), shape (velocities, parameters), by central differences.

    Where the case cannot be solved on one side, by the difference to the other.
    """
    columns = []
    for k in range(x.size):
        ends = []
        for sign in (1, -1):
            beside = x.copy()
            beside[k] += sign * _STEP
            try:
                ends.append((model.restitution(beside, velocity, cells), beside[k]))
            except RestitutionError:
                ends.append((model.restitution(x, velocity, cells), x[k]))
        (above, high), (below, low) = ends
        columns.append((above - below) / (high - low) if high > low else np.zeros(velocity.size))
    return np.array(columns).T


def search(model: CaseModel, data: Data, start: Array, cells: Cells = "own") -> Minimum:
    """The minimum that is found from `start`. Raises `RestitutionError` if it cannot be solved."""
    from scipy.optimize import least_squares

    def residuals(x: Array) -> Array:
        return (model.restitution(x, data.velocity, cells) - data.restitution) / data.deviation

    def safe(x: Array) -> Array:
        """The residuals, or large ones where the case cannot be solved: the step is refused."""
        try:
            return residuals(x)
        except RestitutionError:
            return np.full(data.velocity.size, _FAILED)

    residuals(start)
    found = least_squares(
        safe,
        start,
        jac=lambda x: jacobian(model, x, data.velocity, cells) / data.deviation[:, None],
        bounds=(-math.log(RANGE), math.log(RANGE)),
        ftol=_TOLERANCE[cells],
        xtol=_TOLERANCE[cells],
        gtol=1e-8,
        max_nfev=_EVALUATIONS,
    )
    return Minimum(np.asarray(found.x), 2 * float(found.cost))


def search_widely(model: CaseModel, data: Data) -> list[Minimum]:
    """The minima found from several starts on cells twice as large, the best first.

    Raises `CaseError` if the case can be solved at none of the starts.
    """
    found, failure = [], ""
    for start in _starts(len(model.parameters)):
        try:
            found.append(search(model, data, start, "coarser"))
        except RestitutionError as error:
            failure = failure or str(error)
    if not found:
        raise CaseError(
            f"the case cannot be solved at the first guess of the parameters: {failure}"
        )
    return sorted(found, key=lambda minimum: minimum.squares)


def at_bound(x: float) -> bool:
    """Whether a search ended at an end of its range."""
    return abs(x) > 0.99 * math.log(RANGE)


def _starts(parameters: int) -> Sequence[Array]:
    """The first guess, and points around it whose signs differ between the parameters."""
    signs: list[tuple[int, ...]] = [(0,) * parameters]
    for start in range(1, _STARTS):
        # Rows of a Hadamard matrix.
        row = tuple((-1) ** (start & k).bit_count() for k in range(1, parameters + 1))
        if row not in signs:
            signs.append(row)
    return [math.log(_SPREAD) * np.array(row, dtype=float) for row in signs]
