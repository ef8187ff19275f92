import math

import numpy as np
import pytest

from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, describe, generate_surface
from restitution.surfaces.texture import autocorrelation, material_ratio, texture
from tolerance import approx

GRID = Grid((256, 192), (0.1e-6, 0.1e-6))


def rough(**more):
    kind = {"kind": "gaussian", "rms": 5e-8, "correlation_length": 1.5e-6, "seed": 2, **more}
    return generate_surface(GRID, **kind)


def test_the_autocorrelation_is_that_of_the_definition():
    surface = Surface(rough().height[:40, :30].copy(), Grid((40, 30), GRID.spacing))
    found = autocorrelation(surface)
    z = surface.height - surface.height.mean()
    for i, j in ((3, 0), (0, -4), (5, 7), (-6, 2)):
        a = z[max(i, 0) : 40 + min(i, 0), max(j, 0) : 30 + min(j, 0)]
        b = z[max(-i, 0) : 40 + min(-i, 0), max(-j, 0) : 30 + min(-j, 0)]
        assert found.values[20 + i, 15 + j] == approx((a * b).mean() / (z * z).mean())
        assert (found.x[20 + i], found.y[15 + j]) == approx((i * 1e-7, j * 1e-7))
    periodic = autocorrelation(rough())
    z = rough().height
    assert periodic.values[128 + 9, 96 - 4] == approx(
        (z * np.roll(z, (-9, 4), (0, 1))).mean() / (z * z).mean()
    )


def test_the_correlation_length_of_a_gaussian_surface():
    # R = exp(−2.3 (τ/β)²) falls to 0.2 at β sqrt(ln 5/2.3).
    lengths = [texture(rough(seed=seed))["Sal_m"] for seed in range(6)]
    expected = 1.5e-6 * math.sqrt(math.log(5) / 2.3)
    assert np.mean(lengths) == approx(expected, rel=0.1)
    assert np.mean([texture(rough(seed=s))["Str"] for s in range(6)]) > 0.7


def test_a_lay_is_found():
    surface = rough(correlation_length=(4e-6, 0.8e-6), lay=math.radians(35), seed=4)
    found = texture(surface)
    assert found["Str"] == approx(0.2, abs=0.08)
    assert found["lay_deg"] == approx(35, abs=8)


def test_the_core_of_normally_distributed_heights():
    # The flattest 40 % of the quantiles of a normal distribution are around its middle.
    found = texture(rough(correlation_length=0.4e-6))
    assert found["Sk_m"] == approx(2 * 0.5244 / 0.4 * 5e-8, rel=0.03)
    assert found["Spk_m"] == approx(found["Svk_m"], rel=0.15)
    assert found["Smr1"] == approx(1 - found["Smr2"], abs=0.02)


def test_the_core_of_known_steps():
    # Nine tenths of the heights are between 0 and 1, one tenth are linear peaks up to 3 above.
    n = 200
    heights = np.concatenate([np.linspace(0, 1, 9 * n * n // 10), np.linspace(1, 4, n * n // 10)])
    surface = Surface(heights.reshape(n, n), Grid((n, n), (1.0, 1.0)))
    found = texture(surface)
    assert found["Sk_m"] == approx(10 / 9, rel=0.01)
    assert found["Svk_m"] == approx(0, abs=0.01)
    assert found["Smr1"] == approx(0.1, abs=0.01)
    assert found["Spk_m"] == approx(3 - 1 / 9, rel=0.06)


def test_the_area_of_a_tilted_plane_is_exact():
    x, y = GRID.x[:, None], GRID.y[None, :]
    found = texture(Surface(0.5 * x - 0.2 * y, GRID))
    assert found["Sdr"] == approx(math.sqrt(1 + 0.25 + 0.04) - 1)
    gentle = rough()
    assert texture(gentle)["Sdr"] == approx(0.5 * describe(gentle)["Sdq"] ** 2, rel=0.05)


def test_the_material_ratio_falls_from_the_summit_to_the_pit():
    curve = material_ratio(rough())
    z = rough().height
    assert (curve.height[0], curve.height[-1]) == approx((z.max(), z.min()))
    assert np.all(np.diff(curve.height) <= 0)
    assert np.mean(z > curve.height[300]) == approx(curve.ratio[300], abs=1e-3)


@pytest.mark.parametrize("shape", [(1, 1), (1, 8), (8, 8)])
def test_flat_and_tiny_surfaces_have_no_texture(shape):
    found = texture(Surface(np.zeros(shape), Grid(shape, (1.0, 1.0))))
    assert found["Sal_m"] is None
    assert found["Str"] is None
    assert found["Sk_m"] == 0
    assert found["Sdr"] == 0
