"""The compact form, against laws that are known."""

import math

import numpy as np
import pytest

from restitution.dem.compact import compact_fit
from restitution.dem.fitted import fitted_laws
from restitution.dem.write import table
from restitution.plots.law import law_figure
from restitution.plots.static import draw
from restitution.theory import thornton_ning, yielding
from tolerance import approx

R, E_STAR, P_Y, MASS = 250e-6, 112e9, 750e6, 2e-6


@pytest.fixture
def with_ratios(law):
    """Make a law with these ratios W_u/W_l at these velocities."""
    some = law()

    def make(V, ratio, **values):
        points = [
            some.points[0].model_copy(
                update={
                    "velocity": float(v),
                    "ratio": float(r),
                    "restitution": float(np.sqrt(np.clip(r, 0, 1))),
                    "resolved": True,
                }
            )
            for v, r in zip(V, ratio, strict=True)
        ]
        return some.model_copy(update={"points": tuple(points), **values})

    return make


def test_thornton_and_nings_law_and_its_elastic_range(with_ratios):
    V_y = float(yielding.yield_velocity(R, E_STAR, P_Y, MASS))
    V = V_y * np.geomspace(0.3, 300, 25)
    e = thornton_ning.restitution(V, R, E_STAR, P_Y, MASS)
    fit = compact_fit(with_ratios(V, e**2))
    assert fit.adhesion == 0
    assert V[0] < fit.elastic_below <= V_y
    assert fit.worst < 0.01
    fine = V_y * np.geomspace(0.3, 300, 400)
    miss = fit.restitution(fine) - thornton_ning.restitution(fine, R, E_STAR, P_Y, MASS)
    assert np.abs(miss).max() < 0.02
    assert (fit.lowest, fit.highest) == (V[0], V[-1])


def test_an_elastic_adhesive_pair_is_its_sticking_velocity(with_ratios):
    V = np.geomspace(0.5, 8, 15)
    fit = compact_fit(with_ratios(V, 1 - (1.2 / V) ** 2, work_of_adhesion=0.1, sticks_below=1.2))
    assert fit.adhesion == approx(1.2**2, rel=1e-6)
    assert len(fit.coefficients) == 1
    assert fit.coefficients[0] == approx(1, rel=1e-9)
    assert fit.adhesive_below == approx(12, rel=1e-6)
    assert fit.restitution(1.1) == 0
    assert fit.worst < 1e-9
    assert fit.between < 1e-9


def test_both(with_ratios):
    """Additive losses, as Thornton and Ning have them."""
    V_y = float(yielding.yield_velocity(R, E_STAR, P_Y, MASS))
    V = V_y * np.geomspace(1.2, 100, 20)
    e = thornton_ning.restitution(V, R, E_STAR, P_Y, MASS)
    V_s = 1.5 * V_y
    fit = compact_fit(with_ratios(V, e**2 - (V_s / V) ** 2, work_of_adhesion=0.1, sticks_below=V_s))
    assert np.sqrt(fit.adhesion) == approx(V_s, rel=0.15)
    assert fit.worst < 0.005


def test_the_error_between_points_is_that_of_a_point_that_is_not_known(with_ratios):
    """A kink between two points cannot be seen, but a point that stands alone can."""
    V = np.geomspace(0.1, 10, 12)
    ratio = np.full(12, 0.5)
    ratio[6] = 0.8
    fit = compact_fit(with_ratios(V, ratio))
    assert fit.between > 0.1


@pytest.mark.parametrize("points", [1, 3])
def test_a_few_points_are_not_worth_a_fit(with_ratios, points):
    V = np.geomspace(1, 2, points)
    assert compact_fit(with_ratios(V, np.full(points, 0.5))) is None


def test_numbers_are_restitutions_whatever_the_fit(with_ratios):
    V = np.geomspace(0.1, 10, 12)
    fit = compact_fit(with_ratios(V, np.linspace(0.99, 0.01, 12)))
    e = fit.restitution(np.geomspace(0.1, 10, 200))
    assert np.all((e >= 0) & (e <= 1))


def test_the_fit_has_no_value_outside_of_the_resolved_points(with_ratios):
    """Lossless where it is resolved, 0.574 where it is not: 1 is said of the resolved only."""
    V = np.geomspace(0.01, 10, 14)
    ratio = np.concatenate([np.full(3, 0.574**2), np.ones(4), np.linspace(0.9, 0.4, 7)])
    law = with_ratios(V, ratio)
    points = [
        point.model_copy(update={"resolved": 3 <= k < 13}) for k, point in enumerate(law.points)
    ]
    law = law.model_copy(update={"points": tuple(points)})
    fit = compact_fit(law)
    assert (fit.lowest, fit.highest) == (V[3], V[12]) == law.fitted_range
    assert fit.elastic_below == V[6]
    assert fit.restitution(V[3:7]).tolist() == [1.0] * 4
    assert np.isnan(fit.restitution(V)).tolist() == [True] * 3 + [False] * 10 + [True]
    assert np.isnan(fit.restitution([0.999 * V[3], 1.001 * V[12]])).all()
    rows = table(law.model_copy(update={"fit": fit}))
    assert [math.isnan(row["compact_fit"]) for row in rows] == [True] * 3 + [False] * 10 + [True]
    drawing = draw(law_figure(law.model_copy(update={"fit": fit, "laws": fitted_laws(law)})))
    lines = [line for line in drawing.axes[0].lines if line.get_linestyle() in ("-", "--")]
    assert len(lines) > 5
    for line in lines:
        drawn = line.get_xdata()[np.isfinite(line.get_ydata())]
        assert drawn.min() >= V[3] * (1 - 1e-9)
        assert drawn.max() <= V[12] * (1 + 1e-9)
