"""The error of COR by the model of plasticity."""

import csv
import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, smooth, solve
from restitution.collision import collide
from restitution.contact.model_error import model_error

approx = partial(pytest.approx, abs=0.0)
TABLE = Path(__file__).parents[2] / "validation" / "models.csv"
BODY = Body(1e-3, 420e9, 0.3)
PAIR = Pair(BODY, BODY)
GRID = Grid((64, 64), (2e-6, 2e-6))


def contact(**yields):
    return Contact(PAIR, smooth(GRID), **yields)


def test_it_is_zero_where_nothing_yields():
    for each in (contact(), contact(yield_pressure=5e9), contact(yield_strength=2e9)):
        assert model_error(solve(each, 5e-8), 1.0) == 0.0


def test_a_constant_bound_may_miss_a_loss_before_it_yields():
    """Between 1.6 Y and 2.8 Y the constant bound is elastic, and finite elements are not."""
    state = solve(contact(yield_pressure=2.8e9), 1.3e-7)
    assert collide(state).restitution == 1.0
    assert model_error(state, 1.0) == approx(0.07, rel=1e-6)


@pytest.mark.parametrize("yields", [{"yield_strength": 1e9}, {"yield_pressure": 2.8e9}])
def test_adhesion_leaves_the_energy_that_plasticity_may_miss(yields):
    """The same energy is more of a COR that adhesion has made small; never beyond 0 or 1."""
    state = solve(contact(**yields), 5e-7)
    e = collide(state).restitution
    dry, adhesive = model_error(state, e), model_error(state, 0.5 * e)
    assert 0.02 * e < dry < 0.12 * e
    assert dry < adhesive < 0.5 * e
    assert model_error(state, 0.01) <= 0.99


@pytest.mark.skipif(not TABLE.is_file(), reason="validation/ is not beside the package")
def test_it_covers_the_references():
    """Every COR of the validation is within its model_error, but for what the table rounds."""
    from restitution.contact import model_error as module

    with open(TABLE, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 150
    for row in rows:
        e, reference = float(row["restitution"]), float(row["restitution_reference"])
        allowed = float(np.interp(e, *module._FOUND[row["model"]])) * e
        assert abs(e - reference) <= allowed + 2e-3, row


def test_the_tables_are_in_order():
    from restitution.contact import model_error as module

    for at, off in module._FOUND.values():
        assert sorted(at) == list(at)
        assert math.isclose(at[-1], 1.0)
        assert len(at) == len(off)
        assert min(off) > 0
