"""Factors of plates, waves and viscosity, against closed forms and the full integration."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from elastic_force import elastic
from restitution.contact.bodies import Body, Pair
from restitution.impacts.losses import loss_factors
from restitution.impacts.stored_force import StoredForce
from restitution.impacts.time_integration import collide_in_time
from restitution.losses.half_space import HalfSpace
from restitution.losses.losses import NAMES, Losses
from restitution.losses.plate import Plate
from restitution.losses.viscosity import Friction, Viscosity
from restitution.theory import Brilliantov, FirstYield, ThorntonNing
from tolerance import approx

STEEL = 206e9, 0.29, 7830.0
BALL, WALL = Body(3e-3, *STEEL), Body(math.inf, *STEEL)
LAW = elastic(Pair(BALL, WALL), 2.0)
WAVES = HalfSpace(*STEEL)


def hertz_time(law, velocity):
    """T_h = (m²/(k²V))^⅕ with F = k δ^1.5, the unit of time of Zener's equation."""
    k = law.loading(1.0)
    return (law.pair.mass**2 / (k**2 * velocity)) ** 0.2


def viscous(time=0.0, tangent=0.0):
    return Losses(viscosity=Viscosity(((Friction(time, tangent), 1.0),)))


def factor(losses, velocity=1.0, law=LAW):
    return float(loss_factors(law, losses, np.array([velocity])).together[0])


@pytest.mark.parametrize(
    ("inelasticity", "e"), [(0.1, 0.8433), (0.3, 0.6060), (0.5, 0.437), (1.0, 0.184)]
)
def test_zeners_equation(inelasticity, e):
    """As a plate, α = λT_h/m, and as a viscosity, A = λT_h."""
    time = inelasticity * hertz_time(LAW, 1.0)
    assert factor(viscous(time)) == approx(e, abs=1e-3)
    mobility = time / LAW.pair.mass
    thickness = (Plate(1.0, *STEEL).mobility / mobility) ** 0.5
    assert factor(Losses(plate=Plate(thickness, *STEEL))) == approx(e, abs=1e-3)


@pytest.mark.parametrize("inelasticity", [0.001, 0.01, 0.05])
def test_the_series_for_small_losses(inelasticity):
    series = 1 - 1.7302 * inelasticity + 1.796 * inelasticity**2
    assert factor(viscous(inelasticity * hertz_time(LAW, 1.0))) == approx(series, abs=1e-3)


@pytest.mark.parametrize(("inelasticity", "e"), [(0.1, 0.8451), (0.3, 0.6236)])
def test_a_contact_that_ends_where_the_whole_force_is_zero(inelasticity, e):
    """Brilliantov's law ends there, before the elastic force is zero."""

    def rates(t, y):
        return [y[1], -(max(y[0], 0.0) ** 1.5) - 1.5 * inelasticity * max(y[0], 0) ** 0.5 * y[1]]

    def pulls(t, y):
        return 1.0 if y[1] > 0 else -rates(t, y)[1]

    pulls.terminal = True
    end = solve_ivp(rates, (0, 100), [0.0, 1.0], events=pulls, rtol=1e-9, atol=1e-11).y[1, -1]
    assert -end == approx(e, abs=1e-3)
    time, pair = inelasticity * hertz_time(LAW, 1.0), LAW.pair
    law = Brilliantov.from_material(pair.radius, pair.contact_modulus, time, pair.mass)
    assert float(law.restitution(1.0)) == approx(e, abs=2e-3)  # of the Padé approximant


@pytest.mark.parametrize(
    ("thickness", "e"),
    [(20, 0.994), (10, 0.976), (5, 0.909), (3, 0.769), (2, 0.559), (1, 0.083)],
)
def test_a_steel_ball_of_6_mm_on_sheets(thickness, e):
    assert factor(Losses(plate=Plate(1e-3 * thickness, *STEEL))) == approx(e, abs=2e-3)


@pytest.mark.parametrize(("nu", "k"), [(0.2, 1.097), (0.25, 1.112), (0.3, 1.132), (0.33, 1.148)])
def test_the_energy_of_waves_in_a_half_space_of_the_same_material(nu, k):
    """1 − e² = k (V/c₀)^0.6, c₀ = √(E/ρ)."""
    pair = Pair(Body(3e-3, 206e9, nu, 7830.0), Body(math.inf, 206e9, nu, 7830.0))
    e = factor(Losses(waves=HalfSpace(206e9, nu, 7830.0)), 0.05, elastic(pair, 0.1))
    assert (1 - e**2) / (0.05 / math.sqrt(206e9 / 7830)) ** 0.6 == approx(k, rel=2e-3)


