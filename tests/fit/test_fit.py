"""Parameters are recovered from data of known ones, and what the data do not tell is said."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evidence.fit import fit_model_error
from restitution.case.case_file import parse_case
from restitution.errors import CaseError
from restitution.fit.findings import combination, findings, identifiable
from restitution.fit.fit import fit
from restitution.fit.measured import Measured
from restitution.fit.uncertainty import MODEL_SHARES
from restitution.theory import ThorntonNing
from tolerance import approx


def values(found):
    return [
        each.value * factor for each, factor in zip(found.parameters, found.factors, strict=True)
    ]


def test_exact_data_give_the_parameter_back(smooth_case, measure):
    measured = measure(smooth_case("900 MPa"), given=False)
    found = fit(smooth_case("2500 MPa"), Path(), measured, ["interface.yield_pressure"])
    # The curve is interpolated between depths.
    assert values(found) == approx([900e6], rel=0.01)
    assert identifiable(found, 0)
    assert math.exp(found.uncertainty.halves[0]) < 1.2


def with_size_effect(text, length):
    return text.replace("[interface]", f'[interface]\nsize_effect = "{length}"')


@pytest.mark.parametrize("seed", [1, 2])
def test_the_size_effect_is_recovered_within_its_interval(smooth_case, measure, seed):
    measured = measure(with_size_effect(smooth_case("900 MPa"), "100 um"), noise=0.01, seed=seed)
    case = with_size_effect(smooth_case("900 MPa"), "30 um")
    known = fit(case, Path(), measured, ["size_effect"])
    assert abs(math.log(values(known)[0] / 100e-6)) < 1.3 * known.uncertainty.halves[0]
    assert identifiable(known, 0)


def test_smooth_spheres_do_not_tell_the_size_effect_from_the_yield_pressure(smooth_case, measure):
    """Both set one hardness, H₀ √(1 + R*/R)."""
    measured = measure(with_size_effect(smooth_case("900 MPa"), "100 um"), noise=0.01, seed=1)
    case = with_size_effect(smooth_case("700 MPa"), "150 um")
    both = fit(case, Path(), measured, ["size_effect", "yield_pressure"])
    assert not identifiable(both, 0)
    assert any("not identifiable from these data" in sentence for sentence in findings(both))
    assert any("determine only the combination" in sentence for sentence in findings(both))
    pressure, length = values(both)[1], values(both)[0]
    share = 2 / (3 * 0.358**2) / 250e-6 * 0.5  # two equal spheres share the imprint
    hardness, true = (p * math.sqrt(1 + share * h) for p, h in ((pressure, length), (0.9e9, 1e-4)))
    assert hardness == approx(true, rel=0.05)


def test_yield_and_roughness_are_recovered_within_their_intervals(recovered):
    assert [each.key for each in recovered.parameters] == [
        "interface.yield_pressure",
        "roughness.rms",
    ]
    for value, true, half in zip(
        values(recovered), (1e9, 0.05e-6), recovered.uncertainty.halves, strict=True
    ):
        assert abs(math.log(value / true)) < half
        assert half < math.log(2)
    assert recovered.chi_squared < 3 * recovered.freedom
    assert not any("not identifiable" in sentence for sentence in findings(recovered))


def test_intervals_grow_with_the_noise(recovered):
    by = recovered.deviations
    noisy = replace(recovered.uncertainty, deviations=replace(by, random=3 * by.random))
    assert noisy.deviation("noise") == approx(3 * recovered.uncertainty.deviation("noise"))
    assert all(np.array(noisy.halves) > recovered.uncertainty.halves)


def test_one_velocity_does_not_determine_two_parameters(rough_case, measure):
    text = rough_case("1000 MPa", "0.05 um")
    one = text[: text.index("velocity = [")] + 'velocity = "0.06 m/s"\n[unloading]\ncurves = 0\n'
    point = measure(one)
    e = point.restitution[0] + np.array([-0.01, 0.0, 0.01])
    repeated = Measured(np.repeat(point.velocity, 3), e, np.full(3, 0.01))
    found = fit(text, Path(), repeated, ["yield_pressure", "rms"])
    said = findings(found)
    assert not identifiable(found, 0) or not identifiable(found, 1)
    assert "not identifiable from these data" in said[0]
    exponents, half = combination(found)
    assert half < math.log(2)
    assert max(exponents.values()) == 1.0
    if len(exponents) > 1:
        assert any("determine only the combination" in sentence for sentence in said)


@pytest.mark.parametrize(
    ("case", "free"), [("rough", "rms"), ("smooth", "yield_pressure")], ids=["rms", "yield"]
)
def test_a_parameter_without_effect_is_not_identifiable(rough_case, smooth_case, case, free):
    # An elastic contact returns everything, whatever its roughness; and so does one that would
    # yield at ten times the velocity.
    text = rough_case("elastic", "0.05 um") if case == "rough" else smooth_case("90 GPa")
    measured = Measured(np.array([0.01, 0.03, 0.1]), np.ones(3), np.full(3, 0.01))
    found = fit(text, Path(), measured, [free])
    assert not identifiable(found, 0)
    assert "not identifiable from these data: restitution at these" in findings(found)[0]
    assert math.isinf(found.uncertainty.halves[0])


def test_the_end_of_the_search_is_said(smooth_case, measure):
    measured = measure(smooth_case("900 MPa"), noise=0.01)
    found = fit(smooth_case("40 GPa"), Path(), measured, ["yield_pressure"])
    assert any(
        "ended at the limit of the search, a factor of 30 below" in s for s in findings(found)
    )


def test_another_minimum_as_good_is_said(recovered):
    best = recovered.minima[0]
    far = replace(best, x=best.x + 2.0)
    said = findings(replace(recovered, minima=[best, far]))
    assert any("the fit is not unique" in sentence for sentence in said)
    worse = replace(far, squares=best.squares + 1000.0)
    assert not any("not unique" in s for s in findings(replace(recovered, minima=[best, worse])))


def test_data_that_the_case_does_not_explain_are_said(recovered):
    measured = recovered.measured
    odd = 0.3 * (-1.0) ** np.arange(measured.velocity.size)
    moved = replace(recovered, measured=replace(measured, restitution=measured.restitution + odd))
    assert any("does not explain the data" in sentence for sentence in findings(moved))
    assert not any("does not explain" in sentence for sentence in findings(recovered))


def test_contacts_that_are_not_resolved_are_said(recovered):
    few = np.arange(recovered.resolved.size) >= 2
    said = findings(replace(recovered, resolved=few))
    assert any(
        "does not resolve the contact at 2 of 6 measured points, and" in sentence
        for sentence in said
    )


def test_an_unknown_error_of_the_grid_is_said(recovered):
    by = replace(recovered.deviations, grid=None)
    said = findings(replace(recovered, deviations=by))
    assert any("do not include the error of the grid" in sentence for sentence in said)


def test_the_grid_is_refined_once_for_all_values(smooth_case):
    text = smooth_case("900 MPa").replace("nodes = 48", 'nodes = 12\nrefine = "auto"')
    measured = Measured(np.array([0.05, 0.1]), np.array([0.8, 0.7]), np.array([0.01, 0.01]))
    found = fit(text.replace("0.8 um", "3.2 um"), Path(), measured, ["yield_pressure"])
    assert found.model.case(found.x).grid.refine in {2, 4}


def test_fewer_points_than_parameters_are_refused(rough_case):
    one = Measured(np.array([0.1]), np.array([0.7]), np.array([0.01]))
    with pytest.raises(CaseError, match="1 measured point cannot determine 2 keys"):
        fit(rough_case("1 GPa", "0.05 um"), Path(), one, ["rms", "yield_pressure"])
    with pytest.raises(CaseError, match=r"as many keys as measured points \(1\)"):
        fit(rough_case("1 GPa", "0.05 um"), Path(), replace(one, deviation=None), ["rms"])
    bare = Measured(np.array([0.05, 0.1]), np.array([0.8, 0.7]), None)
    with pytest.raises(CaseError, match="add the column restitution_std"):
        fit(rough_case("1 GPa", "0.05 um"), Path(), bare, ["rms", "yield_pressure"])


def test_a_case_that_cannot_be_solved_is_refused(smooth_case):
    fast = Measured(np.array([5.0, 9.0]), np.array([0.3, 0.2]), np.array([0.01, 0.01]))
    with pytest.raises(CaseError, match="cannot be solved at the first guess"):
        fit(smooth_case("900 MPa"), Path(), fast, ["yield_pressure"])


@pytest.mark.parametrize(("p_y", "seed"), [(0.8e9, 0), (1.4e9, 1), (2.5e9, 2)])
def test_the_combined_interval_holds_the_yield_pressure_of_another_model(smooth_case, p_y, seed):
    """The closed form of Thornton and Ning cuts the pressure off, which the case does not."""
    bodies = parse_case(smooth_case("1 GPa")).pair()
    fastest = 0.13 * (p_y / 1e9) ** 2.5
    V = np.geomspace(fastest / 13, fastest, 8)
    exact = ThorntonNing(bodies.radius, bodies.contact_modulus, p_y).restitution(V, bodies.mass)
    noise = 0.01 * np.random.default_rng(seed).standard_normal(V.size)
    measured = Measured(V, exact + noise, np.full(V.size, 0.01))
    text = smooth_case(f"{1.5e-6 * p_y} MPa").replace("0.8 um", f"{0.8 * p_y / 1e9} um")
    found = fit(text, Path(), measured, ["yield_pressure"])
    off = abs(math.log(values(found)[0] / p_y))
    assert off < found.uncertainty.combined_halves[0] < math.log(1.5)
    assert found.uncertainty.halves[0] < off  # the interval of the data alone misses it


@pytest.mark.parametrize("model", sorted(MODEL_SHARES))
def test_the_share_of_the_model_error_is_that_of_the_finite_elements(model):
    found = np.quantile(fit_model_error.shares(model), 0.95)
    assert 0.9 * MODEL_SHARES[model] < found <= MODEL_SHARES[model]
