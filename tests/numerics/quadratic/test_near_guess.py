"""The solve near a guess agrees with the solve on all nodes, from a guess with the right means."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from restitution.contact.influence import (
    half_space,
    inverse_half_space,
    short_inverse_half_space,
)
from restitution.numerics.quadratic import near_guess
from restitution.numerics.quadratic.minimise import BoundedQuadratic, minimise_quadratic
from restitution.numerics.quadratic.near_guess import (
    add_short_waves,
    balanced_preconditioner,
    solve_near_guess,
)
from tolerance import approx


def system(shape, level):
    cells = 2.0**level, 2.0**level
    return half_space(shape, cells, 1.0), inverse_half_space(shape, cells, 1.0)


def near(shape, level):
    cells = 2.0**level, 2.0**level
    return half_space(shape, cells, 1.0), short_inverse_half_space(shape, cells, 1.0)


def plain(b):
    K, inverse = system(b.shape, 0)
    return minimise_quadratic(
        BoundedQuadratic(K, b, 0.0, np.inf),
        start=np.zeros_like(b),
        precondition=inverse,
        tolerance=1e-9,
        max_iterations=500,
    ).point


def bowl(shape, depth=1.0, rough=0.0, seed=0):
    """δ − h of a paraboloid with roughness at every node."""
    x, y = (np.linspace(-1, 1, n) for n in shape)
    b = depth * (1 - 1.2 * (x[:, None] ** 2 + y**2))
    return b + rough * np.random.default_rng(seed).standard_normal(shape)


@pytest.fixture
def solves(monkeypatch):
    """Shape, relative tolerance and limit of iterations of all solves, in order."""
    seen = []

    def watched(problem, **options):
        tolerance = options["tolerance"] / problem.b.max()
        seen.append((problem.b.shape, tolerance, options["max_iterations"]))
        return minimise_quadratic(problem, **options)

    monkeypatch.setattr(near_guess, "minimise_quadratic", watched)
    return seen


@pytest.mark.parametrize("rough", [0.0, 0.005, 0.03])
@pytest.mark.parametrize("shape", [(201, 180), (97, 330)])
def test_the_answer_is_that_of_all_nodes(shape, rough):
    b = bowl(shape, rough=rough)
    found, window, products = solve_near_guess(system, near, b, tolerance=1e-7, max_iterations=500)
    expected = plain(b)
    assert found.converged
    assert found.residual <= 1e-7
    assert products > 0
    p = np.zeros(shape)
    p[window] = found.point
    assert_allclose(p, expected, atol=2e-4 * expected.max())
    assert p.sum() == approx(expected.sum(), rel=1e-5)


def test_the_window_holds_what_the_guess_leaves_closed(solves):
    """A spike of one node far from the contact is solved, too, although nothing is checked."""
    b = bowl((200, 200), depth=0.2) - 0.1
    b[10, 15] = 0.15
    found, window, _ = solve_near_guess(system, near, b, tolerance=1e-7, max_iterations=500)
    assert found.converged
    first, second, last = (shape for shape, *_ in solves)
    assert first == (50, 50)
    assert second <= (100, 100)
    assert last == found.point.shape
    assert found.point.size < 0.7 * b.size
    expected = plain(b)
    assert expected[10, 15] > 0
    p = np.zeros_like(b)
    p[window] = found.point
    assert_allclose(p, expected, atol=1e-3 * expected.max())


def test_coarser_grids_have_wider_cells_and_larger_tolerances(solves):
    asked, kinds = [], []

    def watched(of):
        def operators(shape, level):
            asked.append((shape, level))
            kinds.append(of)
            return of(shape, level)

        return operators

    b = bowl((330, 320))
    solve_near_guess(watched(system), watched(near), b, tolerance=1e-6, max_iterations=500)
    assert [level for _, level in asked] == [3, 2, 1, 0]
    assert kinds == [system, near, near, near]  # all waves only without a guess
    assert asked[0][0] == (42, 40)
    for (shape, level), whole in zip(
        asked, [(42, 40), (83, 80), (165, 160), (330, 320)], strict=True
    ):
        assert all(0.4 * n < m <= n for m, n in zip(shape, whole, strict=True)), level
    assert [one[1] for one in solves[:3]] == approx([1e-3] * 3, rel=2e-3)
    assert [one[2] for one in solves] == [60] * 3 + [500]


def test_short_waves_release_nodes_and_keep_the_mean():
    """Half of the contact nodes of a rough bowl are hollows, which a smooth guess presses too."""
    b = bowl((256, 256), rough=0.01)
    K, inverse = system(b.shape, 0)
    smooth = plain(bowl((256, 256)))
    answer = plain(b)
    assert np.count_nonzero(smooth) > 1.5 * np.count_nonzero(answer)
    start = add_short_waves(smooth, K(smooth), inverse, b)
    assert start.min() == 0
    assert start.sum() == approx(smooth.sum(), rel=0.01)
    assert np.count_nonzero(start) == approx(np.count_nonzero(answer), rel=0.1)
    assert np.abs(start - answer).sum() < 0.3 * np.abs(smooth - answer).sum()


def test_short_waves_on_patches_hardly_change_their_means():
    """The inverse alone turns a residual of mean zero on each patch into a mean."""
    patches = np.arange(256) // 8 % 2 == 1
    p = 1.0 * np.outer(patches, patches)
    K, inverse = system(p.shape, 0)
    balanced = balanced_preconditioner(inverse, p, K(p))
    assert balanced is not inverse
    first = np.arange(256) % 8 == 0  # the first column of nodes of each patch
    waves = (p * (first - 1 / 8)).astype(np.float32)
    assert waves.sum() == approx(0.0, abs=1e-3)
    means = [float(of(waves)[p > 0].sum()) for of in (balanced, inverse)]
    assert abs(means[0]) < 0.5 * abs(means[1])
    assert not balanced(waves)[p == 0].any()


def test_one_patch_needs_no_damping():
    p = np.zeros((128, 128))
    p[20:100, 20:100] = 1.0
    K, inverse = system(p.shape, 0)
    assert balanced_preconditioner(inverse, p, K(p)) is inverse


def placed(b, tolerance):
    """Result on all nodes."""
    found, window, _ = solve_near_guess(system, near, b, tolerance=tolerance, max_iterations=500)
    p = np.zeros_like(b)
    p[window] = found.point
    return found, p


@pytest.mark.parametrize("rough", [0.0, 0.01])
def test_a_large_tolerance_takes_single_precision_and_is_as_accurate(rough, monkeypatch):
    b = bowl((180, 201), rough=rough)
    expected = plain(b)
    errors = []
    for smallest, dtype in ((1e-5, np.float32), (np.inf, np.float64)):
        monkeypatch.setattr(near_guess, "_SINGLE", smallest)
        found, p = placed(b, 1e-4)
        assert found.point.dtype == dtype
        errors.append(np.abs(p - expected).sum() / expected.sum())
        assert p.sum() == approx(expected.sum(), rel=5e-4)
    assert errors[0] < 0.02
    assert errors[0] == approx(errors[1], rel=0.2)


def test_a_tolerance_beyond_single_precision_takes_double_precision():
    found, _ = placed(bowl((150, 150)), 1e-7)
    assert found.point.dtype == np.float64
    assert found.converged


@pytest.mark.parametrize("scale", [1e-15, 1e6])
def test_the_unit_of_length_does_not_matter(scale):
    """Squares of residuals in single precision would vanish."""
    b = bowl((180, 201), rough=0.01)
    (one, p), (other, q) = placed(b, 1e-4), placed(scale * b, 1e-4 * scale)
    assert one.iterations == other.iterations
    assert_allclose(q / scale, p, atol=1e-3 * p.max())


@pytest.mark.parametrize("rough", [0.01, 0.03])
def test_the_last_step_halves_the_error(rough, monkeypatch):
    b = bowl((256, 256), rough=rough)
    expected = plain(b)
    errors = []
    for length in (near_guess._LAST_STEP, 0.0):
        monkeypatch.setattr(near_guess, "_LAST_STEP", length)
        errors.append(np.abs(placed(b, 3e-4)[1] - expected).sum())
    assert errors[0] < 0.7 * errors[1]


@pytest.mark.parametrize("turned", [lambda a: a[::-1], lambda a: a[:, ::-1], lambda a: a.T])
def test_turning_the_surface_turns_the_result(turned):
    b = bowl((192, 192), rough=0.01)
    (_, p), (_, q) = placed(b, 1e-4), placed(turned(b).copy(), 1e-4)
    assert np.abs(q - turned(p)).sum() < 0.01 * p.sum()
    assert q.sum() == approx(p.sum(), rel=2e-4)
