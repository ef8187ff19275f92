"""Errors of COR near sticking."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from points import point
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.patch.law import PatchAttraction
from restitution.curve.work_curve import WorkCurve
from restitution.numerics.grid import Grid
from restitution.numerics.intervals import half_interval
from restitution.runs.attraction import Sticking, with_errors
from restitution.runs.loss_errors import carried, with_sticking
from restitution.surfaces import Surface
from tolerance import approx

MASS, LOSS = 2e-12, 4e-15
WORK = LOSS * np.array([0.5, 0.9, 1.1, 2.0, 50.0])
VELOCITY = np.sqrt(2 * WORK / MASS)


def test_a_small_error_of_the_loss_is_that_of_the_ratio_divided_by_twice_the_restitution():
    ratio = np.array([0.25, 0.81])
    assert carried(ratio, np.array([1e-5, 1e-5])) == approx([1e-5, 1e-5 / 1.8], rel=1e-4)


@pytest.mark.parametrize("relative", [0.05, 0.3, 2.0])
def test_the_error_contains_the_uncertainty_of_the_sticking_velocity(relative):
    """W_u/W_l = 1 − (V_s/V)² with a V_s between its limits gives COR inside the error."""
    ratio = 1 - LOSS / WORK
    error = carried(ratio, relative * LOSS / WORK)
    here = np.sqrt(np.maximum(ratio, 0))
    for loss in LOSS * np.linspace(max(1 - relative, 0), 1 + relative, 9):
        sticking = math.sqrt(2 * loss / MASS)
        there = np.sqrt(np.maximum(1 - (sticking / VELOCITY) ** 2, 0))
        assert np.all(np.abs(there - here) <= error * (1 + 1e-12))
    assert error[-1] < 0.03  # far above sticking


def curve(loss):
    work = LOSS * np.geomspace(0.1, 100, 7)
    return WorkCurve(work, work - loss, np.zeros(7))


class Companion:
    """Curves of a contact whose COR is 0 at the lowest velocity on all surfaces and grids."""

    own = reference = curve(1.2 * LOSS)

    def __init__(self, adhesion):
        self.coarse = SimpleNamespace(adhesion=adhesion, pair=SimpleNamespace(mass=MASS))
        self.case = SimpleNamespace(roughness=(1,))

    def others(self):
        return [curve(factor * LOSS) for factor in (0.8, 1.0, 1.4, 1.7)]

    def scales(self):
        return None

    def spectra(self):
        return []

    def material_ends(self):
        return []


def test_bodies_that_stick_on_all_grids_and_surfaces_may_yet_rebound():
    flat = Surface(np.zeros((4, 4)), Grid((4, 4), (1e-9, 1e-9)))
    companions = Companion(PatchAttraction((flat,), 1e-8, Cohesive(0.05)))
    ratios = 1 - LOSS / WORK
    points = [
        point(loading_work=work, unloading_work=work * ratio, restitution=math.sqrt(max(ratio, 0)))
        for work, ratio in zip(WORK, ratios, strict=True)
    ]
    columns = {"discretisation_error": np.zeros(5), "surface_scatter": np.zeros(5)}
    errors = with_sticking(columns, companions, points)
    total = np.hypot(*errors.values())
    # The limits of the sticking velocity, with the errors of a run.
    V = math.sqrt(2 * LOSS / MASS)
    off = with_errors(Sticking(V, 0.0, V), companions, scattered=True).error
    for sticking in (V - off, V + off):
        there = np.sqrt(np.maximum(1 - (sticking / VELOCITY) ** 2, 0))
        change = np.abs(there - np.sqrt(np.maximum(ratios, 0)))
        assert np.all(change <= 1.05 * total)  # the errors of losses are not those of velocities
    assert total[1] > 0.5
    grid, surfaces = errors.values()
    assert grid[3] / surfaces[3] == approx(0.2 / scatter([1.2, 0.8, 1.0, 1.4, 1.7]), rel=1e-3)
    # Without patches, and where the columns are larger, nothing changes.
    assert with_sticking(columns, Companion(Cohesive(0.05)), points) == columns
    wide = {"discretisation_error": np.ones(5)}
    assert with_sticking(wide, companions, points)["discretisation_error"] == approx(np.ones(5))


def scatter(values):
    mean, n = np.mean(values), len(values)
    return abs(values[0] - mean) + half_interval(n) * np.std(values, ddof=1)
