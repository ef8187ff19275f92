"""Unloading against loading work, interpolated."""

import numpy as np

from restitution.curve.work_curve import WorkCurve
from tolerance import approx


def test_a_curve_is_not_extrapolated():
    work = np.array([1.0, 10.0, 100.0])
    for first in (0.9, 1.0):  # an impact without loss changes the interpolation
        curve = WorkCurve(work, work * np.array([first, 0.7, 0.6]) ** 2, np.zeros(3))
        found = curve.at(np.array([0.1, 1.0, 10.0, 1e4]))
        assert found == approx([first, first, 0.7, 0.6], rel=1e-12)
    assert np.isnan(WorkCurve(*np.empty((3, 0))).at(np.array([1.0]))).all()


def test_between_impacts_that_stick_and_that_do_not_a_constant_loss_is_interpolated():
    """COR is 0 up to a work of 2 J, the energy that adhesion dissipates, and then rises steeply."""
    work = np.array([1.0, 10.0, 100.0])
    curve = WorkCurve(work, work - 2.0, np.zeros(3))
    between = np.array([1.9, 2.1, 4.0, 50.0])
    assert curve.at(between)[0] == 0
    assert curve.at(between)[1:] == approx(np.sqrt(1 - 2 / between[1:]), rel=1e-9)
