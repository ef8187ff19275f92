import math

import numpy as np
import pytest
from scipy.stats import kstest

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import generate_surface
from tolerance import approx

GRID = Grid((48, 64), (0.25e-6, 0.2e-6))


def generate(grid=GRID, **changes):
    arguments = {"kind": "exponential", "rms": 0.2e-6, "correlation_length": 2e-6, "seed": 7}
    return generate_surface(grid, **{**arguments, **changes})


@pytest.mark.parametrize("kind", ["exponential", "gaussian"])
@pytest.mark.parametrize("beta", [(6.0, 6.0), (9.0, 4.0)])
def test_mean_autocorrelation_follows_the_target(kind, beta):
    grid = Grid((512, 512), (1.0, 1.0))
    acf = np.zeros(grid.nodes)
    for seed in range(20):
        z = generate(grid, kind=kind, rms=2.0, correlation_length=beta, seed=seed).height
        acf += np.fft.ifft2(np.abs(np.fft.fft2(z)) ** 2).real / z.size / 20
    acf /= 2.0**2
    along_x, along_y = acf[int(beta[0]), 0], acf[0, int(beta[1])]
    assert (along_x, along_y) == approx((0.1, 0.1), rel=0.05)
    for i, j in [(1, 0), (0, 2), (3, 2), (5, 1), (2, 5)]:
        rho = math.hypot(i / beta[0], j / beta[1])
        target = math.exp(-2.3 * (rho if kind == "exponential" else rho**2))
        assert acf[i, j] == approx(target, abs=0.01)


def test_rms_is_exact_and_mean_is_zero():
    for seed in range(5):
        z = generate(rms=0.37e-6, seed=seed).height
        assert math.sqrt(np.mean(z**2)) == approx(0.37e-6, rel=1e-14)
        assert abs(z.mean()) < 1e-14 * 0.37e-6


def test_heights_are_normally_distributed():
    # A correlation length of one spacing leaves the heights nearly independent.
    z = generate(Grid((128, 128), (1.0, 1.0)), rms=1.0, correlation_length=1.0).height
    assert kstest(z.ravel(), "norm").pvalue > 0.01


def test_seed_decides_the_surface():
    np.testing.assert_array_equal(generate(seed=3).height, generate(seed=3).height)
    assert abs(np.corrcoef(generate(seed=3).height.flat, generate(seed=4).height.flat)[0, 1]) < 0.3


def test_rms_only_scales():
    np.testing.assert_allclose(generate(rms=0.4e-6).height, 2 * generate().height, rtol=1e-13)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("exponential", [1.1477037439006479, 0.5224008513720926, -0.16285778665251818]),
        ("gaussian", [1.0474065699341721, 0.8011214340802487, -0.07702057007799398]),
    ],
)
def test_same_heights_on_every_machine(kind, expected):
    """These heights must not change, because stored seeds would give other surfaces."""
    grid = Grid((8, 6), (1.0, 1.0))
    z = generate(grid, kind=kind, rms=1.0, correlation_length=(2.0, 3.0), seed=20190501).height
    assert [z[0, 0], z[3, 2], z[7, 5]] == approx(expected, abs=1e-12)


def test_opposite_edges_match():
    """Steps across the periodic edge are as small as elsewhere."""
    z = generate(kind="gaussian", correlation_length=(4e-6, 4e-6)).height
    inner = np.sqrt(np.mean(np.diff(z, axis=0) ** 2))
    edge = np.sqrt(np.mean((z[0] - z[-1]) ** 2))
    assert edge < 2 * inner


def test_provenance_is_plain_and_complete():
    surface = generate(correlation_length=(2e-6, np.float64(3e-6)), rms=np.float64(1e-7))
    provenance = surface.provenance
    assert surface.grid == GRID
    assert {type(value) for value in provenance.values()} <= {str, float, int}
    assert provenance["kind"] == "exponential"
    assert provenance["rms_m"] == 1e-7
    assert provenance["correlation_length_x_m"] == 2e-6
    assert provenance["correlation_length_y_m"] == 3e-6
    assert provenance["seed"] == 7
    assert provenance["method"] == "Hu and Tonder 1992"
    assert "periodic" in provenance["periodicity"]


@pytest.mark.parametrize(
    ("changes", "key", "number"),
    [
        ({"rms": 0.0}, "rms", "0 m"),
        ({"rms": -1e-7}, "rms", "-1e-07"),
        ({"rms": math.nan}, "rms", "nan"),
        ({"rms": math.inf}, "rms", "inf"),
        ({"correlation_length": 0.0}, "correlation_length", "0 m"),
        ({"correlation_length": (2e-6, math.nan)}, "correlation_length", "nan m along y"),
        ({"correlation_length": (2e-6, -1e-6)}, "correlation_length", "along y"),
        # The spacing is 0.25 um along x and 0.2 um along y, the domain 12 um and 12.8 um.
        ({"correlation_length": 0.24e-6}, "correlation_length", "0.24 um along x"),
        ({"correlation_length": (2e-6, 0.19e-6)}, "correlation_length", "0.2 um"),
        ({"correlation_length": 6.1e-6}, "correlation_length", "12 um"),
        ({"correlation_length": (2e-6, 6.5e-6)}, "correlation_length", "12.8 um"),
        ({"kind": "fractal"}, "kind", "'fractal'"),
        ({"seed": -1}, "seed", "-1"),
    ],
)
def test_impossible_surfaces_are_refused(changes, key, number):
    with pytest.raises(SurfaceError) as caught:
        generate(**changes)
    message = str(caught.value)
    assert message.startswith(f"{key}: ")
    assert number in message
    assert "; " in message
    assert "\n" not in message


def test_limits_of_the_correlation_length_are_allowed():
    generate(correlation_length=(0.25e-6, 0.2e-6))
    generate(correlation_length=(6e-6, 6.4e-6))


@pytest.mark.parametrize("skewness", [0.0, -1.0])
def test_a_grid_without_a_wave_is_refused(skewness):
    one = Grid((1, 1), (1e-6, 1e-6))
    with pytest.raises(SurfaceError, match=r"^grid: 1 x 1 nodes cannot represent"):
        generate_surface(
            one, kind="self-affine", hurst=0.8, rms=1e-8, seed=1, skewness=skewness, kurtosis=6
        )
