"""Splitting waves at a wavelength."""

import math

import numpy as np
import pytest

import restitution as rs
from restitution.errors import SurfaceError
from restitution.surfaces.generate import spectrum_of_kind
from restitution.surfaces.split import Bands, cut, split
from tolerance import approx

GRID = rs.Grid((128, 128), (0.1e-6, 0.1e-6))
WAVES = {"hurst": 0.8, "rolloff": 6e-6, "shortest": 0.4e-6}


@pytest.fixture(scope="module")
def surface():
    return rs.generate_surface(GRID, kind="self-affine", rms=20e-9, seed=1, **WAVES)


def test_long_and_short_waves_are_the_surface(surface):
    long, patches = split(surface, 1.2e-6, 32)
    assert len(patches) == 4
    short = surface.height - long.height
    assert 0 < np.std(short) < np.std(long.height)
    assert np.mean([p.height.var() for p in patches]) == approx(np.var(short), rel=0.2)


def test_patches_have_no_jumps_at_their_edges(surface):
    _, patches = split(surface, 1.2e-6, 32)
    for patch in patches:
        inside = np.abs(np.diff(patch.height, axis=0)).max()
        across = np.abs(patch.height[0] - patch.height[-1]).max()
        assert across < 1.5 * inside
        assert patch.height.mean() == approx(0, abs=1e-20)


def test_a_periodic_surface_stays_as_it_is(surface):
    (whole,) = cut(surface.height, GRID.spacing, 128, 1)
    jump = np.abs(surface.height[0] - surface.height[-1]).max()
    np.testing.assert_allclose(whole.height, surface.height, atol=0.5 * jump)


@pytest.mark.parametrize(
    ("wavelength", "nodes", "named"),
    [(0.15e-6, 32, "wavelength"), (4e-6, 32, "wavelength"), (1.2e-6, 256, "nodes")],
)
def test_impossible_splits(surface, wavelength, nodes, named):
    with pytest.raises(SurfaceError, match=named):
        split(surface, wavelength, nodes)


@pytest.mark.parametrize(
    ("kind", "waves"),
    [
        ("self-affine", {"hurst": 0.7, "rolloff": 3e-6}),
        ("exponential", {"correlation_length": 1e-6}),
        ("exponential", {"correlation_length": (2e-6, 1e-6), "lay": 0.3}),
    ],
)
def test_bands_have_the_waves_of_the_whole_surface(kind, waves):
    """Long waves on a coarse grid and short waves on a window, beside one fine surface."""
    fine = rs.Grid((512, 512), (0.05e-6, 0.05e-6))
    coarse = rs.Grid((64, 64), (0.4e-6, 0.4e-6))
    shortest = 0.2e-6
    made = rs.generate_surface(fine, kind=kind, rms=1e-8, seed=2, shortest=shortest, **waves)
    bands = Bands(spectrum_of_kind(kind, waves), coarse, shortest)
    modes = np.abs(np.fft.fft2(made.height)) ** 2
    f = np.fft.fftfreq(512, 0.05e-6)
    q = np.hypot(f[:, None], f[None, :])
    on_grid = modes[q <= 1 / 0.8e-6 * (1 + 1e-9)].sum() / modes.sum()
    assert bands.share() == approx(math.sqrt(on_grid), rel=0.02)
    window = rs.Grid((256, 256), (0.05e-6, 0.05e-6))
    short = bands.short_waves(window, 1.6e-6, 1e-8, seed=5)
    beyond = (np.abs(f[:, None]) > 1 / 1.6e-6) | (np.abs(f[None, :]) > 1 / 1.6e-6)
    expected = 1e-8 * math.sqrt(modes[beyond].sum() / modes.sum())
    assert short.std() == approx(expected, rel=0.06)
