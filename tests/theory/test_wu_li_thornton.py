import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from restitution.errors import CaseError
from restitution.theory import johnson, yielding
from restitution.theory import wu_li_thornton as wlt

R, E_STAR, MASS = 250e-6, 112e9, 2e-6
S = 200.0  # E*/Y
Y = E_STAR / S
MATERIAL = (R, E_STAR, Y, MASS)
V_Y = yielding.yield_velocity(R, E_STAR, 1.6 * Y, MASS)
FINITE = wlt.THRESHOLD * S**2  # V/V_y


@pytest.mark.parametrize(("plastic", "c"), [("sphere", 0.78), ("half-space", 0.62)])
def test_the_formula_as_printed(plastic, c):
    v = np.array([1.001, 10.0, 1e3]) * FINITE
    e = wlt.restitution(v * V_Y, *MATERIAL, plastic)
    assert_allclose(e, c * (v / S) ** -0.5, rtol=1e-13)


def test_a_plastic_sphere_on_a_wall_is_the_default():
    V = 1e4 * V_Y
    assert wlt.restitution(V, *MATERIAL) == wlt.restitution(V, *MATERIAL, "sphere")


def test_the_formula_begins_at_finite_plastic_deformation():
    v = np.array([-1.0, 0.0, 0.5, 1.0 - 1e-9, 1.0 + 1e-9, 0.999 * FINITE, 1.001 * FINITE])
    e = wlt.restitution(v * V_Y, *MATERIAL)
    assert_array_equal(e[:4], 1)
    assert_array_equal(np.isnan(e[4:]), [True, True, False])


@pytest.mark.parametrize("s", [100.0, 300.0, 3000.0])
def test_the_threshold_is_one_deformation_where_it_meets_johnson(s):
    strength = E_STAR / s
    V = wlt.THRESHOLD * s**2 * yielding.yield_velocity(R, E_STAR, 1.6 * strength, MASS) * (1 + 1e-9)
    # fully plastic at 3Y: ½m*V² = 3πYa⁴/4R*
    a = (0.5 * MASS * V**2 * 4 * R / (3 * np.pi * strength)) ** 0.25
    assert a / R == pytest.approx(0.195, abs=0.001)
    material = R, E_STAR, strength, MASS
    ratio = wlt.restitution(V, *material) / johnson.restitution(V, *material)
    assert ratio == pytest.approx(1.13, abs=0.005)


@pytest.mark.parametrize(("plastic", "soft"), [("sphere", 76.0), ("half-space", 48.0)])
def test_there_is_no_answer_where_the_formula_exceeds_one(plastic, soft):
    for s, above in ((0.95 * soft, True), (1.05 * soft, False)):
        strength = E_STAR / s
        V_y = yielding.yield_velocity(R, E_STAR, 1.6 * strength, MASS)
        V = np.array([1.0001 * wlt.THRESHOLD * s**2, s]) * V_y
        e = wlt.restitution(V, R, E_STAR, strength, MASS, plastic)
        assert_array_equal(np.isnan(e), [above, False])
        assert e[1] < 1


def test_a_body_that_is_not_in_the_fit_is_refused():
    with pytest.raises(CaseError, match=r"^plastic: 'wall' is not .*; give one of sphere, half-sp"):
        wlt.restitution(1.0, *MATERIAL, "wall")
