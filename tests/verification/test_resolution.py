"""Restitution converges where a contact is said to be resolved, and not where it is not."""

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, collide, generate_surface, refine, solve
from restitution.contact.checks.resolution import median_patch, resolves
from restitution.contact.plasticity.bound import ConstantBound

STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25)
GRID = Grid((128, 128), (0.25e-6, 0.25e-6))
DEPTHS = (5e-9, 20e-9, 50e-9, 100e-9, 200e-9)
FACTORS = (1, 2, 4)


@pytest.fixture(scope="module")
def curves():
    """(restitution, resolved) of each depth, on each grid; three surfaces."""
    found = []
    for seed in (1, 2, 3):
        coarse = generate_surface(
            GRID, kind="gaussian", rms=0.1e-6, correlation_length=2e-6, seed=seed
        )
        contacts = [
            Contact(
                Pair(STEEL, STEEL),
                refine(coarse, k),
                plasticity=ConstantBound(750e6),
            )
            for k in FACTORS
        ]
        finest = contacts[-1].gap[:: FACTORS[-1], :: FACTORS[-1]]
        for depth in DEPTHS:
            cases = []
            for k, contact in zip(FACTORS, contacts, strict=True):
                later = float((finest - contact.gap[::k, ::k]).mean())  # first touch is met later
                if depth <= later:
                    cases.append((np.nan, False))
                    continue
                state = solve(contact, depth - later)
                cases.append(
                    (collide(state).restitution, resolves(median_patch(state.patch_sizes())))
                )
            found.append(cases)
    return found


def test_resolved_contacts_have_converged(curves):
    off = [abs(e / cases[-1][0] - 1) for cases in curves for e, good in cases[:-1] if good]
    assert len(off) > 10
    assert max(off) < 0.06
    assert np.sqrt(np.mean(np.square(off))) < 0.02
    finer = [abs(cases[1][0] / cases[2][0] - 1) for cases in curves if cases[0][1]]
    coarser = [abs(cases[0][0] / cases[2][0] - 1) for cases in curves if cases[0][1]]
    assert np.mean(finer) < 0.6 * np.mean(coarser)


def test_contacts_that_are_not_resolved_have_not(curves):
    off = [
        abs(e / cases[-1][0] - 1)
        for cases in curves
        for e, good in cases[:-1]
        if not good and not np.isnan(e)
    ]
    assert len(off) >= 5
    assert max(off) > 0.1
    assert np.sqrt(np.mean(np.square(off))) > 0.05


def test_a_contact_of_one_node_is_never_resolved():
    coarse = generate_surface(GRID, kind="exponential", rms=0.1e-6, correlation_length=2e-6, seed=1)
    state = solve(
        Contact(Pair(STEEL, STEEL), coarse, plasticity=ConstantBound(750e6)),
        8e-9,
    )
    assert state.contact_nodes < 20
    assert not resolves(median_patch(state.patch_sizes()))
