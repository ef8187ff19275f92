"""The springs of the tangential law against Hertz, Cattaneo and Mindlin."""

import math
from dataclasses import replace

import numpy as np
import pytest

from elastic_force import ALUMINA, elastic
from restitution import Pair
from restitution.impacts.foundation import Foundation, has_yielded
from restitution.theory import Hertz
from tolerance import approx

MU = 0.3


@pytest.fixture(scope="module")
def pressed(wall):
    """The foundation, and its springs' loads, at a normal force held constant."""
    springs = Foundation.of(wall, wall.deepest)
    return springs, springs.load(wall.deepest, wall.deepest)


def dragged(pressed, path, friction=MU):
    """Forces, and the displacements of the springs, along a path of tangential displacements."""
    springs, loads = pressed
    u, before, forces, loss = np.zeros(loads.size), 0.0, [], 0.0
    for place in path:
        u, force, work = springs.move(u, place - before, friction * loads)
        before, loss = place, loss + work
        forces.append(force)
    return np.array(forces), u, loss


def largest_displacement(wall, force):
    """The tangential displacement (m) at which Cattaneo and Mindlin's contact slides."""
    a = math.sqrt(wall.pair.radius * wall.deepest)
    return 3 * MU * force / (4 * wall.pair.tangential_modulus * a)


def test_the_springs_carry_the_normal_force(wall):
    springs = Foundation.of(wall, wall.deepest)
    hertz = Hertz(wall.pair.radius, wall.pair.contact_modulus)
    for depth in wall.deepest * np.array([0.2, 0.5, 1.0]):
        assert springs.load(depth, wall.deepest).sum() == approx(
            float(hertz.force(depth)), rel=2e-3
        )
        assert springs.load(depth, depth).sum() == approx(float(hertz.force(depth)), rel=5e-3)


def test_partial_slip_is_that_of_cattaneo_and_mindlin(wall, pressed):
    force = pressed[1].sum()
    share = np.linspace(0.05, 1, 20)
    forces, _, _ = dragged(pressed, share * largest_displacement(wall, force))
    assert forces / (MU * force) == approx(1 - (1 - share) ** 1.5, rel=1e-3)


@pytest.mark.parametrize("part", [0.2, 0.5, 0.9])
def test_the_slip_annulus_is_that_of_cattaneo_and_mindlin(wall, pressed, part):
    springs, loads = pressed
    force = loads.sum()
    place = largest_displacement(wall, force) * (1 - (1 - part) ** (2 / 3))
    (found,), u, _ = dragged(pressed, [place])
    assert found == approx(part * MU * force, rel=1e-3)
    stuck = springs.radius[np.isclose(u, place, rtol=1e-9)].max() + springs.width / 2
    a = math.sqrt(wall.pair.radius * wall.deepest)
    assert stuck / a == approx((1 - part) ** (1 / 3), rel=1e-2)


def test_the_loop_loses_the_energy_of_mindlin_and_deresiewicz(wall, pressed):
    """One cycle between ±T at constant normal force: the area between the two branches, which are
    Cattaneo and Mindlin's curve twice as large (Mindlin and Deresiewicz 1953)."""
    force, part = pressed[1].sum(), 0.6
    far = largest_displacement(wall, force) * (1 - (1 - part) ** (2 / 3))
    path = far * np.concatenate(
        [np.linspace(0, 1, 400), np.linspace(1, -1, 800), np.linspace(-1, 1, 800)]
    )
    springs, _ = pressed
    _, _, first = dragged(pressed, path[:400])
    _, _, whole = dragged(pressed, path)
    a, G = math.sqrt(wall.pair.radius * wall.deepest), springs.moduli[1]
    loss = (18 * (MU * force) ** 2 / (5 * a * G)) * (
        1 - (1 - part) ** (5 / 3) - 5 * part / 6 * (1 + (1 - part) ** (2 / 3))
    )
    assert whole - first == approx(loss, rel=1e-2)


def test_below_the_first_depth_of_loading_the_loads_grow_in_proportion(wall):
    springs = Foundation.of(wall, wall.deepest)
    first = springs.depths[0]
    assert springs.depths.size == 200
    assert springs.depths[-1] == wall.deepest
    assert springs.load(first, first) == approx(springs.loads[0] * springs.width)
    assert springs.load(0.5 * first, 0.5 * first) == approx(0.5 * springs.loads[0] * springs.width)
    between = springs.load(1.25 * springs.depths[9], 1.25 * springs.depths[9])
    share = 12.5 - 12
    assert between == approx(
        ((1 - share) * springs.loads[11] + share * springs.loads[12]) * springs.width
    )


def test_after_yield_the_springs_within_the_contact_carry_its_whole_force(wall):
    """At every depth of loading, those beyond its contact radius carry nothing."""
    yielded = replace(wall, separation=lambda x: 0.3 * x)
    springs = Foundation.of(yielded, wall.deepest)
    reach = []
    for depth, loads in zip(springs.depths[19::20], springs.loads[19::20], strict=True):
        reach.append(np.count_nonzero(loads > 0))
        assert not loads[reach[-1] :].any()
        assert loads.sum() * springs.width == approx(wall.loading(depth), rel=0.02)
    assert reach[-1] == loads.size
    assert (np.diff(reach) > 0).all()


def test_a_contact_has_yielded_if_it_separates_a_thousandth_of_its_depth_above_touch():
    law = elastic(Pair(ALUMINA, ALUMINA), 1.0)
    for share, expected in ((0.9e-3, False), (1.1e-3, True)):
        changed = replace(law, separation=lambda x, share=share: share * x)
        assert has_yielded(changed, law.deepest) is expected
