"""Tilt, curvature and spikes of scans, and no false alarm on rough surfaces."""

import math

import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, generate_surface, read_surface, remove_outliers
from restitution.surfaces.defects import form_of, noted, spikes_of
from tolerance import approx

GRID = Grid((128, 96), (0.25e-6, 0.5e-6))
X, Y = GRID.x[:, None], GRID.y[None, :]
SPHERE = -(X**2 + Y**2) / 2
RADIUS = 500e-6


def rough(seed=1, rms=76e-9, grid=GRID, **more):
    kind = {"kind": "gaussian", "correlation_length": 3e-6, **more}
    return generate_surface(grid, rms=rms, seed=seed, **kind)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_sphere_is_found_with_its_radius(sign):
    form = form_of(Surface(sign * SPHERE / RADIUS, GRID))
    assert form.radius == approx(sign * RADIUS)
    assert form.curvature == approx(1)


def test_a_rough_tilted_sphere_has_both():
    form = form_of(Surface(rough().height + SPHERE / RADIUS + 0.05 * X + 0.02 * Y, GRID))
    assert form.radius == approx(RADIUS, rel=0.05)
    assert form.curvature > 0.8
    assert form.tilt > 0.5


@pytest.mark.parametrize("form", [X**2 + 0 * Y, X**2 - Y**2, X * Y, 0 * X * Y, X * np.sin(1e6 * Y)])
def test_other_forms_are_not_spheres(form):
    assert form_of(Surface(form / RADIUS, GRID)).curvature == 0


@pytest.mark.parametrize(
    "waves",
    [
        {"correlation_length": 16e-6},
        {"kind": "exponential", "correlation_length": 16e-6},
        *(
            {"kind": "self-affine", "hurst": hurst, "correlation_length": None}
            for hurst in (0.3, 0.8, 1.0)
        ),
    ],
)
def test_long_waves_of_cut_surfaces_are_not_a_sphere(waves):
    """Of 160 parts, a few may have a strong paraboloid, but hardly any is certain to be a form."""
    larger = Grid((256, 192), GRID.spacing)
    parts = [
        Surface(height[i : i + 128, j : j + 96], GRID)
        for seed in range(40)
        for height in [rough(seed, grid=larger, **waves).height]
        for i in (0, 128)
        for j in (0, 96)
    ]
    assert sum(form_of(part).curvature > 0.3 for part in parts) <= 1


def with_spikes(surface, height, count=20):
    spoiled = surface.height.copy()
    spoiled.ravel()[:: spoiled.size // count][:count] += height
    return Surface(spoiled, surface.grid)


def test_spikes_are_counted_and_their_threshold_removes_them():
    spoiled = with_spikes(rough(), 5e-6)
    spikes = spikes_of(spoiled)
    assert (spikes.count, spikes.threshold) == (20, 8)
    assert spikes.height == approx(5e-6, rel=0.1)
    cleaned = remove_outliers(spoiled, spikes.threshold)
    assert 20 <= cleaned.provenance["outliers"] <= 24  # neighbours of a spike may be replaced too
    assert spikes_of(cleaned).count == 0


def test_a_spike_at_a_corner_and_one_of_nine_pixels_count():
    height = rough().height.copy()
    height[0, 0] = 2e-6
    height[60:63, 40:43] = 2e-6
    assert spikes_of(Surface(height, GRID)).count == 2


def test_the_threshold_keeps_the_summits_of_a_smooth_surface():
    """Where 8 standard deviations would replace many summits, a larger number is recommended."""
    grid = Grid((128, 128), (0.5e-6, 0.5e-6))
    smooth = rough(grid=grid, correlation_length=10e-6, kurtosis=6)
    spoiled = with_spikes(smooth, 5e-6)
    spikes = spikes_of(spoiled)
    assert spikes.count == 20
    assert spikes.threshold > 8
    assert remove_outliers(spoiled, spikes.threshold).provenance["outliers"] == 20


def test_pits_count_only_if_they_make_the_surface_steep():
    assert spikes_of(with_spikes(rough(), -2e-6, 2)).count == 0
    assert spikes_of(with_spikes(rough(), -5e-6)).count == 20


@pytest.mark.parametrize("kind", ["gaussian", "exponential"])
@pytest.mark.parametrize("correlation", [1e-6, 3e-6, 10e-6])
@pytest.mark.parametrize(("skewness", "kurtosis"), [(0, 3), (1, 6), (-1, 6), (0, 10), (2, 12)])
def test_long_tails_are_not_spikes(kind, correlation, skewness, kurtosis):
    waves = {"kind": kind, "correlation_length": correlation}
    surface = rough(skewness=skewness, kurtosis=kurtosis, **waves)
    assert spikes_of(surface).count == 0
    assert spikes_of(Surface(surface.height + SPHERE / 50e-6, GRID)).count == 0


def test_edges_of_a_grating_are_not_spikes():
    grating = np.where(np.arange(128) % 16 < 8, 1e-6, 0.0)[:, None] + 0 * Y
    assert spikes_of(Surface(grating + rough(rms=1e-9).height, GRID)).count == 0


def test_real_scans(topographies):
    pytest.importorskip("SurfaceTopography")
    for name in ("di-3.di", "mi-1.mi", "nid-1.nid", "tmd-1.tmd", "matrix-3.txt"):
        try:
            scan = read_surface(topographies / name, undefined="interpolate")
        except SurfaceError:
            scan = read_surface(topographies / name, undefined="interpolate", size=(1e-5, 1e-5))
        assert (spikes_of(scan).count, form_of(scan).curvature) == (0, 0), name
    mirror = spikes_of(read_surface(topographies / "sur-2.sur", undefined="interpolate"))
    assert mirror.count == 3  # of up to 0.24 µm, on a mirror with an Sq of 5 nm


def test_flat_and_narrow_surfaces_have_nothing():
    for nodes in ((128, 96), (2, 96), (1, 1)):
        grid = Grid(nodes, (1e-6, 1e-6))
        flat = noted(Surface(np.zeros(nodes), grid)).provenance
        assert (flat["tilt_share"], flat["curvature_share"], flat["spikes"]) == (0, 0, 0)
        assert form_of(Surface(np.zeros(nodes), grid)).radius == math.inf
