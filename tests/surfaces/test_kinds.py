"""Generated surfaces beyond the digital filter: power laws, lay, skewness and kurtosis."""

import math
from itertools import pairwise

import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import describe, generate_surface
from tolerance import approx

GRID = Grid((256, 256), (0.25e-6, 0.25e-6))  # 64 um
KINDS = {
    "gaussian": {"correlation_length": 2e-6},
    "exponential": {"correlation_length": (6e-6, 2e-6), "lay": math.radians(30)},
    "self-affine": {"hurst": 0.8, "rolloff": 16e-6, "shortest": 1e-6},
}


def generate(grid=GRID, kind="gaussian", **changes):
    return generate_surface(grid, kind=kind, rms=1e-7, **{"seed": 3, **KINDS[kind], **changes})


def spectral_density(surface):
    """|q| (rad/m) and power of every mode."""
    (nx, ny), (hx, hy) = surface.grid.nodes, surface.grid.spacing
    q = 2 * math.pi * np.hypot(np.fft.fftfreq(nx, hx)[:, None], np.fft.fftfreq(ny, hy)[None, :])
    return q, np.abs(np.fft.fft2(surface.height)) ** 2


@pytest.mark.parametrize("hurst", [0.3, 0.8, 1.0])
@pytest.mark.parametrize("periodic", [True, False])
def test_the_spectrum_falls_as_the_hurst_exponent_says(hurst, periodic):
    slopes = []
    for seed in range(5):
        surface = generate(kind="self-affine", hurst=hurst, seed=seed, periodic=periodic)
        if not periodic:  # a window prevents leakage from the edges to short waves
            window = np.hanning(GRID.nodes[0])[:, None] * np.hanning(GRID.nodes[1])[None, :]
            surface = type(surface)(surface.height * window, GRID)
        q, power = spectral_density(surface)
        edges = np.geomspace(2.2 * 2 * math.pi / 16e-6, 0.9 * 2 * math.pi / 1e-6, 12)
        inside = [(low <= q) & (q < high) for low, high in pairwise(edges)]
        where = [np.exp(np.log(q[part]).mean()) for part in inside]
        slopes.append(np.polyfit(np.log(where), np.log([power[p].mean() for p in inside]), 1)[0])
    assert np.mean(slopes) == approx(-2 * (hurst + 1), abs=0.05)


def test_the_spectrum_is_flat_above_the_rolloff_and_empty_beyond_the_shortest():
    surface = generate(kind="self-affine")
    q, power = spectral_density(surface)
    plateau = [power[(q > low * 1e5) & (q <= (low + 1) * 1e5)].mean() for low in (1, 2)]
    assert plateau[0] == approx(plateau[1], rel=0.5)
    assert power[q > 2 * math.pi / 1e-6 * 1.001].max() < 1e-20 * power.max()
    for kind in ("gaussian", "exponential"):
        q, power = spectral_density(generate(kind=kind, shortest=2e-6))
        assert power[q > 2 * math.pi / 2e-6 * 1.001].max() < 1e-20 * power.max()


@pytest.mark.parametrize("angle", [0, 30, 90, 120])
def test_the_lay_is_where_it_is_said_to_be(angle):
    """The autocorrelation falls to 10 % at one length along the lay and at the other across it."""
    lay = math.radians(angle)
    acf = np.zeros(GRID.nodes)
    for seed in range(20):
        surface = generate(kind="gaussian", correlation_length=(6e-6, 2e-6), lay=lay, seed=seed)
        power = np.abs(np.fft.fft2(surface.height)) ** 2
        acf += np.fft.ifft2(power).real / (20 * surface.height.size * 1e-14)
    for beta, direction in ((6e-6, lay), (2e-6, lay + math.pi / 2)):
        i, j = (round(beta * f(direction) / 0.25e-6) for f in (math.cos, math.sin))
        along = 0.25e-6 * (i * math.cos(lay) + j * math.sin(lay))
        across = 0.25e-6 * (j * math.cos(lay) - i * math.sin(lay))
        expected = math.exp(-2.3 * ((along / 6e-6) ** 2 + (across / 2e-6) ** 2))
        assert acf[i, j] == approx(expected, abs=0.02)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("pair", "periodic"),
    [
        ((0.3, 3.3), True),
        ((1.0, 4.0), True),
        ((0.0, 2.0), True),
        ((-2.0, 10.0), True),
        ((0.3, 3.3), False),
        ((-1.0, 5.0), False),
    ],
)
def test_skewness_and_kurtosis_are_met(kind, periodic, pair):
    surface = generate(kind=kind, periodic=periodic, skewness=pair[0], kurtosis=pair[1])
    found, normal = describe(surface), describe(generate(kind=kind, periodic=periodic))
    assert found["Sq_m"] == approx(1e-7, rel=1e-12)
    assert found["Ssk"] == approx(pair[0], abs=0.03)
    assert found["Sku"] == approx(pair[1], rel=0.03)
    # The spectrum is that of the surface with normal heights.
    assert found["Sdq"] == approx(normal["Sdq"], rel=0.05 if periodic else 0.1)
    assert found["correlation_length_y_m"] == approx(normal["correlation_length_y_m"], rel=0.15)
    again = generate(kind=kind, periodic=periodic, skewness=pair[0], kurtosis=pair[1])
    assert again.height.tobytes() == surface.height.tobytes()


