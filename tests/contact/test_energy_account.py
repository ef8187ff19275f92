"""The energy balance of an adhesive cycle, for random cases.

At every state the work done is W = E_el + W_p − Q, where Q is the work of adhesion. Release of
nodes at one indentation moves energy from E_el to −Q and does no work, so over the unloading

    E_el(deepest) = W_u + (adhesive loss) + (plastic work during unloading).
"""

import math

import numpy as np
from hypothesis import HealthCheck, Phase, given, reject, settings
from hypothesis import strategies as st

from contact_keys import contact_of
from restitution import Body, Grid, Pair, collide, generate_surface, smooth, solve
from restitution.contact.jkr.separation import separate, unloading_curve
from restitution.errors import DomainError
from tolerance import approx

STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850.0)
PAIR = Pair(STEEL, STEEL)
# Failing cases are reported as drawn, because shrinking them would take minutes of solves.
few = settings(
    max_examples=6,
    deadline=None,
    derandomize=True,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=list(HealthCheck),
)


cases = st.fixed_dictionaries(
    {
        "nodes": st.tuples(st.integers(24, 40), st.integers(24, 40)),
        "spacing": st.sampled_from([0.1e-6, 0.15e-6, 0.25e-6]),
        "rms": st.sampled_from([0.0, 2e-9, 10e-9]),
        "seed": st.integers(0, 99),
        "yield_pressure": st.sampled_from([math.inf, 0.75e9, 2e9]),
        "work_of_adhesion": st.sampled_from([0.01, 0.03, 0.09]),
        "approach": st.sampled_from(["equilibrium", "hertzian", "pull-increments"]),
        "detachment": st.sampled_from(["crack-closure", "pohrt-popov"]),
        "depth": st.floats(0.3, 0.8),
    }
)


def load(nodes, spacing, rms, seed, depth, **options):
    """The state of a case; `depth` is relative to the largest for smooth spheres on the grid."""
    grid = Grid(nodes, (spacing, spacing))
    surface = smooth(grid)
    if rms:
        surface = generate_surface(
            grid, kind="gaussian", rms=rms, correlation_length=5 * spacing, seed=seed
        )
    held = (0.5 * min(grid.size) - 3 * spacing) ** 2 / (2.4 * PAIR.radius)
    try:
        return solve(contact_of(PAIR, surface, **options), depth * held)
    except DomainError:
        reject()  # asperities, or adhesion on approach, make the contact larger


@few
@given(cases)
def test_the_account_closes(case):
    state = load(**case)
    path = list(separate(state, tolerance=0.01))
    end = path[-1]
    collision = collide(state, path)
    W_u, error = collision.unloading_work, collision.unloading_work_error

    depths = np.array([s.indentation for s in path])
    assert end.contact_nodes == 0
    assert end.force == 0
    assert all(np.diff(depths) < 0)
    assert not end.stored_energy

    yielded = end.plastic_work - state.plastic_work
    assert yielded >= 0
    assert state.stored_energy - W_u - collision.adhesive_loss - yielded == approx(
        0, abs=error * (1 + 1e-9)
    )
    spent = state.loading_work - W_u
    assert spent == approx(
        end.plastic_work - state.adhesive_work + collision.adhesive_loss, abs=error * (1 + 1e-9)
    )
    assert state.stored_energy + error >= W_u
    assert collision.adhesive_loss >= -error
    assert collision.restitution <= 1 + collision.restitution_error

    # The work of the same forces by another rule agrees within the stated error.
    curve = unloading_curve(path)
    assert -float(np.trapezoid(curve.force, curve.indentation)) == approx(
        W_u, abs=error * (1 + 1e-9)
    )


@few
@given(cases)
def test_the_work_of_unloading_is_that_of_its_forces(case):
    """The work of the steps (retract with a fixed contact, then release nodes) is from forces."""
    state = load(**case)
    path = list(separate(state, tolerance=0.001))
    depths = np.array([s.indentation for s in path])
    force = np.array([s.force for s in path])
    pulled = np.array([s.force_before_release for s in path[1:]])
    sawtooth = -float(np.sum(0.5 * (force[:-1] + pulled) * np.diff(depths)))
    scale = state.stored_energy + state.plastic_work
    assert state.loading_work - path[-1].loading_work == approx(sawtooth, abs=2e-3 * scale)


@few
@given(cases)
def test_the_energy_estimate_is_within_its_error(case):
    state = load(**case)
    collision = collide(state, tolerance=0.01)
    estimate = collide(state, method="energy-estimate")
    assert math.isnan(estimate.pull_off_force)
    assert estimate.loading_work == collision.loading_work
    assert collision.unloading_work == approx(
        estimate.unloading_work,
        abs=estimate.unloading_work_error + collision.unloading_work_error,
    )


@settings(few, max_examples=5)
@given(cases)
def test_finer_steps_stay_within_the_error_said(case):
    state = load(**case)
    coarse, fine = (collide(state, tolerance=tolerance) for tolerance in (0.02, 0.005))
    assert coarse.restitution == approx(
        fine.restitution, abs=coarse.restitution_error + fine.restitution_error
    )
    assert coarse.unloading_work == approx(
        fine.unloading_work, abs=coarse.unloading_work_error + fine.unloading_work_error
    )
