"""Closed forms beside the curves of a run: which are drawn, over which range, and their values."""

import math

import numpy as np
import pytest
import xarray as xr

from restitution.compare.references import (
    force_references,
    least_indentation,
    restitution_references_by_indentation,
    restitution_references_by_velocity,
)
from restitution.theory import JKR, AdhesiveThorntonNing, Hertz, ThorntonNing
from tolerance import approx

R, E, M, P_Y, W = 250e-6, 112e9, 2e-6, 750e6, 0.1
DEPTH, SPEED = np.array([2e-8, 1e-7, 4e-7]), np.array([np.nan, 0.02, 0.1])


def results(p_y=math.inf, w=0.0, unloading=()):
    """What is stored of a run, as far as references look at it."""
    stored = {
        "indentation": ("indentation_max", DEPTH),
        "impact_velocity": ("indentation_max", SPEED),
    }
    if unloading:
        for k, name in enumerate(("unloading_indentation", "unloading_force")):
            values = np.array([curve[k] for curve in unloading])
            stored[name] = (("unloading", "unloading_step"), values)
    derived = {
        "derived_reduced_radius_m": R,
        "derived_contact_modulus_Pa": E,
        "derived_yield_pressure_Pa": "None" if math.isinf(p_y) else p_y,
        "derived_reduced_mass_kg": M,
    }
    if w:
        derived["derived_work_of_adhesion_J_per_m2"] = w
    return xr.Dataset(stored, attrs=derived)


def test_the_force_of_elastic_bodies_is_hertz():
    (found,) = force_references(results())
    assert found.label == "Hertz, smooth"
    assert not found.yields
    assert (found.x[0], found.x[-1]) == (approx(0.7 * DEPTH[0]), approx(DEPTH[-1]))
    assert found.y == approx(Hertz(R, E).force(found.x))


def test_bodies_that_yield_have_both_forces():
    elastic, plastic = force_references(results(P_Y))
    assert (elastic.yields, plastic.yields) == (False, True)
    assert plastic.y == approx(ThorntonNing(R, E, P_Y).loading_force(plastic.x))


def test_adhesive_bodies_have_jkr_from_the_break_on():
    (found,) = force_references(results(w=W))
    assert found.label == "JKR, smooth elastic"
    assert found.x[0] == approx(float(JKR(R, E, W).break_indentation))
    assert (np.diff(found.x) > 0).all()
    assert found.y == approx(JKR(R, E, W).force(found.x))


@pytest.mark.parametrize(("p_y", "w", "laws"), [(math.inf, 0, 0), (P_Y, 0, 1), (P_Y, W, 2)])
def test_restitution_by_indentation(p_y, w, laws):
    found = restitution_references_by_indentation(results(p_y, w))
    assert [each.yields for each in found] == [True, False][:laws]
    exact = (
        ThorntonNing(R, E, P_Y).restitution_at_indentation,
        JKR(R, E, W).restitution_at_indentation,
    )
    for each, expected in zip(found, exact, strict=False):
        assert (each.x[0], each.x[-1]) == (approx(DEPTH[0]), approx(DEPTH[-1]))
        assert each.y == approx(expected(each.x))


@pytest.mark.parametrize(
    ("p_y", "w", "exact"),
    [
        (P_Y, W, AdhesiveThorntonNing(R, E, P_Y, W)),
        (math.inf, W, JKR(R, E, W)),
        (P_Y, 0.0, ThorntonNing(R, E, P_Y)),
    ],
)
def test_restitution_by_velocity(p_y, w, exact):
    """Over the velocities that are known: one depth has none."""
    (found,) = restitution_references_by_velocity(results(p_y, w))
    assert (found.x[0], found.x[-1]) == (approx(0.02), approx(0.1))
    assert found.yields == math.isfinite(p_y)
    np.testing.assert_allclose(found.y, exact.restitution(found.x, M), rtol=1e-12)


def test_elastic_bodies_have_no_loss_to_show():
    assert restitution_references_by_velocity(results()) == []


def test_the_least_indentation_is_of_loading_or_unloading_under_force():
    """Not where unloading pulls, and not where it pushes beyond zero."""
    assert least_indentation(results()) == DEPTH[0]
    shallow = (np.array([-1e-9, 0.0, 3e-9, 5e-9]), np.array([1.0, 1.0, -1.0, 1.0]))
    deep = (np.array([4e-9, 1e-7, 2e-7, 4e-7]), np.array([0.0, 1.0, 2.0, 3.0]))
    assert least_indentation(results(unloading=[shallow, deep])) == 5e-9
    assert least_indentation(results(unloading=[deep])) == DEPTH[0]
    pulls = (np.array([1e-9, 2e-9, 3e-9, 4e-9]), np.full(4, -1.0))
    assert least_indentation(results(unloading=[pulls])) == DEPTH[0]
