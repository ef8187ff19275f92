import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, describe, generate_surface, refine
from tolerance import approx


@pytest.mark.parametrize("nodes", [(8, 8), (7, 9), (12, 5)])
@pytest.mark.parametrize("factor", [2, 3, 4, 8])
def test_a_wave_is_continued_between_the_nodes(nodes, factor):
    grid = Grid(nodes, (0.5, 0.25))
    kx, ky = (2 * math.pi * k / size for k, size in zip((2, -1), grid.size, strict=True))

    def height(on):
        return np.cos(kx * on.x[:, None] + ky * on.y[None, :] + 0.3) + 0.7

    finer = refine(Surface(height(grid), grid, {"periodicity": "periodic"}), factor)
    assert finer.grid.size == approx(grid.size)
    assert_allclose(finer.height, height(finer.grid), atol=1e-13)
    assert finer.provenance["refined"] == factor


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("factor", [2, 4, 8])
def test_old_heights_are_kept_where_nodes_coincide(periodic, factor):
    grid = Grid((64, 48), (0.25e-6, 0.25e-6))
    surface = generate_surface(
        grid, kind="gaussian", rms=1e-7, correlation_length=2e-6, seed=1, periodic=periodic
    )
    finer = refine(surface, factor)
    assert_allclose(finer.height[::factor, ::factor], surface.height, atol=1e-20)
    assert_allclose(finer.grid.x[::factor], grid.x, atol=1e-18)
    for key in ("Sq_m", "Ssk", "Sku"):
        assert describe(finer)[key] == approx(describe(surface)[key], rel=0.05, abs=0.02)


def test_the_edges_of_a_surface_that_is_not_periodic_do_not_ring():
    grid = Grid((32, 32), (1.0, 1.0))
    ramp = Surface(0.01 * grid.x[:, None] + np.zeros((1, 32)), grid)
    finer = refine(ramp, 4)
    assert np.abs(finer.height - 0.01 * finer.grid.x[:, None]).max() < 0.01  # a cell
    assert finer.provenance["refinement"].endswith("mirrored")


def test_one_is_the_same_and_less_is_refused():
    surface = Surface(np.zeros((4, 4)), Grid((4, 4), (1.0, 1.0)))
    assert refine(surface, 1) is surface
    with pytest.raises(SurfaceError, match=r"^factor: 0 is not a positive integer"):
        refine(surface, 0)
