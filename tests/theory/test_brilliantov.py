import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from restitution.theory import Brilliantov, Hertz
from tolerance import approx

R, E_STAR, MASS, TIME = 250e-6, 1e9, 2e-6, 1e-6


def collision(V, k, gamma):
    """e from ẍ + k x^{3/2} + γ x^½ ẋ = 0, ẋ(0) = V, until ẍ returns to zero at x > 0."""
    length, time = (V**2 / k) ** 0.4, (k**2 * V) ** -0.2

    def motion(t, state):
        x, u = max(state[0], 0.0) * length, state[1] * V
        return [state[1], -(k * x**1.5 + gamma * x**0.5 * u) * time / V]

    def force(t, state):
        return k * state[0] * length + gamma * state[1] * V if t > 1e-6 else 1.0

    force.terminal = True
    path = solve_ivp(motion, (0, 1e3), [0.0, 1.0], events=force, rtol=1e-10, atol=1e-12)
    return -path.y_events[0][0][1]


@pytest.mark.parametrize(
    ("v", "error"), [(0.1, 1e-7), (0.2, 1e-5), (0.4, 2e-4), (0.6, 1e-3), (1.0, 5e-3), (1.8, 9e-3)]
)
def test_the_pade_form_is_the_solution_of_the_equation_of_motion(v, error):
    V, k = 0.3, 5e11
    beta = v**2 / V**0.2
    e = Brilliantov(beta).restitution(V)
    assert e == approx(collision(V, k, beta * k**0.6), abs=error)


def test_the_dissipation_is_that_of_the_viscoelastic_hertz_force():
    # F = 4/3 E*R*^½ (x^{3/2} + 3/2 A x^½ ẋ): Brilliantov et al. (1996)
    V, k = 0.5, Hertz(R, E_STAR).force(1.0) / MASS
    beta = Brilliantov.from_material(R, E_STAR, TIME, MASS).dissipation
    e = Brilliantov(beta).restitution(V)
    assert 0.6 < e < 0.95
    assert e == approx(collision(V, k, 1.5 * TIME * k), abs=1e-3)


def test_the_pade_form_sums_the_series():
    v = np.array([0.01, 0.02, 0.04])
    e = Brilliantov(v**2).restitution(1.0)
    series = 1 - 1.153449 * v**2 + 0.798267 * v**4 + 4 / 15 * v**5
    assert_allclose(e, series, atol=2e-9)
    low = 1 - 1.15344 * v**2 + 0.79826 * v**4
    error = np.abs(e - low)
    assert np.all(error < 2e-5 * v**2 + 0.3 * v**5)


@given(st.floats(1e-6, 1e3), st.floats(1e-4, 10.0), st.floats(1e-3, 1e3))
def test_only_one_number_matters(V, beta, scale):
    other = Brilliantov(beta * scale**-0.2).restitution(V * scale)
    assert_allclose(other, Brilliantov(beta).restitution(V), rtol=1e-12)


@given(st.floats(1e-9, 1e6), st.floats(1.001, 1e3))
def test_faster_means_less_returned(V, ratio):
    e = Brilliantov(0.3).restitution(np.array([V, V * ratio]))
    assert 0 < e[1] < e[0] < 1


def test_a_standing_pair():
    assert np.all(Brilliantov(0.3).restitution(np.array([-1.0, 0.0])) == 1)
