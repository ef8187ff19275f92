"""What follows from the energies of one contact."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from contact_keys import contact_of
from restitution.collision import Collision, collide
from restitution.contact.bodies import Body, Pair
from restitution.contact.contact import Contact, smooth
from restitution.contact.jkr.approach import HertzianApproach
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.loading import solve, step
from restitution.contact.plasticity.truncated import Truncated
from restitution.numerics.grid import Grid
from tolerance import approx

UM, NM = 1e-6, 1e-9
STEEL = Body(500 * UM, 210e9, 0.25, density=7850.0)


def contact(first=STEEL, second=STEEL, **options):
    return contact_of(Pair(first, second), smooth(Grid((25, 23), (0.5 * UM, 0.5 * UM))), **options)


def test_values_worked_out_by_hand():
    # e = sqrt(2/8) = ½; ½·4·V² = 8
    collision = Collision(loading_work=8.0, unloading_work=2.0, mass=4.0)
    assert collision.restitution == 0.5
    assert collision.impact_velocity == 2.0
    assert Collision(8.0, 2.0, None).impact_velocity is None
    assert Collision(8.0, 8.0, 4.0).restitution == 1.0
    assert Collision(8.0, 0.0, 4.0).restitution == 0.0


@given(st.floats(1e-30, 1e6), st.floats(1e-6, 1), st.floats(1e-20, 1e6))
def test_the_energies_are_those_of_the_velocities(work, returned, mass):
    collision = Collision(work, returned * work, mass)
    rebound = collision.restitution * collision.impact_velocity
    assert 0.5 * mass * collision.impact_velocity**2 == approx(work, rel=1e-12)
    assert 0.5 * mass * rebound**2 == approx(returned * work, rel=1e-12)
    assert 0 < collision.restitution <= 1


def test_a_solve_gives_works_and_mass():
    state = solve(contact(yield_pressure=750e6), 100 * NM)
    collision = collide(state)
    assert collision.loading_work == state.loading_work
    assert collision.unloading_work == state.stored_energy
    assert collision.mass == state.contact.pair.mass
    assert collision.restitution**2 == approx(
        state.stored_energy / (state.stored_energy + state.plastic_work), rel=1e-12
    )
    assert 0 < collision.restitution < 0.95


def test_elastic_bodies_lose_nothing():
    assert collide(solve(contact(), 40 * NM)).restitution == 1.0
    assert collide(solve(contact(yield_pressure=1e15), 40 * NM)).restitution == 1.0


def test_restitution_falls_with_depth_and_with_yield_pressure():
    depths = np.array([35, 50, 75, 100]) * NM
    by_depth = [collide(solve(contact(yield_pressure=750e6), d)).restitution for d in depths]
    assert (np.diff(by_depth) < 0).all()
    by_pressure = [
        collide(solve(contact(yield_pressure=p), 50 * NM)).restitution for p in (1e8, 4e8, 8e8, 2e9)
    ]
    assert (np.diff(by_pressure) > 0).all()


def test_hertz_velocity():
    """½ m* V² = 8/15 E* R*^½ δ^{5/2}, eleven nodes over the contact radius: 1 %."""
    fine = Contact(Pair(STEEL, STEEL), smooth(Grid((31, 31), (0.25 * UM, 0.25 * UM))))
    depth = (2.75 * UM) ** 2 / 250e-6
    work = 8 / 15 * 112e9 * math.sqrt(250e-6) * depth**2.5
    mass = 2 / 3 * math.pi * 500e-6**3 * 7850
    velocity = collide(solve(fine, depth)).impact_velocity
    assert velocity == approx(math.sqrt(2 * work / mass), rel=1e-2)


def test_a_wall_doubles_the_mass_of_like_spheres():
    wall = Body(math.inf, 210e9, 0.25)
    assert collide(solve(contact(second=wall), 30 * NM)).mass == approx(STEEL.mass, rel=1e-14)
    assert collide(solve(contact(), 30 * NM)).mass == approx(STEEL.mass / 2, rel=1e-14)


def test_without_a_density_there_is_a_restitution_but_no_velocity():
    light = Body(500 * UM, 210e9, 0.25)
    collision = collide(solve(contact(light, STEEL, yield_pressure=750e6), 100 * NM))
    assert collision.impact_velocity is None
    assert collision.mass is None
    assert collision.restitution == approx(
        collide(solve(contact(yield_pressure=750e6), 100 * NM)).restitution, rel=1e-12
    )


def test_the_way_to_the_deepest_point_does_not_matter():
    at_once = solve(contact(yield_pressure=750e6), 100 * NM, residual=1e-11)
    state = solve(contact(yield_pressure=750e6), 40 * NM, residual=1e-11)
    for nm in (60, 45, 80, 100):  # once back on the way
        state = step(state, nm * NM, residual=1e-11)
    assert collide(state).restitution == approx(collide(at_once).restitution, rel=1e-8)


def test_no_collision_returns_more_than_it_took():
    grid = Grid((41, 41), (0.25 * UM, 0.25 * UM))
    below_yield = Contact(Pair(STEEL, STEEL), smooth(grid), plasticity=Truncated(1e12))
    assert collide(solve(below_yield, 20 * NM)).restitution <= 1 + 1e-8


def test_the_errors_of_both_works_move_restitution():
    """To first order de = ½e (dW_u/W_u + dW_l/W_l), of which the two are independent."""
    collision = Collision(8.0, 2.0, 4.0, loading_work_error=8e-4, unloading_work_error=6e-4)
    by_loading, by_unloading = 0.25 * 1e-4, 0.25 * 3e-4
    expected = math.hypot(by_loading, by_unloading)
    assert collision.restitution_error == approx(expected, rel=1e-3)
    only = Collision(8.0, 2.0, 4.0, loading_work_error=8e-4)
    assert only.restitution_error == approx(by_loading, rel=1e-3)


def test_the_energy_estimate_may_be_off_by_the_surface_energy():
    grid = Grid((48, 48), (0.25e-6, 0.25e-6))
    body = Body(500e-6, 210e9, 0.3)
    contact = Contact(
        Pair(body, body), smooth(grid), adhesion=JKRLimit(0.05, approach=HertzianApproach())
    )
    state = solve(contact, 2e-8)
    estimate = collide(state, method="energy-estimate")
    assert estimate.unloading_work_error == approx(0.05 * state.contact_area, rel=1e-12)
