"""The multilevel solve gives the result of the plain one, for any first guess and window."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from restitution.contact.influence import half_space, inverse_half_space
from restitution.numerics.convolution.operators import FreeConvolution
from restitution.numerics.quadratic import multilevel
from restitution.numerics.quadratic.grid_transfer import may_coarsen, prolong, restrict
from restitution.numerics.quadratic.minimise import BoundedQuadratic, minimise_quadratic
from restitution.numerics.quadratic.multilevel import (
    _USUAL_STIFFNESS,
    mean_damped_preconditioner,
    solve_multilevel,
)
from tolerance import approx

TOLERANCE = 1e-9


def system(shape, level):
    cells = 2.0**level, 2.0**level
    return half_space(shape, cells, 1.0), inverse_half_space(shape, cells, 1.0)


def plain(b, upper):
    K, inverse = system(b.shape, 0)
    return minimise_quadratic(
        BoundedQuadratic(K, b, 0.0, upper),
        start=np.zeros_like(b),
        precondition=inverse,
        tolerance=TOLERANCE,
        max_iterations=500,
    )


def nested(b, upper, **options):
    return solve_multilevel(
        system, b, upper, tolerance=TOLERANCE, **{"max_iterations": 500} | options
    )


def bowl(shape, depth=1.0, rough=0.0, seed=0):
    """δ − h of a wavy paraboloid whose contact covers about half of the grid."""
    x, y = (np.linspace(-1, 1, n) for n in shape)
    b = depth * (1 - 1.2 * (x[:, None] ** 2 + y**2))
    random = np.random.default_rng(seed)
    for _ in range(12):
        k, phase = random.uniform(-40, 40, 2), random.uniform(0, 2 * np.pi)
        b += rough * np.cos(k[0] * x[:, None] + k[1] * y + phase)
    return b


@pytest.mark.parametrize("upper", [np.inf, 0.02])
@pytest.mark.parametrize("rough", [0.0, 0.05, 0.3])
@pytest.mark.parametrize("shape", [(201, 180), (97, 330), (60, 60), (3, 50)])
def test_the_answer_is_that_of_the_plain_solve(shape, rough, upper):
    b = bowl(shape, rough=rough, seed=len(shape))
    found, products = nested(b, upper)
    expected = plain(b, upper)
    assert found.converged
    assert found.residual <= TOLERANCE
    assert products > 0
    assert_allclose(found.point, expected.point, atol=1e-6 * expected.point.max())
    assert found.point.sum() == approx(expected.point.sum(), rel=1e-7)
    K, _ = system(shape, 0)
    assert_allclose(found.gradient, K(found.point) - b, atol=1e-12 * np.abs(b).max())


@pytest.fixture
def windows(monkeypatch):
    """Shapes of all solves, in order."""
    seen = []

    def watched(problem, **options):
        seen.append(problem.b.shape)
        return minimise_quadratic(problem, **options)

    monkeypatch.setattr(multilevel, "minimise_quadratic", watched)
    return seen


def bowl_and_spike():
    """A bowl and, far from it, a spike of one node that the means over 2 x 2 nodes hide."""
    b = bowl((200, 200), depth=0.2) - 0.1
    b[10, 15] = 0.15
    return b


def test_the_window_holds_what_the_guess_leaves_closed(windows):
    b = bowl_and_spike()
    found, _ = nested(b, np.inf)
    assert found.converged
    assert found.point[10, 15] > 0
    assert windows[:2] == [(50, 50), (100, 100)]
    assert len(windows) == 3
    assert_allclose(found.point, plain(b, np.inf).point, atol=1e-6 * found.point.max())


def test_a_window_takes_no_product_that_another_tells(windows, monkeypatch):
    """The product that finds the window gives the first gradient, the final check the last one."""
    products = []

    def watched(method):
        def product(self, p, out=None):
            products.append((p.shape, method.__name__))
            return method(self, p, out)

        return product

    for method in (FreeConvolution.__call__, FreeConvolution.single_precision):
        monkeypatch.setattr(FreeConvolution, method.__name__, watched(method))
    found, _ = nested(bowl((200, 200)), np.inf)
    assert found.converged
    assert len(windows) == 3
    finest = products[products.index(((200, 200), "single_precision")) :]
    assert finest[0] == ((200, 200), "single_precision")
    assert finest[-1] == ((200, 200), "__call__")
    assert {shape for shape, _ in finest[1:-1]} == {windows[-1]}
    assert [name for _, name in finest[1:-1]].count("__call__") == 1


def test_what_the_guess_does_not_see_widens_the_window(windows, monkeypatch):
    """The guess has too much pressure in the middle, which opens the gap at the spike."""
    b = bowl_and_spike()
    guess = np.zeros_like(b)
    guess[90:110, 90:110] = 10 * plain(b, np.inf).point.max()
    monkeypatch.setattr(multilevel, "_first_guess", lambda *_: guess)
    found, _ = nested(b, np.inf)
    assert found.converged
    assert found.point[10, 15] > 0
    assert windows[0] == (26, 26)
    assert len(windows) >= 2
    assert_allclose(found.point, plain(b, np.inf).point, atol=1e-6 * found.point.max())


def test_the_window_and_the_coarse_grids_save_products():
    """Sums over five surfaces, because the result of a single one varies too much."""
    ours = theirs = 0
    for seed in range(5):
        b = bowl((480, 480), rough=0.3, seed=seed)  # large enough to save time
        found, products = nested(b, np.inf)
        assert found.converged
        K, inverse = system(b.shape, 0)
        minimise_quadratic(
            BoundedQuadratic(K, b, 0.0, np.inf),
            start=np.zeros_like(b),
            precondition=inverse,
            tolerance=TOLERANCE,
            max_iterations=500,
        )
        ours += products
        theirs += K.count
    assert ours < 0.9 * theirs


def islands(n, width):
    """Pressure p on squares of `width` nodes, `width` apart; K p; and an approximate inverse."""
    one = np.arange(n) // width % 2 == 1
    p = 1.0 * np.outer(one, one)
    K, inverse = system((n, n), 0)
    return p, K(p), inverse


def test_a_constant_on_islands_is_too_stiff_and_less_so_with_less_of_the_mean():
    p, b, inverse = islands(256, 16)
    less = mean_damped_preconditioner(inverse, p, b, np.inf)
    constant = p.astype(np.float32)

    def stiffness(precondition):
        """Estimate of the Rayleigh quotient of the constant on the islands."""
        return np.vdot(precondition(constant), p) * b[p > 0].sum() / np.count_nonzero(p) ** 2

    plain = stiffness(inverse)
    assert plain > 8
    assert stiffness(less) == approx(_USUAL_STIFFNESS, rel=1e-5)
    # The local means of a checkerboard vanish, so nothing changes.
    board = (constant * (-1.0) ** np.add.outer(np.arange(256), np.arange(256))).astype(np.float32)
    assert_allclose(less(board), inverse(board), atol=1e-2 * inverse(board).max())


@pytest.mark.parametrize("case", ["one patch", "no guess", "most of it yields"])
def test_the_mean_stays_where_its_inverse_is_as_good_as_any(case):
    p, b, inverse = islands(256, 100)
    if case == "no guess":
        p = np.zeros_like(p)
    upper = np.inf
    if case == "most of it yields":
        p, b, inverse = islands(256, 16)
        yields = np.random.default_rng(7).random(p.shape) < 0.9
        p *= np.where(yields, 1.0, 0.5)
        upper = 1.0
    assert mean_damped_preconditioner(inverse, p, b, upper) is inverse


def guess(b, upper):
    return multilevel._first_guess(system, b, upper)


@pytest.mark.parametrize("rough", [0.0, 0.02])
def test_where_nearly_all_yields_the_guess_knows_the_edge(rough, monkeypatch):
    """Interpolation alone gives nodes beside the jump wrong, intermediate pressures."""
    b, upper = bowl((200, 220), rough=rough), 0.002
    answer = plain(b, upper).point
    free = (answer > 0) & (answer < upper)
    assert 0 < free.sum() < 0.05 * (answer > 0).sum()
    found = guess(b, upper)
    assert found.min() == 0
    assert found.max() == upper
    wrong = np.abs(found - answer).sum()
    monkeypatch.setattr(multilevel, "_MAX_FREE_FRACTION", -1.0)
    assert wrong < 0.6 * np.abs(guess(b, upper) - answer).sum()


def test_where_much_is_elastic_the_guess_is_what_pressure_is_between_nodes(monkeypatch):
    b = bowl((200, 220), rough=0.02)
    for upper in (np.inf, 0.25):
        found = guess(b, upper)
        with monkeypatch.context() as without:
            without.setattr(multilevel, "_MAX_FREE_FRACTION", -1.0)
            assert_array_equal(guess(b, upper), found)


def test_not_converging_is_reported():
    found, _ = nested(bowl((200, 200), rough=0.05), np.inf, max_iterations=3)
    assert not found.converged
    assert found.residual > TOLERANCE


@pytest.mark.parametrize("compiled", [True, False])
def test_a_guess_on_finer_cells_keeps_straight_lines(compiled):
    to_coarse, to_fine = (
        function if compiled else getattr(function, "__wrapped__", function)
        for function in (restrict, prolong)
    )
    coarse = np.add.outer(np.arange(9.0), 3 * np.arange(7.0))
    b = np.repeat(np.repeat(coarse, 2, axis=0), 2, axis=1)
    found = np.empty_like(coarse)
    to_coarse(b, found)
    assert_allclose(found, coarse)
    to_fine(coarse, b)
    expected = np.add.outer(np.arange(18) / 2 - 0.25, 3 * (np.arange(14) / 2 - 0.25))
    assert_allclose(b[1:-1, 1:-1], expected[1:-1, 1:-1], atol=1e-12)
    odd = np.zeros((3, 2))
    to_coarse(np.ones((5, 3)), odd)
    assert_allclose(odd, 1.0)


def test_coarser_grids_have_wider_cells_and_larger_tolerances(monkeypatch):
    asked, tolerances, limits = [], [], []

    def operators(shape, level):
        asked.append((shape, level))
        return system(shape, level)

    def watched(problem, **options):
        tolerances.append(options["tolerance"] / problem.b.max())
        limits.append(options["max_iterations"])
        return minimise_quadratic(problem, **options)

    monkeypatch.setattr(multilevel, "minimise_quadratic", watched)
    b = bowl((330, 320))
    solve_multilevel(operators, b, np.inf, tolerance=TOLERANCE, max_iterations=500)
    assert sorted({one for one in asked if one[1] > 0}, key=lambda one: one[1]) == [
        ((165, 160), 1),
        ((83, 80), 2),
        ((42, 40), 3),
    ]
    assert tolerances[:3] == approx([1e-2] * 3, rel=2e-3)  # means over nodes lower the peak
    assert limits == [60] * 3 + [500] * (len(limits) - 3)


@pytest.mark.parametrize(
    ("shape", "free", "periodic"),
    [
        ((80, 90), True, True),
        ((78, 90), False, False),
        ((81, 90), True, False),
        ((90, 81), True, False),
    ],
)
def test_a_periodic_grid_is_coarsened_only_if_both_edges_are_even(shape, free, periodic):
    assert may_coarsen(shape, periodic=False) == free
    assert may_coarsen(shape, periodic=True) == periodic


def test_the_first_guess_keeps_the_bound_of_each_node(monkeypatch):
    """The product of K and a guess outside the bounds would belong to another point."""
    starts = []

    def watched(problem, **options):
        if options.get("K_start") is not None:
            starts.append((problem, options["start"].copy(), options["K_start"].copy()))
        return minimise_quadratic(problem, **options)

    monkeypatch.setattr(multilevel, "minimise_quadratic", watched)
    b = bowl((201, 180))
    b -= 0.5 * b.max()  # so that the contact fits into a window
    upper = 3e-3 * np.random.default_rng(1).uniform(0.5, 4, b.shape)  # half of the contact yields
    found, _ = nested(b, upper)
    assert found.converged
    assert_allclose(found.point, plain(b, upper).point, atol=1e-6 * found.point.max())
    assert starts
    for problem, start, product in starts:
        assert (start <= problem.upper).all()
        K, _ = system(start.shape, 0)
        assert_allclose(product, K(start), atol=2e-6 * product.max())
