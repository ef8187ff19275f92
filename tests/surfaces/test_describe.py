import json
import math

import numpy as np
import pytest

from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, describe, generate_surface
from tolerance import approx

GRID = Grid((400, 300), (0.05e-6, 0.1e-6))
AMPLITUDE = 0.3e-6
K = 2 * math.pi / 2e-6  # 10 waves along x, 15 along y
X, Y = np.meshgrid(GRID.x, GRID.y, indexing="ij")


@pytest.mark.parametrize(("along", "tolerance"), [(X, 4e-3), (Y, 8e-3)])
def test_sine(along, tolerance):
    values = describe(Surface(AMPLITUDE * np.sin(K * along + 0.1) + 5e-6, GRID))
    assert values["Sq_m"] == approx(AMPLITUDE / math.sqrt(2), rel=1e-12)
    assert values["Sa_m"] == approx(AMPLITUDE * 2 / math.pi, rel=5e-3)
    assert values["Ssk"] == approx(0, abs=1e-10)
    assert values["Sku"] == approx(1.5, rel=1e-10)
    assert values["Sp_m"] == approx(AMPLITUDE, rel=2e-2)
    assert values["Sv_m"] == approx(AMPLITUDE, rel=2e-2)
    assert values["Sz_m"] == approx(2 * AMPLITUDE, rel=2e-2)
    assert values["Sdq"] == approx(AMPLITUDE * K / math.sqrt(2), rel=tolerance)
    assert values["rms_curvature_per_m"] == approx(
        0.5 * AMPLITUDE * K**2 / math.sqrt(2), rel=2 * tolerance
    )


def test_sine_correlation_length():
    values = describe(Surface(AMPLITUDE * np.sin(K * X), GRID))
    # The biased estimate, for whole waves on a domain of length L.
    tau, L = values["correlation_length_x_m"], GRID.size[0]
    R = math.cos(K * tau) * (1 - tau / L) + math.sin(K * tau) / (K * L)
    assert approx(0.1, abs=2e-3) == R
    # Lines along y are constant, and the biased estimate of a constant decreases as 1 − τ/L.
    assert values["correlation_length_y_m"] == approx(0.9 * GRID.size[1], rel=1e-9)


def test_plane():
    """A plane's heights are uniformly distributed along x, and its slope is exact."""
    values = describe(Surface(0.02 * X - 0.01 * Y, GRID))
    assert values["Sdq"] == approx(math.hypot(0.02, 0.01), rel=1e-10)
    assert values["rms_curvature_per_m"] == approx(0, abs=1e-3)
    uniform = describe(Surface(0.02 * X, GRID))
    assert uniform["Sku"] == approx(1.8, rel=1e-3)
    assert uniform["Sq_m"] == approx(0.02 * GRID.size[0] / math.sqrt(12), rel=1e-4)


def test_single_peak_and_pit():
    height = np.zeros((10, 10))
    height[4, 4] = 1.0
    values = describe(Surface(height, Grid((10, 10), (1.0, 1.0))))
    assert (values["Sp_m"], values["Sv_m"]) == approx((0.99, 0.01))
    # Skewness and kurtosis of Bernoulli numbers with p = 1/100.
    assert values["Ssk"] == approx((1 - 2 * 0.01) / math.sqrt(0.01 * 0.99))
    assert values["Sku"] == approx(3 + (1 - 6 * 0.01 * 0.99) / (0.01 * 0.99))
    upside_down = describe(Surface(-height, Grid((10, 10), (1.0, 1.0))))
    assert upside_down["Ssk"] == approx(-values["Ssk"])
    # Two of 90 pairs along either axis step by 1.
    assert values["Sdq"] == approx(math.sqrt(2 * 2 / 90))


def test_correlation_length_of_generated_surfaces():
    grid = Grid((512, 512), (0.1e-6, 0.1e-6))
    several = [
        describe(
            generate_surface(
                grid, kind="gaussian", rms=0.1e-6, correlation_length=(0.6e-6, 1.2e-6), seed=seed
            )
        )
        for seed in range(8)
    ]
    mean = {key: np.mean([values[key] for values in several]) for key in several[0]}
    assert mean["correlation_length_x_m"] == approx(0.6e-6, rel=0.05)
    assert mean["correlation_length_y_m"] == approx(1.2e-6, rel=0.05)
    assert mean["Ssk"] == approx(0, abs=0.03)
    assert mean["Sku"] == approx(3, abs=0.06)


def test_autocorrelation_is_the_direct_sum():
    height = np.random.default_rng(2).normal(size=(9, 4)).cumsum(axis=0)
    z = height - height.mean()
    R = [np.sum(z[: 9 - k] * z[k:]) / np.sum(z**2) for k in range(9)]
    k = next(k for k in range(9) if R[k] <= 0.1)
    lag = k - 1 + (R[k - 1] - 0.1) / (R[k - 1] - R[k])
    values = describe(Surface(height, Grid((9, 4), (0.5, 1.0))))
    assert values["correlation_length_x_m"] == approx(0.5 * lag, rel=1e-12)


@pytest.mark.parametrize("constant", [0.0, 0.1, -3e-7, 1e5])
def test_flat_surface(constant):
    values = describe(Surface(np.full((30, 7), constant), Grid((30, 7), (1.0, 1.0))))
    assert values["Sq_m"] == approx(0, abs=1e-15 * abs(constant) + 1e-300)
    for undefined in ("Ssk", "Sku", "correlation_length_x_m", "correlation_length_y_m"):
        assert values[undefined] is None


def test_values_are_plain_json():
    values = describe(Surface(np.random.default_rng(0).normal(size=(8, 8)), Grid((8, 8), (1, 1))))
    assert {type(value) for value in values.values()} == {float}
    assert json.loads(json.dumps(values, allow_nan=False)) == values


def test_units():
    """Lengths scale with the heights or the spacing; ratios do not change."""
    height = np.random.default_rng(1).normal(size=(16, 16))
    small = describe(Surface(1e-9 * height, Grid((16, 16), (1e-9, 1e-9))))
    large = describe(Surface(height, Grid((16, 16), (1.0, 1.0))))
    for key, value in large.items():
        scale = 1e9 if key.endswith("_per_m") else 1e-9 if key.endswith("_m") else 1.0
        assert small[key] == approx(scale * value, rel=1e-9), key


def test_one_line_of_cells():
    values = describe(Surface(np.array([[0.0, 1.0, 0.0]]), Grid((1, 3), (1.0, 1.0))))
    assert values["Sdq"] == approx(1.0)
    assert values["correlation_length_x_m"] is None
