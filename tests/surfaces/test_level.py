import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, generate_surface, level
from tolerance import approx

GRID = Grid((21, 32), (0.5e-6, 0.25e-6))
X, Y = np.meshgrid(GRID.x, GRID.y, indexing="ij")
FORMS = {
    "center": [np.ones_like(X)],
    "tilt": [np.ones_like(X), X, Y],
    "curvature": [np.ones_like(X), X, Y, X**2, X * Y, Y**2],
}
ROUGH = generate_surface(
    GRID, kind="exponential", rms=0.1e-6, correlation_length=1e-6, seed=1
).height


@pytest.mark.parametrize("how", FORMS)
def test_agrees_with_a_least_squares_fit(how):
    basis = np.stack([form.ravel() / abs(form).max() for form in FORMS[how]], axis=1)
    coefficients = np.linalg.lstsq(basis, ROUGH.ravel(), rcond=None)[0]
    expected = ROUGH - (basis @ coefficients).reshape(ROUGH.shape)
    np.testing.assert_allclose(level(Surface(ROUGH, GRID), how).height, expected, atol=1e-20)


@pytest.mark.parametrize("how", FORMS)
@settings(deadline=None)
@given(weights=st.lists(st.floats(-1, 1), min_size=6, max_size=6))
def test_blind_to_what_it_subtracts(how, weights):
    form = sum(
        weight * 1e-6 * shape / abs(shape).max()
        for weight, shape in zip(weights, FORMS[how], strict=False)
    )
    levelled = level(Surface(ROUGH, GRID), how).height
    np.testing.assert_allclose(level(Surface(ROUGH + form, GRID), how).height, levelled, atol=1e-19)


@pytest.mark.parametrize("how", FORMS)
def test_idempotent(how):
    once = level(Surface(ROUGH, GRID), how)
    np.testing.assert_allclose(level(once, how).height, once.height, atol=1e-21)


def test_subtracts_no_more_than_asked():
    """A tilt survives centring, a bow survives levelling, a cubic survives everything."""
    for form, how in [(X, "center"), (X * Y, "tilt"), (Y**2, "tilt"), (X**3, "curvature")]:
        form = form / abs(form).max() * 1e-6
        assert level(Surface(form, GRID), how).height.std() > 0.1 * form.std()


@pytest.mark.parametrize("radius", [30e-6, -2e-3])
def test_the_radius_of_the_subtracted_paraboloid_is_stored(radius):
    form = -(X**2 + Y**2) / (2 * radius) + 0.03 * X
    levelled = level(Surface(form, GRID), "curvature")
    assert levelled.provenance["subtracted_radius_m"] == approx(radius, rel=1e-9)
    assert "subtracted_radius_m" not in level(Surface(form, GRID), "tilt").provenance
    two_columns = Grid((2, 32), GRID.spacing)
    narrow = level(Surface(form[:2], two_columns), "curvature")
    assert "subtracted_radius_m" not in narrow.provenance


def test_none_changes_no_height():
    surface = Surface(ROUGH, GRID, {"source": "test"})
    assert level(surface, "none").height is ROUGH


def test_provenance_lists_what_was_subtracted():
    surface = Surface(ROUGH, GRID, {"source": "test"})
    assert level(surface, "none").provenance == {"source": "test", "levelling": "none"}
    twice = level(level(level(surface, "none"), "tilt"), "center")
    assert twice.provenance == {"source": "test", "levelling": "tilt, center"}


@pytest.mark.parametrize("nodes", [(1, 1), (1, 5), (2, 2), (2, 7)])
@pytest.mark.parametrize("how", FORMS)
def test_few_pixels(nodes, how):
    height = np.random.default_rng(0).normal(size=nodes)
    levelled = level(Surface(height, Grid(nodes, (1.0, 1.0))), how).height
    assert levelled.mean() == approx(0, abs=1e-14)
    assert levelled.std() <= height.std() + 1e-14


def test_unknown_levelling_is_refused():
    with pytest.raises(SurfaceError, match=r"^how='cubic' is unknown; choose one of none"):
        level(Surface(ROUGH, GRID), "cubic")
