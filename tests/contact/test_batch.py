"""Many contacts in one call: each as it is alone."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from restitution import Contact, Surface, solve
from restitution.contact import batch
from restitution.contact.batch import solve_batch
from restitution.errors import CaseError, DomainError, NotConvergedError
from tolerance import approx

DEPTH = 40e-9


def assert_alike(state, alone):
    assert state.indentation == alone.indentation
    assert state.force == approx(alone.force, rel=1e-7)
    assert state.loading_work == approx(alone.loading_work, rel=1e-7)
    assert state.contact_nodes == approx(alone.contact_nodes, abs=1)
    assert_allclose(state.pressure, alone.pressure, atol=1e-6 * alone.pressure.max())


def test_realisations_are_solved_as_each_alone(rough_contact):
    contacts = [rough_contact(seed=seed, yield_pressure=2e9) for seed in range(5)]
    for state, contact in zip(solve_batch(contacts, [DEPTH] * 5), contacts, strict=True):
        assert state.contact is contact
        assert_alike(state, solve(contact, DEPTH))


def test_depths_are_solved_as_each_alone(rough_contact):
    contact = rough_contact((170, 180), (0.08e-6, 0.08e-6))
    depths = DEPTH * np.array([0.01, 1.0, 0.3])
    for state in solve_batch([contact] * 3, list(depths), residual=1e-9):
        assert_alike(state, solve(contact, state.indentation, residual=1e-9))


@settings(deadline=None, max_examples=25)
@given(
    st.lists(
        st.tuples(
            st.integers(0, 10**6), st.floats(1e-9, 60e-9), st.sampled_from([np.inf, 2e9, 5e8])
        ),
        min_size=1,
        max_size=4,
    )
)
def test_any_batch_is_solved_as_each_alone(rough_contact, items):
    contacts = [rough_contact(seed=seed, yield_pressure=limit) for seed, _, limit in items]
    depths = [depth for _, depth, _ in items]
    try:
        alone = [solve(contact, depth) for contact, depth in zip(contacts, depths, strict=True)]
    except DomainError:  # a batch refuses what one of its contacts would
        with pytest.raises(DomainError):
            solve_batch(contacts, depths)
        return
    for state, its_own in zip(solve_batch(contacts, depths), alone, strict=True):
        assert_alike(state, its_own)
        assert state.residual <= 1e-8


def test_what_does_not_belong_together_is_refused(rough_contact):
    contact = rough_contact()
    sticky = Contact(contact.pair, contact.surface, work_of_adhesion=0.05)
    cut = Contact(contact.pair, contact.surface, 1e9, plasticity="truncated")
    finer = rough_contact((20, 20))
    softer_body = replace(contact.pair.first, youngs_modulus=1e9)
    softer = Contact(replace(contact.pair, first=softer_body), contact.surface)
    for other, said in (
        (sticky, "without adhesion"), (cut, "equilibrium model"),
        (finer, "one grid"), (softer, "one contact modulus"),
    ):  # fmt: skip
        with pytest.raises(CaseError, match=said):
            solve_batch([contact, other], [DEPTH, DEPTH])
    for contacts, depths in (([contact], []), ([], []), ([contact], [DEPTH, DEPTH])):
        with pytest.raises(CaseError, match="as many of one as of the other"):
            solve_batch(contacts, depths)
    for depth in (0.0, -1e-9, np.nan, np.inf):
        with pytest.raises(CaseError, match="not a positive depth"):
            solve_batch([contact], [depth])


def test_a_contact_at_the_rim_and_one_that_does_not_converge_are_refused(
    rough_contact, monkeypatch
):
    contact = rough_contact()
    with pytest.raises(DomainError, match="reaches the edge"):
        solve_batch([contact, contact], [DEPTH, 5e-6])
    flat = Contact(contact.pair, Surface(np.zeros(contact.grid.nodes), contact.grid))
    monkeypatch.setattr(batch, "MAX_ITERATIONS", 2)
    with pytest.raises(NotConvergedError, match=r"contact [12] of 2 at an indentation of 40 nm"):
        solve_batch([contact, flat], [DEPTH, DEPTH])
