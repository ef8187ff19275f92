"""Damping parameters return their restitution in the equations of motion."""

import pytest
from scipy.integrate import solve_ivp

from restitution.dem.damping import (
    dashpot_ratio,
    dashpot_restitution,
    hertz_damping,
    hertz_restitution_at,
    hunt_crossley_dissipation,
    hunt_crossley_restitution,
)
from tolerance import approx

RESTITUTIONS = (0.999, 0.9, 0.5, 0.1)


def rebound(pull, ends):
    """x″ = −pull(x, x′) from x = 0, x′ = 1 until `ends(x, x′)` falls to zero."""

    def end(t, y):
        return ends(*y) if t > 1e-4 else 1.0

    end.terminal, end.direction = True, -1
    found = solve_ivp(
        lambda t, y: [y[1], -pull(*y)], (0, 1e4), [0.0, 1.0], rtol=1e-10, atol=1e-14, events=end
    )
    assert found.status == 1
    return -found.y[1, -1]


@pytest.mark.parametrize("e", RESTITUTIONS)
def test_dashpot_without_tension(e):
    ratio = dashpot_ratio(e)

    def pull(x, v):
        return x + 2 * ratio * v

    assert rebound(pull, pull) == approx(e, rel=1e-6)


def test_dashpot_is_continuous_where_the_damping_is_critical():
    assert dashpot_restitution(1 - 1e-9) == approx(dashpot_restitution(1), rel=1e-6)
    assert dashpot_restitution(1 + 1e-9) == approx(dashpot_restitution(1), rel=1e-6)


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("e", RESTITUTIONS)
def test_hunt_crossley_with_any_force(e, power):
    d = hunt_crossley_dissipation(e)
    found = rebound(lambda x, v: max(x, 0.0) ** power * (1 + d * v), lambda x, v: x)
    assert found == approx(e, rel=1e-4)


@pytest.mark.parametrize("e", [1.0, 0.99999, 0.9, 0.5, 0.05, 0.01])
def test_hunt_crossley_and_its_inverse(e):
    assert hunt_crossley_restitution(hunt_crossley_dissipation(e)) == approx(e, rel=1e-9)


@pytest.mark.parametrize("loss", [1e-12, 1e-9, 1e-7, 1e-5])
def test_hunt_crossley_with_hardly_any_dissipation(loss):
    """The search for e did not converge here."""
    found = 1 - hunt_crossley_restitution(hunt_crossley_dissipation(1 - loss))
    assert found == approx(loss, rel=2e-3)


@pytest.mark.parametrize("e", RESTITUTIONS)
def test_hertz_with_constant_damping(law, e):
    """In SI units, at a velocity of 0.3 m/s."""
    found, V = law(), 0.3
    damping = hertz_damping(found, V, e)
    stiffness = 4 / 3 * found.contact_modulus * found.radius**0.5
    scale = 1e-6  # m; the time is in scale/V

    def pull(x, v):
        force = stiffness * max(x * scale, 0.0) ** 1.5 + damping * v * V
        return force / found.mass * scale / V**2

    assert rebound(pull, lambda x, v: x) == approx(e, rel=1e-4)
    assert hertz_restitution_at(found, damping, V) == approx(e, rel=1e-6)
    assert hertz_restitution_at(found, damping, 2 * V) > e
