from numpy.testing import assert_allclose

from restitution.theory import FirstYield, Hertz

R, E_STAR, P_Y, MASS = 250e-6, 112e9, 750e6, 2e-6
HERTZ = Hertz(R, E_STAR)
ONSET = FirstYield(R, E_STAR, P_Y)
D_Y = ONSET.indentation


def test_the_yield_point_lies_on_the_hertz_curves():
    assert_allclose(HERTZ.peak_pressure(D_Y), P_Y, rtol=1e-14)
    assert_allclose(HERTZ.force(D_Y), ONSET.force, rtol=1e-14)


def test_the_yield_velocity_carries_the_energy_stored_at_yield():
    V_y = ONSET.velocity(MASS)
    assert_allclose(0.5 * MASS * V_y**2, HERTZ.stored_energy(D_Y), rtol=1e-14)


def test_the_exact_coefficient_rounds_to_the_published_one():
    assert round(float(FirstYield(1.0, 1.0, 1.0).velocity(1.0)), 3) == 3.194


def test_a_sphere_on_a_wall_recovers_the_published_velocity_in_density():
    # Davies (1949): V_y = 1.56 (p_y⁵/(E*⁴ρ))^½ for a sphere of density ρ and any radius
    density = 7800.0
    mass = 4 / 3 * 3.141592653589793 * R**3 * density
    V_y = ONSET.velocity(mass)
    assert round(float(V_y / (P_Y**5 / (E_STAR**4 * density)) ** 0.5), 2) == 1.56
