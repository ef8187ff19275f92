"""A law at a coverage: its errors, its sticking, and what it does not know."""

from dataclasses import replace

import numpy as np
import pytest

from restitution.laws.coverage import at_coverage
from restitution.laws.law import CoveredPoint
from tolerance import approx


@pytest.fixture
def worn(law):
    """A law with losses and coverages 0 and 2, which sticks at the first two velocities."""

    def make(share=0.8, loss_error=0.01):
        base = law(work_of_adhesion=0.05)
        points = tuple(
            replace(
                point,
                quasi_static=point.restitution,
                restitution=share * point.restitution,
                ratio=(share * point.restitution) ** 2,
                factors={"waves": share},
                loss_error=loss_error,
                separation=0.5 * point.indentation,
            )
            for point in base.points
        )
        run_in = tuple(
            CoveredPoint(
                velocity=point.velocity,
                coverage=coverage,
                restitution=0.0 if k < 2 else 0.5,
                error=0.03,
                deviation=0.02,
                quantiles=(0.0,) * 5 if k < 2 else (0.4, 0.45, 0.5, 0.55, 0.6),
                indentation=2 * point.indentation,
                force=point.force,
                pull_off_force=1e-6,
            )
            for k, point in enumerate(points)
            for coverage in (0.0, 2.0)
        )
        return replace(base, points=points, run_in=run_in)

    return make


def test_the_losses_lower_the_restitution_and_its_error_once(worn):
    point = at_coverage(worn(), 1).points[-1]
    assert point.restitution == approx(0.8 * 0.5)
    assert point.error == approx(0.8 * 0.03 + 0.01)
    assert point.deviation == approx(0.8 * 0.02)
    assert point.quantiles == approx(0.8 * np.array([0.4, 0.45, 0.5, 0.55, 0.6]))
    assert at_coverage(worn(loss_error=None), 1).points[-1].error == approx(0.8 * 0.03)


def test_it_sticks_up_to_the_velocity_at_which_all_places_stick(worn):
    law = at_coverage(worn(), 1)
    assert law.sticks_below == law.points[1].velocity


def test_the_separation_of_the_first_impact_is_not_kept(worn):
    """It belongs to another indentation."""
    assert all(point.separation is None for point in at_coverage(worn(), 1).points)
