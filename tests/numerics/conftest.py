"""Small problems with dense matrices, and the number of threads."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from restitution.numerics.quadratic.minimise import BoundedQuadratic, minimise_quadratic


@pytest.fixture(params=[1, 2, 3, 40])
def threads(request):
    """Set the number of threads, and restore it afterwards."""
    loops = pytest.importorskip("restitution.numerics.loops", reason="built without a compiler")
    before = loops.threads_for(10**9)
    loops.use_threads(request.param)
    yield request.param
    loops.use_threads(before)


@pytest.fixture(scope="session")
def minimise():
    """Minimise with a dense matrix A; return the result and the points to which A was applied.

    The minimiser takes two-dimensional arrays, so points are columns.
    """

    def found_and_applied(
        A, b, lower, upper, *, start=None, inverse=None, K_single=None, **options
    ):
        applied = []

        def apply(p, out=None):
            applied.append(p[:, 0].copy())
            return np.matmul(A, p, out=out)

        options = {"tolerance": 1e-10, "max_iterations": 500} | options
        found = minimise_quadratic(
            BoundedQuadratic(apply, b[:, None], lower[:, None], upper[:, None], K_single),
            start=np.zeros((b.size, 1)) if start is None else start[:, None],
            precondition=np.positive if inverse is None else partial(np.matmul, inverse),
            **options,
        )
        return replace(found, point=found.point[:, 0], gradient=found.gradient[:, 0]), applied

    return found_and_applied


@pytest.fixture(scope="session")
def random_matrix():
    """Symmetric positive definite matrix with a given condition number."""

    def made(rng, n, condition=10.0):
        Q = np.linalg.qr(rng.normal(size=(n, n)))[0]
        A = Q @ np.diag(condition ** rng.uniform(0, 1, n)) @ Q.T
        return 0.5 * (A + A.T)

    return made


@pytest.fixture(scope="session")
def random_bounds():
    """Bounds on both sides, on one side or on none; lower bounds may be negative."""

    def made(rng, n):
        kind = rng.integers(0, 4, n)
        lower = np.where(kind == 0, -np.inf, rng.uniform(-1, 0.2, n))
        upper = np.where(kind == 1, np.inf, rng.uniform(0.3, 1, n))
        return lower, upper

    return made


@pytest.fixture(scope="session")
def kkt_violation():
    """Violation of the optimality conditions, computed node by node."""

    def largest(A, b, p, lower, upper):
        worst = 0.0
        for g, at, low, up in zip(A @ p - b, p, lower, upper, strict=True):
            assert low <= at <= up
            may_fall, may_rise = at > low, at < up
            worst = max(worst, g if may_fall else 0.0, -g if may_rise else 0.0)
        return worst

    return largest
