"""The error of the tangential law: its parts, and the comparison with boundary elements."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from restitution import Body, Pair
from restitution.impacts.foundation import has_yielded
from restitution.impacts.stored_force import StoredForce, StoredRoughness
from restitution.impacts.tangential_error import dundurs, tangential_error
from tolerance import approx

STUDIES = Path(__file__).parents[2] / "evidence"
STEEL = Body(500e-6, 210e9, 0.25, 7850)


def stored(
    pair=None, *, patches=None, lay=0.0, separation=0.0, curves=(1e-9, 1e-8, 1e-7), depth=1e-7
):
    """A stored force whose values do not matter, with what the error depends on."""
    line = np.array([0.0, 1.0])
    rough = None
    if patches is not None:
        rough = StoredRoughness(np.array([depth / 10, depth]), np.array([1.0, patches]), lay)
    return StoredForce(
        pair or Pair(STEEL, STEEL),
        depth,
        1.0,
        lambda x: x,
        lambda x: separation * x,
        np.array(curves),
        tuple((one * line, line) for one in curves),
        rough,
    )


def error(friction=0.3, **given):
    law = stored(**given)
    return tangential_error(law, law.deepest, friction)


def test_smooth_elastic_bodies_of_one_material_have_a_numerical_error_only():
    assert error().stiffness == approx(0.005)
    assert error().impulse == 0


def test_dundurs_constant():
    rigid, steel, rubber = Body(1, 1e20, 0.3), Body(1, 210e9, 0.3), Body(1, 1e7, 0.5)
    assert dundurs(Pair(steel, steel)) == 0
    assert dundurs(Pair(rubber, rigid)) == approx(0, abs=1e-9)
    assert dundurs(Pair(steel, rigid)) == approx(0.5 * (1 - 0.6) / 0.7, rel=1e-6)
    alumina, glass = Body(2.5e-3, 380e9, 0.23), Body(math.inf, 70e9, 0.22)
    assert dundurs(Pair(alumina, glass)) == approx(-0.24903, rel=1e-4)
    assert dundurs(Pair(glass, alumina)) == approx(0.24903, rel=1e-4)


@pytest.mark.parametrize(
    ("friction", "expected"), [(0.1, 1.0), (0.2857, 1.0), (0.5, (0.285714 / 0.5) ** 2), (5, 0.0952)]
)
def test_unlike_bodies_have_an_error_that_falls_with_friction(friction, expected):
    pair = Pair(Body(500e-6, 210e9, 0.3, 7850), Body(math.inf, 1e20, 0.3))
    beta = 0.4 / 1.4
    found = error(friction, pair=pair).stiffness - 0.005
    assert found == approx(beta * expected, rel=1e-3)


def test_coupled_solutions_lie_within_the_error_for_unlike_bodies():
    ratios = [], []
    with open(STUDIES / "unlike" / "unlike.csv") as file:
        for row in csv.DictReader(file):
            beta, friction = float(row["beta"]), float(row["friction"])
            # A body on a rigid one: β = (1 − 2ν)/(2 − 2ν).
            nu = (0.5 - beta) / (1 - beta)
            pair = Pair(Body(500e-6, 210e9, nu, 7850), Body(math.inf, 1e22, 0.3))
            assert dundurs(pair) == approx(beta, rel=1e-6)
            stated = error(friction, pair=pair)
            stiffness = float(row["stiffness_change"]) / (stated.stiffness - 0.005)
            slides = float(row["impulse_alike"]) > 0.999
            impulse = abs(float(row["impulse"]) / float(row["impulse_alike"]) - 1) / stated.sliding
            ratios[slides].append(impulse if slides else stiffness)
    assert [len(found) for found in ratios] == [12, 4]
    assert 0.7 < max(ratios[0]) < 1
    assert 0.5 < max(ratios[1]) < 1


def test_the_error_of_rough_contacts_falls_with_the_number_of_patches():
    errors = [error(patches=patches).stiffness for patches in (1, 4, 16, 36, 1000)]
    chi = 0.25 / 1.75
    assert errors == approx(0.045 + 0.35 * chi * np.array([1, 1, 1 / 2, 1 / 3, 1 / 3]))
    assert error(patches=16, lay=0.8).stiffness == approx(0.045 + 0.8 * chi)


def test_without_poisson_effect_the_shape_of_patches_does_not_matter():
    pair = Pair(*(Body(500e-6, 210e9, 0.0, 7850),) * 2)
    assert error(pair=pair, patches=1, lay=1.0).stiffness == approx(0.045)


def test_yield_adds_to_the_error():
    smooth = error(separation=0.3)
    assert smooth.stiffness == approx(0.015)
    assert smooth.impulse == approx(0.1)
    assert not has_yielded(stored(separation=1e-6), 1e-7)
    assert error(separation=1e-6) == error()


@pytest.mark.parametrize(
    ("curves", "gap"),
    [
        ((5e-8, 1e-7), 2.5),  # from a fifth of the depth on
        ((2e-8, 1e-7), 5.0),
        ((1e-8, 1e-7), 10.0),
        ((1e-7,), 5.0),
        ((1e-8, 3e-8, 6e-8, 1e-7), 3.0),
        (tuple(1e-7 * 1.2 ** np.arange(-15.0, 1)), 1.2),
    ],
)
def test_few_unloading_curves_add_to_the_error_of_yielded_rough_contacts(curves, gap):
    base = error(patches=10).stiffness
    found = error(patches=10, separation=0.3, curves=curves)
    assert found.impulse == approx(min(0.1 * gap, 1.0))
    assert found.stiffness == approx(base + 0.01 * gap)


def test_the_differences_from_boundary_elements_lie_within_the_error():
    """The table of the study: stiffness, force, loop (three times) and e_t of all contacts."""
    with open(STUDIES / "tangential" / "tangential.csv") as file:
        rows = list(csv.DictReader(file))
    assert sum(row["blind"] == "True" for row in rows) >= 50
    ratios = {"stiffness": [], "force": [], "loop": [], "e_t": []}
    for row in rows:
        nu, depth, count = (float(row[key]) for key in ("poissons_ratio", "depth_nm", "curves"))
        depths = depth * 20 ** (np.arange(16) / 15 - 1)
        curves = depths[[15 - (k * 16) // int(count) for k in range(int(count))][::-1]]
        rough = row["kind"] != "smooth"
        law = stored(
            Pair(*(Body(500e-6, 210e9, nu, 7850),) * 2),
            patches=float(row["patches"]) if rough else None,
            lay=float(row["lay"]),
            separation=float(row["unrecovered"]),
            curves=curves,
            depth=depth,
        )
        stated = tangential_error(law, depth, 0.3)
        assert stated.stiffness == approx(float(row["stiffness_error"]), rel=1e-3)
        assert stated.impulse == approx(float(row["impulse_error"]), rel=1e-3)
        for name, factor in (("stiffness", 1), ("force", 1), ("loop", 3)):
            worst = max(
                abs(float(value))
                for key, value in row.items()
                if key.startswith((f"deepest_{name}", f"half_{name}"))
            )
            ratios[name].append(worst / (factor * stated.stiffness))
        ratios["e_t"] += [
            abs(float(row[f"e_t_difference_{angle}"])) / float(row[f"e_t_error_{angle}"])
            for angle in ("0.7", "1.5", "3.0")
        ]
    assert {name: max(found) < 1 for name, found in ratios.items()} == dict.fromkeys(ratios, True)
    assert max(map(max, ratios.values())) > 0.5
