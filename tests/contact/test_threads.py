"""Concurrent solves in several threads give the results of one thread, to the last digit."""

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from restitution import Contact, operator_cache, solve, step
from restitution.contact.influence import half_space, inverse_half_space
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.plasticity.bound import ConstantBound

THREADS = 4
DEPTH = 40e-9


def in_threads(work):
    """The results of `work(k)` for k < THREADS, started simultaneously with an empty cache."""
    operator_cache.clear()
    start = Barrier(THREADS)

    def begin(k):
        start.wait()
        return work(k)

    with ThreadPoolExecutor(THREADS) as threads:
        return list(threads.map(begin, range(THREADS)))


@pytest.mark.parametrize("adhesion", [None, JKRLimit(0.05)])
def test_one_contact_in_several_threads_is_the_same_to_the_last_digit(rough_contact, adhesion):
    """All threads load one contact to the same depth and unload it a little."""
    plain = rough_contact((170, 180), (0.08e-6, 0.08e-6), yield_pressure=2e9)
    contact = Contact(plain.pair, plain.surface, plasticity=ConstantBound(2e9), adhesion=adhesion)

    def work(_):
        state = solve(contact, DEPTH)
        return state, step(state, 0.9 * DEPTH)

    alone = work(0)
    for together in in_threads(work):
        for state, expected in zip(together, alone, strict=True):
            assert (state.force, state.residual) == (expected.force, expected.residual)
            assert state.convolutions == expected.convolutions
            assert_array_equal(state.pressure, expected.pressure)
            assert_array_equal(state.plastic_displacement, expected.plastic_displacement)


def test_contacts_of_other_depths_do_not_disturb_each_other(rough_contact):
    contact = rough_contact((170, 180), (0.08e-6, 0.08e-6))
    depths = DEPTH * np.linspace(0.4, 1.0, THREADS)
    alone = [solve(contact, depth).pressure for depth in depths]
    for pressure, expected in zip(
        in_threads(lambda k: solve(contact, depths[k]).pressure), alone, strict=True
    ):
        assert_array_equal(pressure, expected)


@pytest.mark.parametrize("make", [half_space, inverse_half_space])
def test_an_operator_that_threads_share_takes_one_after_the_other(make):
    shape = (200, 190)
    operator = make(shape, (1.0, 1.0), 1.0)
    loads = np.random.default_rng(0).random((THREADS, *shape))
    alone = [operator(p) for p in loads]
    for _ in range(5):
        for found, expected in zip(in_threads(lambda k: operator(loads[k])), alone, strict=True):
            assert_array_equal(found, expected)
    assert operator.count == 6 * THREADS