def test_mild_cases_are_filtered_and_strong_ones_adjusted():
    mild = generate(skewness=0.2, kurtosis=3.1).provenance
    assert "Johnson" in mild["method"]
    assert "amplitude_misfit" not in mild
    strong = generate(skewness=-2.0, kurtosis=10.0).provenance
    assert strong["method"].startswith("Schreiber")
    assert 0 < strong["amplitude_misfit"] < 0.02
    assert (strong["skewness"], strong["kurtosis"]) == (-2.0, 10.0)


@pytest.mark.parametrize("kind", KINDS)
def test_edges_match_only_where_the_surface_is_periodic(kind):
    def step(periodic):
        """Mean step across the edges over that between neighbours inside."""
        z = generate(kind=kind, periodic=periodic).height
        return np.sqrt(np.mean((z[0] - z[-1]) ** 2) / np.mean(np.diff(z, axis=0) ** 2))

    assert step(periodic=True) < 1.5
    assert step(periodic=False) > 2


@pytest.mark.parametrize(
    ("kind", "changes", "key", "said"),
    [
        ("gaussian", {"hurst": 0.8}, "hurst", "does not belong"),
        ("gaussian", {"rolloff": 1e-5}, "rolloff", "does not belong"),
        ("gaussian", {"correlation_length": None}, "correlation_length", "missing"),
        ("self-affine", {"correlation_length": 2e-6}, "correlation_length", "does not belong"),
        ("self-affine", {"lay": 0.1}, "lay", "does not belong"),
        ("self-affine", {"hurst": None}, "hurst", "missing"),
        ("self-affine", {"hurst": 0.0}, "hurst", "above 0 and at most 1"),
        ("self-affine", {"hurst": math.nan}, "hurst", "above 0 and at most 1"),
        ("self-affine", {"rolloff": -1.0}, "rolloff", "not a positive wavelength"),
        ("self-affine", {"rolloff": 0.5e-6}, "rolloff", "not between"),
        ("self-affine", {"rolloff": 1e-3}, "rolloff", "not between"),
        ("self-affine", {"shortest": 0.4e-6}, "shortest", "0.5 to 64 um"),
        ("gaussian", {"shortest": math.nan}, "shortest", "not a positive wavelength"),
        ("gaussian", {"lay": 0.5}, "lay", "give two"),
        ("gaussian", {"skewness": 2.0}, "kurtosis", "at least skewness"),
        ("gaussian", {"kurtosis": math.nan}, "kurtosis", "no surface can be made"),
        ("exponential", {"correlation_length": (4e-5, 2e-6)}, "correlation_length", "along"),
    ],
)
def test_what_cannot_be_is_refused(kind, changes, key, said):
    with pytest.raises(SurfaceError) as refusal:
        generate(kind=kind, **changes)
    assert str(refusal.value).startswith(f"{key}: ")
    assert said in str(refusal.value)


def test_a_keyword_that_no_kind_has_is_a_mistake_in_the_call():
    with pytest.raises(TypeError, match="unexpected keyword argument 'correlation_lenght'"):
        generate(correlation_lenght=2e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_a_keyword_that_is_none_counts_as_left_out(kind):
    names = {"correlation_length", "hurst", "rolloff", "shortest"}
    absent = dict.fromkeys(names - set(KINDS[kind]))
    lay = {"lay": 0.0} if kind != "exponential" else {}
    np.testing.assert_array_equal(
        generate(kind=kind, **absent, **lay).height, generate(kind=kind).height
    )
