"""The minimiser with rounded products: effects on the gradient and on the result."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from tolerance import approx

seeds = st.integers(0, 2**32 - 1)


def rounded(A, applied):
    """Operator of the matrix A in single precision."""
    single = A.astype(np.float32)

    def apply(p, out=None):
        applied.append(p[:, 0].copy())
        product = single @ p.astype(np.float32)
        return product.astype(p.dtype) if out is None else np.positive(product, out=out)

    return apply


@pytest.mark.parametrize("far", [1e-5, 1.0])
def test_from_nearby_two_gradients_are_computed_exactly_the_first_and_the_last(
    minimise, random_matrix, random_bounds, far
):
    """Rounding errors of small steps are small, so no further gradient is needed."""
    rng = np.random.default_rng(2)
    A, b = random_matrix(rng, 20), 3 * rng.normal(size=20)
    bounds = random_bounds(rng, 20)
    answer = minimise(A, b, *bounds)[0].point
    start = np.clip(answer + far * rng.normal(size=20), *bounds)
    options = {"start": start.copy(), "K_single": rounded(A, []), "tolerance": 1e-9}
    found, exact = minimise(A, b, *bounds, **options)
    assert found.converged
    assert_array_equal(exact[0], start)
    assert_array_equal(exact[-1], found.point)
    assert len(exact) == 2 if far < 1 else len(exact) > 2


@settings(deadline=None, max_examples=30)
@given(st.integers(5, 40), st.sampled_from([1e-3, 1e-5, 1e-7, 1e-9]), seeds)
def test_what_rounding_does_to_the_gradient_is_part_of_a_rough_residual(
    minimise, random_matrix, random_bounds, kkt_violation, n, tolerance, seed
):
    """The gradient may have to be recomputed several times to achieve this."""
    rng = np.random.default_rng(seed)
    A, b = random_matrix(rng, n), 3 * rng.normal(size=n)
    bounds = random_bounds(rng, n)
    found, exact = minimise(
        A, b, *bounds, K_single=rounded(A, []), accept_estimated_gradient=True, tolerance=tolerance
    )
    assert found.converged
    assert found.residual <= tolerance
    assert kkt_violation(A, b, found.point, *bounds) <= (1 + 1e-6) * found.residual
    assert len(exact) > 0 or tolerance > 1e-6
    found, exact = minimise(A, b, *bounds, K_single=rounded(A, []), tolerance=tolerance)
    assert_array_equal(exact[-1], found.point)
    assert found.residual <= tolerance
    assert found.residual == approx(kkt_violation(A, b, found.point, *bounds), rel=1e-6, abs=1e-14)


@pytest.mark.parametrize("rough", [False, True])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_product_that_is_not_finite_ends_the_solve_at_once(
    minimise, random_matrix, random_bounds, bad, rough
):
    """Single precision can overflow."""
    rng = np.random.default_rng(19)
    A, b = random_matrix(rng, 20), 3 * rng.normal(size=20)
    products = []

    def overflows(p, out=None):
        found = rounded(A, products)(p, out)
        found[7] = bad if len(products) == 4 else found[7]
        return found

    found, exact = minimise(
        A, b, *random_bounds(rng, 20), K_single=overflows, accept_estimated_gradient=rough
    )
    assert not found.converged
    assert np.isfinite(found.point).all()
    assert len(products) == 4
    assert len(exact) <= (1 if rough else 2)  # the last gradient and perhaps the first


@pytest.mark.parametrize("known", [False, True])
def test_a_start_where_rounding_overflows_is_taken_up_exactly(
    minimise, random_matrix, random_bounds, known
):
    rng = np.random.default_rng(23)
    A, b = random_matrix(rng, 20), 3 * rng.normal(size=20)
    bounds, products = random_bounds(rng, 20), []

    def overflows(p, out=None):
        found = rounded(A, products)(p, out)
        found *= np.nan if len(products) == 1 else 1.0
        return found

    start = np.clip(rng.normal(size=20), *bounds)
    product = overflows(start[:, None]) if known else None
    options = {
        "start": start,
        "K_single": overflows,
        "K_start": product,
        "accept_estimated_gradient": not known,
    }
    found, _ = minimise(A, b, *bounds, **options)
    assert found.converged
    assert_allclose(found.point, minimise(A, b, *bounds)[0].point, atol=1e-9)
