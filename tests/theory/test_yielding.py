from numpy.testing import assert_allclose

from restitution.theory import hertz, yielding

R, E_STAR, P_Y, MASS = 250e-6, 112e9, 750e6, 2e-6
D_Y = yielding.yield_indentation(R, E_STAR, P_Y)


def test_the_yield_point_lies_on_the_hertz_curves():
    assert_allclose(hertz.peak_pressure(D_Y, R, E_STAR), P_Y, rtol=1e-14)
    assert_allclose(hertz.force(D_Y, R, E_STAR), yielding.yield_force(R, E_STAR, P_Y), rtol=1e-14)


def test_the_yield_velocity_carries_the_energy_stored_at_yield():
    V_y = yielding.yield_velocity(R, E_STAR, P_Y, MASS)
    assert_allclose(0.5 * MASS * V_y**2, hertz.stored_energy(D_Y, R, E_STAR), rtol=1e-14)


def test_the_exact_coefficient_rounds_to_the_published_one():
    assert round(float(yielding.yield_velocity(1.0, 1.0, 1.0, 1.0)), 3) == 3.194


def test_a_sphere_on_a_wall_recovers_the_published_velocity_in_density():
    # Davies (1949): V_y = 1.56 (p_y⁵/(E*⁴ρ))^½ for a sphere of density ρ, whatever its radius
    density = 7800.0
    mass = 4 / 3 * 3.141592653589793 * R**3 * density
    V_y = yielding.yield_velocity(R, E_STAR, P_Y, mass)
    assert round(float(V_y / (P_Y**5 / (E_STAR**4 * density)) ** 0.5), 2) == 1.56
