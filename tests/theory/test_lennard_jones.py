"""The Lennard-Jones law between half-spaces, and rigid spheres."""

import math

import numpy as np
from scipy.integrate import quad

from restitution.theory import LennardJones
from tolerance import approx

W, Z0, R = 0.05, 0.3e-9, 2e-6
LAW = LennardJones(W, Z0)


def test_traction_is_the_slope_of_the_energy():
    gap, step = Z0 * np.array([0.8, 1.0, 1.3, 4.0]), 1e-6 * Z0
    slope = (LAW.energy(gap + step) - LAW.energy(gap - step)) / (2 * step)
    assert LAW.traction(gap) == approx(slope, rel=1e-6, abs=1.0)
    assert LAW.energy(Z0) == approx(-W)
    assert LAW.traction(Z0) == approx(0.0, abs=1e-3)


def test_the_largest_traction():
    at = LAW.gap_of_largest_traction
    assert LAW.traction(at) == approx(LAW.largest_traction)
    assert LAW.traction(at) > max(LAW.traction(0.999 * at), LAW.traction(1.001 * at))
    assert LAW.largest_traction == approx(1.0264 * W / Z0, rel=1e-4)


def test_the_traction_of_dugdale_has_the_same_square_integral():
    square, _ = quad(lambda x: float(LAW.traction(x * Z0)) ** 2 * Z0, 1, 200, limit=200)
    assert LAW.dugdale_traction * W == approx(square, rel=1e-6)


def test_rigid_spheres_integrate_the_traction_over_the_paraboloid():
    for gap in (0.9 * Z0, 2 * Z0, 20 * Z0):
        # dA = 2πR dg
        pulled, _ = quad(lambda x, gap=gap: float(LAW.traction(gap * x)) * gap, 1, 3000, limit=400)
        assert LAW.rigid_sphere_force(gap, R) == approx(-2 * math.pi * R * pulled, rel=1e-5)
        step = 1e-5 * gap
        low, high = (LAW.rigid_sphere_energy(gap + sign * step, R) for sign in (-1, 1))
        assert -LAW.rigid_sphere_force(gap, R) == approx((high - low) / (2 * step), rel=1e-6)


def test_bradleys_pull_off():
    assert -LAW.rigid_sphere_force(Z0, R) == approx(2 * math.pi * W * R)
    assert LAW.rigid_pull_off_force(R) == approx(2 * math.pi * W * R)
    gaps = Z0 * np.linspace(0.9, 1.2, 301)
    assert -LAW.rigid_sphere_force(gaps, R).min() == approx(2 * math.pi * W * R, rel=1e-6)
