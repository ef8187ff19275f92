"""Error of COR due to the models of plasticity and adhesion."""

import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from contact_keys import contact_of
from restitution import Body, Contact, Grid, Pair, generate_surface, smooth, solve
from restitution.case.models import plasticity_of
from restitution.collision import collide
from restitution.contact.checks.model_error import model_error
from restitution.contact.jkr.limit import JKRLimit, hysteresis_ratio
from restitution.contact.plasticity import bound as constant
from restitution.contact.plasticity import cavity, truncated
from restitution.contact.plasticity.cavity import ExpandingCavity
from tolerance import approx

TABLE = Path(__file__).parents[2] / "evidence" / "plasticity_models" / "models.csv"
BODY = Body(1e-3, 420e9, 0.3)
PAIR = Pair(BODY, BODY)
GRID = Grid((64, 64), (2e-6, 2e-6))


def contact(**yields):
    return contact_of(PAIR, smooth(GRID), **yields)


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


def test_it_is_at_most_the_largest_possible_error():
    """The parts due to plasticity and to adhesion may add up to more than 1."""
    state = solve(contact(yield_pressure=2.8e9, work_of_adhesion=5.0), 5e-7)
    for e in (0.0, 0.2, 0.9):
        assert model_error(state, e) <= max(e, 1 - e)


SPHERES = Path(__file__).parents[2] / "evidence" / "cohesive" / "cohesive_reference.csv"


def test_the_hysteresis_without_range_is_that_of_the_reference():
    with open(SPHERES) as file:
        finest = {float(row["tabor_parameter"]): row for row in csv.DictReader(file)}
    for tabor, row in finest.items():
        exact = float(row["hysteresis_over_jkr"])
        assert hysteresis_ratio(tabor) == approx(exact, abs=3e-4)
    ratios = [hysteresis_ratio(tabor) for tabor in np.geomspace(0.1, 1e4, 60)]
    assert (np.diff(ratios) >= 0).all()
    assert 0.97 < ratios[-1] < 1


@pytest.mark.parametrize("tabor", [0.6, 1.2])
def test_it_covers_the_range_that_jkr_neglects(tabor):
    w, z0, E_star = 0.05, 0.3e-9, 1e11
    radius = tabor**3 * E_star**2 * z0**3 / w**2
    body = Body(2 * radius, 2 * E_star * (1 - 0.3**2), 0.3)
    depth = 6 * tabor * z0
    h = 0.35 * (radius**2 * w / E_star) ** (1 / 3)  # a_c/h = 4.3
    n = 2 * int(np.sqrt(3 * radius * depth) / h + 4)
    jkr = Contact(Pair(body, body), smooth(Grid(n, h)), adhesion=JKRLimit(w))
    state = solve(jkr, depth)
    collision = collide(state)
    error = model_error(state, collision.restitution)
    # At equal work of loading, e² of smooth elastic spheres is 1 minus the loss over the work.
    lost = hysteresis_ratio(tabor) * 7.0922 * (w**5 * radius**4 / E_star**2) ** (1 / 3)
    exact = np.sqrt(1 - lost / state.loading_work)
    assert 0 < exact - collision.restitution <= error + collision.restitution_error
    assert error < 2 * (exact - collision.restitution) + collision.restitution_error


needs_references = pytest.mark.skipif(
    not TABLE.is_file(), reason="evidence/ is not beside the package"
)


def references():
    """Of every collision of the validation: model, COR, that of the reference, and the bound.

    The constant bounds are compared with materials without hardening.
    """
    with open(TABLE, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 200
    for row in rows:
        grows = row["model"] == "expanding-cavity"
        if "hardening" in row["case"] and not grows:
            continue
        strength = float(row["yield_strength_over_contact_modulus"])
        slope = float(row["rms_slope"]) * 1e9 / PAIR.contact_modulus / strength
        e = float(row["restitution"])
        bound = difference(row["model"], slope, e)
        yield row["model"], e, float(row["restitution_reference"]), bound


def difference(model, slope, e):
    """The largest difference for bodies with a yield strength of 1 GPa."""
    yields = {"yield_strength": 1e9, "yield_pressure": 2.8e9}
    del yields["yield_pressure" if model == "expanding-cavity" else "yield_strength"]
    contact = SimpleNamespace(slope=slope, pair=PAIR)
    return plasticity_of(model, **yields).difference(contact, e)


@needs_references
def test_it_covers_the_references():
    """Every COR of the validation is within it (0.002 for what is rounded and interpolated)."""
    for model, e, reference, bound in references():
        assert abs(e - reference) <= bound * e + 2e-3, (model, e)


@needs_references
@pytest.mark.parametrize("model", ["equilibrium", "truncated", "expanding-cavity"])
def test_it_is_no_wider_than_the_references_need(model):
    """The worst of the references near any COR takes more than 0.4 of the bound."""
    found = np.array(sorted(row[1:] for row in references() if row[0] == model))
    for e, reference, bound in (part.T for part in np.array_split(found, 8)):
        used = np.abs(e - reference) / (e * bound)
        assert used.max() > 0.4, (e.min(), e.max())


def test_its_tables_increase():
    """Otherwise the interpolation between their entries means nothing."""
    tables = [(model._RESTITUTION, model._DIFFERENCE) for model in (constant, truncated)]
    tables += [(cavity._STEEPNESS, cavity._GROWING), cavity._NEAR_ONE]
    for known, errors in tables:
        assert len(known) == len(errors)
        assert list(known) == sorted(set(known))
        assert all(0 < error <= 1 for error in errors)


@pytest.mark.parametrize(("psi", "largest"), [(0, 0.03), (4, 0.035), (5, 0.04), (6, 0.045)])
def test_the_growing_bound_is_better_near_one(psi, largest):
    """Its error falls to a half at COR = 0.98 and a fifth at 1, whatever the slope."""
    slope = psi * 1e9 / PAIR.contact_modulus
    shares = {0.3: 1, 0.94: 1, 0.96: 0.75, 0.98: 0.5, 0.99: 0.35, 1.0: 0.2}
    for e, share in shares.items():
        found = difference("expanding-cavity", slope, e)
        assert found == approx(share * largest, rel=1e-6)
    assert difference("expanding-cavity", 40e9 / PAIR.contact_modulus, 0.5) == 0.045


def test_steeper_asperities_have_a_larger_error():
    grid = Grid((64, 64), (0.5e-6, 0.5e-6))
    errors = []
    for rms in (1e-9, 5e-8, 2e-7):
        shape = {"kind": "gaussian", "rms": rms, "correlation_length": 4e-6, "seed": 1}
        state = solve(
            Contact(
                PAIR,
                generate_surface(grid, **shape),
                plasticity=ExpandingCavity(1e9),
            ),
            1e-7,
        )
        errors.append(state.contact.plasticity.difference(state.contact, 0.8))
    assert errors == sorted(errors)
    assert errors[0] == approx(0.03, rel=0.1)
    assert errors[2] > 1.4 * errors[0]


@pytest.mark.parametrize(("model", "table"), [("equilibrium", constant), ("truncated", truncated)])
def test_the_tables_reach_one_where_first_yield_may_be_missed(model, table):
    assert list(table._RESTITUTION) == sorted(set(table._RESTITUTION))
    assert difference(model, 0.0, 1.0) == 0.07
    for e, error in zip(table._RESTITUTION, table._DIFFERENCE, strict=True):
        assert difference(model, 0.0, e) == approx(error)
