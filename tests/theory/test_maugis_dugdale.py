"""Maugis' spheres: both limits, and the pull-off of the Lennard-Jones reference."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from restitution.theory import LennardJones, MaugisDugdale
from tolerance import approx

W, Z0, E_STAR = 0.05, 0.3e-9, 1e11
REFERENCE = Path(__file__).parents[2] / "evidence/cohesive/cohesive_reference.csv"


def spheres(tabor, traction="largest_traction"):
    radius = np.asarray(tabor) ** 3 * E_STAR**2 * Z0**3 / W**2
    return MaugisDugdale(radius, E_STAR, W, getattr(LennardJones(W, Z0), traction))


def over_jkr(law):
    return law.pull_off_force / (1.5 * math.pi * W * law.radius)


def test_limits():
    rigid, soft = spheres(1e-4), spheres(1e3)
    assert over_jkr(rigid) == approx(4 / 3, rel=2e-4)
    assert over_jkr(soft) == approx(1.0, rel=1e-5)


def test_the_transition_parameter_of_johnson_and_greenwood():
    assert spheres(2.0).transition_parameter == approx(1.157 * 2.0, rel=1e-3)


def test_pull_off_is_the_smallest_force():
    law = spheres(0.7)
    force = law.force_at_contact_radius(np.linspace(0.02, 1.5, 400) * 1e-8 * 10)
    assert -force.min() == approx(law.pull_off_force, rel=1e-3)
    assert (-force <= law.pull_off_force * (1 + 1e-9)).all()


def test_carpicks_fit():
    # Carpick, Ogletree and Salmeron (1999), J. Colloid Interface Sci. 211, 395: within 2 %
    for parameter in (0.1, 0.5, 1.0, 3.0):
        law = spheres(parameter / 1.157)
        x = 4.04 * float(law.transition_parameter) ** 1.4
        fit = (7 - (x - 1) / (x + 1)) / 4
        assert over_jkr(law) * 1.5 == approx(fit, rel=0.02)


@pytest.mark.parametrize(
    ("traction", "within"), [("dugdale_traction", 0.015), ("largest_traction", 0.06)]
)
def test_the_lennard_jones_reference(traction, within):
    with open(REFERENCE) as file:
        rows = list(csv.DictReader(file))
    assert len(rows) >= 10
    for row in rows:
        found = over_jkr(spheres(float(row["tabor_parameter"]), traction))
        assert found == approx(float(row["pull_off_over_jkr"]), rel=within)


def test_arrays_broadcast():
    tabor = np.array([0.5, 2.0])
    both = spheres(tabor).pull_off_force
    assert both == approx([spheres(each).pull_off_force for each in tabor])
