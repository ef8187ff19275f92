"""Fixtures of the tests of a contact: small contacts, and an independent dense solver."""

import numpy as np
import pytest
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import lsq_linear

from restitution.case.models import plasticity_of
from restitution.contact.bodies import Body, Pair
from restitution.contact.contact import Contact
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface

UM = 1e-6


@pytest.fixture(scope="session")
def pair():
    steel = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850.0)
    return Pair(steel, steel)  # R* = 250 um, E* = 112 GPa


@pytest.fixture(scope="session")
def rough_contact(pair):
    """Make a contact on a rough sphere: a few waves with random phases and rms height `rms`."""

    def make(
        nodes=(24, 20),
        spacing=(0.5 * UM, 0.6 * UM),
        *,
        rms=10e-9,
        seed=0,
        yield_pressure=np.inf,
        plasticity="equilibrium",
        pair=pair,
    ):
        grid = Grid(nodes, spacing)
        rng = np.random.default_rng(seed)
        x, y = grid.x[:, None], grid.y[None, :]
        z = np.zeros(nodes)
        for _ in range(12):
            qx, qy = 2 * np.pi * rng.integers(-3, 4, 2) / np.array(grid.size)
            z += np.cos(qx * x + qy * y + rng.uniform(0, 2 * np.pi))
        z *= rms / max(z.std(), 1e-300)
        return Contact(
            pair,
            Surface(z, grid),
            plasticity=plasticity_of(plasticity, yield_pressure),
        )

    return make


class Dense:
    """The half-space as a full matrix on the whole grid, with its bounded solution by BVLS."""

    @staticmethod
    def influence(grid, contact_modulus):
        """Matrix of ∬dA/(πE*r) over a cell; X asinh(Y/X) + Y asinh(X/Y) is its antiderivative."""
        (nx, ny), (hx, hy) = grid.nodes, grid.spacing

        def corner(X, Y):
            return X * np.arcsinh(Y / np.abs(X)) + Y * np.arcsinh(X / np.abs(Y))

        x, y = hx * np.arange(nx)[:, None], hy * np.arange(ny)[None, :]
        a, b = hx / 2, hy / 2
        u = corner(x + a, y + b) - corner(x - a, y + b)
        u += corner(x - a, y - b) - corner(x + a, y - b)
        i, j = np.divmod(np.arange(nx * ny), ny)
        lag = abs(i[:, None] - i), abs(j[:, None] - j)
        return (u / (np.pi * contact_modulus))[lag]

    @staticmethod
    def pressure(contact, indentation, limit=None, *, plastic=0.0):
        """Pressure on the whole grid: the minimum of ½|Lᵀp − L⁻¹b|² with 0 ≤ p ≤ p_y."""
        limit = contact.hardness if limit is None else limit
        K = Dense.influence(contact.grid, contact.pair.contact_modulus)
        b = (indentation - contact.gap - plastic).ravel()
        unit = indentation / K[0, 0]  # scales the unknowns to order one
        L = cholesky(K / K[0, 0], lower=True)
        c = solve_triangular(L, b / indentation, lower=True)
        found = lsq_linear(L.T, c, (0.0, limit / unit), method="bvls", tol=1e-15)
        return unit * found.x.reshape(contact.grid.nodes)

    @staticmethod
    def gap(contact, pressure, indentation):
        """Deformed gap K p + h₀ − δ on the whole grid."""
        K = Dense.influence(contact.grid, contact.pair.contact_modulus)
        return (K @ pressure.ravel()).reshape(pressure.shape) + contact.gap - indentation

    @staticmethod
    def violation(contact, pressure, indentation, limit=None, *, plastic=0.0):
        """Largest violation of the contact conditions anywhere on the grid, over δ."""
        limit = contact.hardness if limit is None else limit
        g = Dense.gap(contact, pressure, indentation) + plastic
        can_fall, can_rise = pressure > 0, pressure < limit
        return max((g * can_fall).max(), (-g * can_rise).max()) / indentation


@pytest.fixture(scope="session")
def dense():
    return Dense
