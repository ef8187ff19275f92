"""Checks of the solver without other data: tangent, uniaxial hardening, Hertz. Run with pytest.

python -m pytest check_solve.py
"""

import numpy as np
import pytest
import solve
from indentation import Indentation
from problem import MeshSpec, Model, smooth_mesh
from works import loading_work, unloading_work


def _small(model):
    return Indentation(model, MeshSpec(1.0, 2.0, 2.0, 2.0, 2.0))


def _evaluate(body, u, ep, al):
    tensor, new_al, f = np.empty_like(ep), np.empty_like(al), np.empty(body.ndof)
    state = body.start()._replace(tensor=ep, equivalent_plastic_strain=al)
    body._evaluate(state, u, np.zeros(len(body.candidates)), tensor, new_al, f)
    return tensor, new_al, f


@pytest.mark.parametrize(
    "hardening", [{}, {"hardening_modulus": 20.0}, {"hardening_exponent": 0.2}]
)
def test_the_tangent_is_the_derivative_of_the_forces(hardening):
    """Compare the tangent with central differences, after and during yield."""
    body = _small(Model(210.0, 0.3, 1.0, **hardening))
    rng = np.random.default_rng(1)
    u = rng.normal(size=body.ndof) * 0.02
    ep, al = np.zeros((body.elements, 4, 4)), np.zeros((body.elements, 4))
    ep, al, _ = _evaluate(body, u, ep, al)
    u2, v = u + rng.normal(size=body.ndof) * 0.02, rng.normal(size=body.ndof)
    _, al2, _ = _evaluate(body, u2, ep, al)
    assert (al2 > al).all()
    product = body._product(v)
    h = 1e-6
    above, below = (_evaluate(body, u2 + sign * h * v, ep, al)[2] for sign in (1, -1))
    slope = (above - below) / (2 * h)
    np.testing.assert_allclose(product, slope, rtol=0, atol=2e-6 * abs(slope).max())


@pytest.mark.parametrize("hardening", [{"hardening_modulus": 20.0}, {"hardening_exponent": 0.2}])
def test_uniaxial_compression_of_a_bar_follows_the_flow_curve(hardening):
    """Compare stress, strain and lateral strain with the closed form."""
    model = Model(210.0, 0.3, 1.0, **hardening)
    body = _small(model)
    nr = nz = 3
    r = np.repeat(np.arange(3.0), nz)
    z = np.tile(np.arange(3.0), nr)
    strain, nu = -0.02, model.poissons_ratio
    u = np.zeros(body.ndof)
    u[1::2] = strain * z
    held = np.zeros(body.ndof, bool)
    held[1::2] = (z == 0) | (z == 2)
    held[0::2] = r == 0
    zero = np.zeros((body.elements, 4, 4)), np.zeros((body.elements, 4))
    for _ in range(30):
        _, al, f = _evaluate(body, u, *zero)
        K = np.zeros((body.ndof, body.ndof))
        K[body.rows, body.cols] = body.kdata
        K = np.triu(K) + np.triu(K, 1).T
        free = ~held
        u[free] -= np.linalg.solve(K[np.ix_(free, free)], f[free])
    stress = -f[1::2][z == 0].sum() / (np.pi * 2.0**2)
    flow = model.yield_strength + model.hardening_modulus * al[0, 0]
    if model.hardening_exponent:
        flow = (1 + model.youngs_modulus * al[0, 0]) ** model.hardening_exponent
    assert abs(stress) == pytest.approx(flow, rel=1e-8, abs=0.0)
    assert abs(strain) == pytest.approx(al[0, 0] + flow / model.youngs_modulus, rel=1e-8, abs=0.0)
    lateral = nu * flow / model.youngs_modulus + al[0, 0] / 2
    assert u[0::2][r == 2] == pytest.approx(2 * lateral, rel=1e-7, abs=0.0)


def test_elastic_contact_follows_hertz():
    """Compare force, area and returned work with Hertz."""
    model = Model(yield_strength=None)
    result = solve.run_range(model, smooth_mesh(model, 4, 40), (2, 4), 0.8, 0.8, fine=0.1)
    depth, force, area = (
        np.array(result["loading"][k]) for k in ("indentation_m", "force_N", "contact_area_m2")
    )
    hertz = 4 / 3 * model.contact_modulus * np.sqrt(model.radius) * depth**1.5
    np.testing.assert_allclose(force, hertz, rtol=3e-3)
    np.testing.assert_allclose(area[-4:], np.pi * model.radius * depth[-4:], rtol=0.03)
    work = loading_work(depth, force)
    for path in result["unloading"]:
        k = int(np.argmin(abs(np.array(result["omega"]) - path["omega"])))
        returned = unloading_work(path["indentation_m"], path["force_N"])
        assert returned == pytest.approx(work[k], rel=2e-3, abs=0.0)
