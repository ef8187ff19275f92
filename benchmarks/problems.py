"""The contacts that every program solves, and an independent check of the solutions.

A problem contains the numbers of a contact that a solver needs: the gap before the solve h₀
(smallest value 0), the spacing, E*, the largest pressure p_y (inf: elastic) and the indentation δ.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import scipy.fft

from restitution import Body, Contact, Grid, Pair, generate_surface, smooth, solve
from restitution.contact.plasticity.bound import ConstantBound

SPACING = 0.25e-6
FORCE = 1e-6  # largest relative error of a prescribed force
STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25)
PAIR = Pair(STEEL, STEEL)  # R* = 250 um, E* = 112 GPa


@dataclass(frozen=True)
class Problem:
    """One contact: `gap` h₀ and `spacing` in m, `contact_modulus` and `limit` p_y in Pa.

    `radius` (m) is for programs that need the sphere separately from the surface, `force` (N) for
    programs that do not accept an indentation. In a `periodic` problem the gap is one period, and
    the force is prescribed, not the indentation.
    """

    name: str
    gap: np.ndarray
    spacing: float
    contact_modulus: float
    limit: float
    indentation: float
    radius: float
    force: float
    periodic: bool = False

    def cropped(self) -> Problem:
        """The same contact on the bounding box of {h₀ < δ}, outside which nothing can touch.

        The box is widened to sizes with fast FFTs, so that large prime factors do not affect the
        times.
        """
        inside = self.gap < self.indentation
        box = tuple(_widened(inside.any(axis)) for axis in (1, 0))
        return replace(self, gap=np.ascontiguousarray(self.gap[box]))

    def save(self, path: Path) -> None:
        """Write the problem for a worker to read."""
        np.savez(
            path,
            gap=self.gap,
            spacing=self.spacing,
            contact_modulus=self.contact_modulus,
            limit=self.limit,
            indentation=self.indentation,
            radius=self.radius,
            force=self.force,
            periodic=self.periodic,
        )


def all_problems(n: int) -> list[Problem]:
    """Contacts on n × n nodes: elastic smooth and rough, and plastic smooth.

    The contact radius is 10 um in the elastic contacts, and 20 um in the plastic contact.
    """
    grid = Grid((n, n), (SPACING, SPACING))
    flat = smooth(grid)
    rough = generate_surface(grid, kind="gaussian", rms=0.1e-6, correlation_length=2e-6, seed=1)
    cases = (
        ("elastic smooth", Contact(PAIR, flat), 10e-6),
        ("elastic rough", Contact(PAIR, rough), 10e-6),
        (
            "plastic smooth",
            Contact(PAIR, flat, plasticity=ConstantBound(750e6)),
            20e-6,
        ),
    )
    return [_problem(name, contact, a**2 / PAIR.radius) for name, contact, a in cases]


def _problem(name: str, contact: Contact, indentation: float) -> Problem:
    return Problem(
        name,
        contact.gap,
        SPACING,
        PAIR.contact_modulus,
        contact.hardness,
        indentation,
        PAIR.radius,
        solve(contact, indentation, residual=1e-11).force,
    )


def _widened(inside: np.ndarray) -> slice:
    """The range of the true values, widened to a length whose prime factors are small."""
    at = np.flatnonzero(inside)
    found = int(at[-1] - at[0]) + 1
    length = min(scipy.fft.next_fast_len(found, real=True), inside.size)
    start = min(max(int(at[0]) - (length - found) // 2, 0), inside.size - length)
    return slice(start, start + length)


def residual(problem: Problem, pressure: np.ndarray) -> float:
    """Largest violation of the contact conditions over δ.

    With the deformed gap g = K p + h₀ − δ and c the displacement of a node by its own pressure,
    c p = clip(c p − g, 0, c p_y) is equivalent to three conditions: g ≥ 0 where p = 0, g = 0
    between the bounds, and g ≤ 0 where p = p_y. The difference of both sides is the violation, as
    a length. In a periodic problem, the force must be right within `FORCE`, and δ follows from the
    mean g of the contact.
    """
    make = _periodic_kernel if problem.periodic else _kernel
    K, own = make(pressure.shape, problem.spacing)
    padded = [n if problem.periodic else 2 * n for n in pressure.shape]
    modes = scipy.fft.rfft2(pressure, s=padded, workers=2) * K
    u = scipy.fft.irfft2(modes, s=padded, workers=2)[: pressure.shape[0], : pressure.shape[1]]
    g = u / problem.contact_modulus + problem.gap - problem.indentation
    if problem.periodic:
        force = float(pressure.sum()) * problem.spacing**2
        if not abs(force / problem.force - 1) <= FORCE:
            return math.inf
        g -= g[(pressure > 0) & (pressure < problem.limit)].mean()
    c = own / problem.contact_modulus
    with np.errstate(invalid="ignore"):
        violation = c * pressure - np.clip(c * pressure - g, 0, c * problem.limit)
    worst = float(np.abs(violation).max()) / problem.indentation
    return worst if math.isfinite(worst) else math.inf


@lru_cache(maxsize=2)
def _kernel(shape: tuple[int, int], spacing: float) -> tuple[np.ndarray, float]:
    """Spectrum of the kernel E* K (Love 1929), and its value at lag 0.

    The kernel is wrapped to a period of twice the shape.
    """
    # u(x, y) is the double difference of F = x asinh(y/|x|) + y asinh(x/|y|) over the corners of
    # the cell. Extended precision compensates for the cancellation in these differences.
    x, y = (spacing * (np.arange(n + 2, dtype=np.longdouble) - 0.5) for n in shape)
    x, y = x[:, None], y[None, :]
    F = x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))
    quadrant = (np.diff(np.diff(F, axis=0), axis=1) / np.pi).astype(np.float64)
    nx, ny = shape
    i, j = (np.minimum(np.arange(2 * n), 2 * n - np.arange(2 * n)) for n in (nx, ny))
    return scipy.fft.rfft2(quadrant[np.ix_(i, j)], workers=2), float(quadrant[0, 0])


@lru_cache(maxsize=2)
def _periodic_kernel(shape: tuple[int, int], spacing: float) -> tuple[np.ndarray, float]:
    """Spectrum 2/|q| of the kernel E* K on one period, without the mean, and its value at lag 0."""
    qx, qy = (
        2 * np.pi * np.fft.fftfreq(shape[0], spacing),
        2 * np.pi * np.fft.rfftfreq(shape[1], spacing),
    )
    q = np.hypot(qx[:, None], qy)
    q[0, 0] = np.inf
    kernel = scipy.fft.irfft2(2 / q, s=shape)
    return 2 / q, float(kernel[0, 0])
