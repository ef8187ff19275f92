"""Error of COR due to the plasticity model."""

import csv
from pathlib import Path
from types import SimpleNamespace

import pytest

from restitution import Body, Contact, Grid, Pair, generate_surface, smooth, solve
from restitution.collision import collide
from restitution.contact.model_error import largest_difference, model_error
from tolerance import approx

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
    """Between 1.6 Y and 2.8 Y the constant bound is elastic, but finite elements yield."""
    state = solve(contact(yield_pressure=2.8e9), 1.3e-7)
    assert collide(state).restitution == 1.0
    assert model_error(state, 1.0) == approx(0.07, rel=1e-6)


@pytest.mark.parametrize("yields", [{"yield_strength": 1e9}, {"yield_pressure": 2.8e9}])
def test_adhesion_leaves_the_energy_that_plasticity_may_miss(yields):
    """The error in energy is a larger error of a COR reduced by adhesion; COR stays in [0, 1]."""
    state = solve(contact(**yields), 5e-7)
    e = collide(state).restitution
    dry, adhesive = model_error(state, e), model_error(state, 0.5 * e)
    assert 0.02 * e < dry < 0.12 * e
    assert dry < adhesive < 0.5 * e
    assert model_error(state, 0.01) <= 0.99


@pytest.mark.skipif(not TABLE.is_file(), reason="validation/ is not beside the package")
def test_it_covers_the_references():
    """Every COR of the validation is within the error (plus 0.002 for rounding and interpolation).

    The constant bounds are compared with materials without hardening.
    """
    with open(TABLE, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 200
    for row in rows:
        grows = row["model"] == "expanding-cavity"
        if "hardening" in row["case"] and not grows:
            continue
        yields = {"yield_strength": 1e9} if grows else {"yield_pressure": 2.8e9}
        slope = float(row["rms_slope"])
        pressed = SimpleNamespace(
            contact=SimpleNamespace(
                grows=grows, plasticity=row["model"], slope=slope, pair=PAIR, **yields
            )
        )
        strength = float(row["yield_strength_over_contact_modulus"])
        pressed.contact.slope *= yields.get("yield_strength", 0) / PAIR.contact_modulus / strength
        e, reference = float(row["restitution"]), float(row["restitution_reference"])
        assert abs(e - reference) <= largest_difference(pressed, e) * e + 2e-3, row


def test_steeper_asperities_have_a_larger_error():
    grid = Grid((64, 64), (0.5e-6, 0.5e-6))
    errors = []
    for rms in (1e-9, 5e-8, 2e-7):
        shape = {"kind": "gaussian", "rms": rms, "correlation_length": 4e-6, "seed": 1}
        state = solve(Contact(PAIR, generate_surface(grid, **shape), yield_strength=1e9), 1e-7)
        errors.append(largest_difference(state, 0.8))
    assert errors == sorted(errors)
    assert errors[0] == approx(0.03, rel=0.1)
    assert errors[2] > 1.6 * errors[0]