@pytest.mark.parametrize("tangent", [0.002, 0.01])
def test_a_loss_tangent_equal_at_all_frequencies(tangent):
    """The loss of Hertz's pulse, whose spectrum loses the share tan δ at each frequency."""
    law = elastic(Pair(BALL, WALL), 1.0)
    pulse = collide_in_time(law, 0.9)
    t = np.linspace(0, 64 * pulse.duration, 2**16, endpoint=False)
    force = np.interp(t, pulse.time, pulse.force, right=0.0)
    speed = np.interp(t, pulse.time, pulse.closing_velocity, right=0.0)
    spectrum = np.fft.fft(force)
    lagging = np.fft.ifft(1j * np.sign(np.fft.fftfreq(t.size)) * spectrum).real
    lost = tangent * np.trapezoid(lagging * speed, t)
    energy = 0.5 * law.pair.mass * 0.9**2
    assert factor(viscous(tangent=tangent), 0.9, law) == approx(1 - 0.5 * lost / energy, abs=5e-4)
    assert 1 - factor(viscous(tangent=tangent), 0.9, law) == approx(1.410 * tangent, rel=0.03)


@pytest.mark.parametrize(
    "losses", [Losses(plate=Plate(1e4, *STEEL)), viscous(tangent=1e-14), viscous(1e-19)]
)
def test_a_loss_that_vanishes_leaves_the_restitution(losses):
    assert factor(losses) == approx(1.0, abs=1e-12)


def yielding(yield_velocity):
    """Thornton and Ning's spheres up to 1 m/s as stored forces."""
    pair = Pair(BALL, WALL)
    p_y = 1e9
    V_y = float(FirstYield(pair.radius, pair.contact_modulus, p_y).velocity(pair.mass))
    p_y *= (yield_velocity / V_y) ** 0.4
    smooth = ThorntonNing(pair.radius, pair.contact_modulus, p_y)
    depths = float(smooth.indentation_from_velocity(1.01, pair.mass)) * np.geomspace(0.02, 1, 16)
    curves = []
    for deepest in depths:
        end = float(smooth.residual_indentation(deepest))
        x = end + (deepest - end) * np.linspace(0, 1, 200) ** 2
        curves.append((x, np.asarray(smooth.unloading_force(x, deepest))))
    return StoredForce(
        pair,
        float(depths[-1]),
        1.01,
        lambda x: float(smooth.loading_force(max(x, 0.0))),
        lambda x: float(smooth.residual_indentation(x)),
        depths,
        tuple(curves),
    )


@pytest.mark.parametrize("yields_at", [2.0, 0.5, 0.1, 0.01])
@pytest.mark.parametrize("thickness", [20e-3, 5e-3])
def test_the_product_is_that_of_the_full_integration(yields_at, thickness):
    law = yielding(yields_at)
    tangents = Viscosity(((Friction(loss_tangent=0.03), 0.5), (Friction(2e-7), 0.5)))
    losses = Losses(Plate(thickness, *STEEL), WAVES, tangents)
    factors = loss_factors(law, losses, np.array([1.0]))
    free = collide_in_time(law, 1.0)
    whole = collide_in_time(replace(law, losses=losses), 1.0)
    assert free.restitution * factors.product[0] == approx(whole.restitution, abs=5e-3)
    assert free.restitution * factors.together[0] == approx(whole.restitution, abs=5e-4)
    assert factors.duration[0] == approx(free.duration, rel=2e-3)
    assert all(0 < factors.alone[name][0] < 1 for name in NAMES)


def test_energy_is_kept():
    law = replace(LAW, losses=Losses(Plate(3e-3, *STEEL), WAVES, viscous(tangent=0.05).viscosity))
    found = collide_in_time(law, 1.0)
    energy = 0.5 * LAW.pair.mass
    lost = sum(found.lost.values())
    assert energy * (1 - found.restitution**2) == approx(lost, rel=1e-4)
    assert list(found.lost) == list(NAMES)
    assert set(collide_in_time(LAW, 1.0).lost.values()) == {0.0}


def test_bodies_that_stick_have_no_factor():
    """They pull at each other as they part."""
    s = np.linspace(0, 1, 50)
    law = StoredForce(
        Pair(BALL, WALL), 1e-6, 1e-2, lambda x: 1e5 * x, lambda x: -2e-6, np.array([1e-6]),
        ((-2e-6 + 3e-6 * s, np.where(s > 0.9, 0.1 * (s - 0.9) / 0.1, -5e-2)),),
    )  # fmt: skip
    factors = loss_factors(law, Losses(waves=WAVES), np.array([1e-3]))
    assert math.isnan(factors.alone["waves"][0])
    assert factors.alone["plate"][0] == 1.0


def test_a_viscosity_fitted_at_one_velocity_predicts_the_others():
    """A plastic ball on wood (Gugan 2000): 1 − e² = 0.213 + 0.077 V^0.4 from 0.5 to 6 m/s."""
    plastic = 1.2e9, 0.35, 1113.0
    law = elastic(Pair(Body(46e-3, *plastic), Body(math.inf, *plastic)), 6.5)
    V = np.array([0.5, 1.0, 2.19, 5.5, 6.0])
    measured = np.sqrt(1 - 0.213 - 0.077 * V**0.4)
    time = brentq(lambda t: factor(viscous(t), 1.0, law) - measured[1], 1e-6, 1e-3)
    predicted = loss_factors(law, viscous(time), V).together
    assert np.abs(predicted - measured).max() < 0.01
