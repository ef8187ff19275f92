import tracemalloc

import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, describe, extend, generate_surface, place_on_grid
from tolerance import approx

GRID = Grid((128, 128), (0.1e-6, 0.1e-6))


def scan(**kind):
    kind = {"kind": "gaussian", "rms": 5e-8, "correlation_length": 1e-6, "seed": 1, **kind}
    whole = generate_surface(Grid((256, 256), GRID.spacing), **kind)
    return Surface(whole.height[:128, :128].copy(), GRID, {"source": "measured", "file": "s.npy"})


@pytest.mark.parametrize(
    "kind",
    [
        {},
        {"skewness": -1.0, "kurtosis": 5.0},
        {"kind": "self-affine", "correlation_length": None, "hurst": 0.7, "rolloff": 6e-6},
        {"correlation_length": (3e-6, 0.8e-6), "lay": 0.5},
    ],
)
def test_a_twin_is_alike_in_all_that_is_counted(kind):
    measured = scan(**kind)
    twin = extend(measured, (40e-6, 30e-6), "twin", seed=3)
    assert twin.grid.nodes == (400, 300)
    have, want = describe(twin), describe(measured)
    assert have["Sq_m"] == approx(want["Sq_m"], rel=1e-3, abs=0)
    assert have["Ssk"] == approx(want["Ssk"], abs=0.02)
    assert have["Sku"] == approx(want["Sku"], rel=0.02, abs=0)
    assert have["Sdq"] == approx(want["Sdq"], rel=0.05)
    assert have["rms_curvature_per_m"] == approx(want["rms_curvature_per_m"], rel=0.1)
    assert twin.provenance["spectrum_misfit"] < 0.35
    assert twin.provenance["scan_Sq_m"] == want["Sq_m"]
    assert "not the scan itself" in twin.provenance["notice"]


def test_a_twin_keeps_the_lay():
    measured = scan(correlation_length=(4e-6, 0.8e-6), lay=0.5)
    twin = extend(measured, (25e-6, 25e-6), "twin", seed=1)

    def direction(surface):
        gx, gy = (np.diff(surface.height, axis=a)[:127, :127] for a in (0, 1))
        return 0.5 * np.arctan2(2 * (gx * gy).mean(), (gx * gx - gy * gy).mean())

    assert direction(twin) == approx(direction(measured), abs=0.15)


def test_the_same_seed_is_the_same_twin_and_another_is_another():
    one, same, other = (extend(scan(), (20e-6, 20e-6), "twin", seed=s).height for s in (1, 1, 2))
    assert np.array_equal(one, same)
    assert abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.1
    middle = one[:128, :128]
    assert abs(np.corrcoef(middle.ravel(), scan().height.ravel())[0, 1]) < 0.4


def waves(surface):
    """Complex amplitudes of the waves, with phases relative to the origin of the grid."""
    modes = np.fft.fft2(surface.height, norm="forward")
    shift = [np.exp(2j * np.pi * (n // 2) * np.fft.fftfreq(n)) for n in surface.grid.nodes]
    return modes * np.multiply.outer(*shift)


@pytest.mark.parametrize("nodes", [(96, 80), (75, 61), (20, 24)])
@pytest.mark.parametrize("finer", [2, 4, 1.5, 8])
def test_a_finer_grid_has_the_same_twin_and_its_shorter_waves(nodes, finer):
    measured = scan(kind="self-affine", correlation_length=None, hurst=0.6, skewness=-1, kurtosis=5)
    size = 30e-6, 24e-6
    coarse, fine = (
        extend(measured, Grid(n, (size[0] / n[0], size[1] / n[1])), "twin", seed=2)
        for n in (nodes, tuple(round(finer * n) for n in nodes))
    )
    have, more = waves(coarse), waves(fine)
    M, N = ((n - 1) // 2 for n in nodes)
    common = np.r_[-M : M + 1][:, None], np.r_[-N : N + 1][None, :]
    np.testing.assert_allclose(have[common], more[common], rtol=0, atol=1e-12 * coarse.height.std())
    more[common] = 0.0
    assert np.linalg.norm(more) > 0.01 * np.linalg.norm(have)


def test_what_the_grid_of_a_twin_does_not_carry_is_said():
    measured = scan(kind="self-affine", correlation_length=None, hurst=0.6)
    grid = Grid((50, 50), (0.5e-6, 0.5e-6))
    twin = extend(measured, grid, "twin", seed=2)
    full = extend(measured, Grid((250, 250), (0.1e-6, 0.1e-6)), "twin", seed=2)
    said = twin.provenance
    assert said["shortest_carried_m"] == approx(1e-6, abs=0)
    removed = full.height[::5, ::5] - twin.height
    assert said["removed_rms_m"] == approx(removed.std(), rel=0.1, abs=0)
    assert 0.5 < said["removed_slope"] < 1
    assert "waves shorter than 1 um, which this grid does not resolve, have" in said["notice"]
    assert full.provenance["removed_slope"] == full.provenance["removed_rms_m"] == 0
    assert "does not resolve" not in full.provenance["notice"]


def test_a_twin_is_cut_out_of_one_as_large_as_the_scan():
    twin = extend(scan(), Grid((40, 128), GRID.spacing), "twin", seed=2)
    assert twin.grid.nodes == (40, 128)
    assert "periodicity" not in twin.provenance


def peak_of(work):
    tracemalloc.start()
    work()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


@pytest.mark.parametrize("how", ["twin", "mirror"])
def test_the_pixels_of_the_scan_over_the_whole_domain_are_never_made(how):
    grid = Grid((100, 100), (6e-6, 6e-6))  # 6000 x 6000 pixels
    seed = 1 if how == "twin" else None
    assert peak_of(lambda: extend(scan(), grid, how, seed=seed)) < 0.3 * 6000**2 * 8
    assert extend(scan(), grid, how, seed=seed).provenance["removed_slope"] > 0.8


@pytest.mark.parametrize(
    ("surface", "grid", "words"),
    [
        (Surface(np.zeros(GRID.nodes) + 0.1, GRID), GRID, "is flat, so it has no twin"),
        (Surface(np.zeros((1, 90)), Grid((1, 90), GRID.spacing)), GRID, "1 x 90 pixels are too"),
        (Surface(np.eye(2), Grid((2, 2), GRID.spacing)), GRID, "2 x 2 pixels are too few"),
        (
            scan(),
            Grid((40, 40), (8e-6, 8e-6)),
            "^grid: cells of 8 um cannot resolve any wave of a scan",
        ),
    ],
)
def test_scans_without_a_twin(surface, grid, words):
    with pytest.raises(SurfaceError, match=words):
        extend(surface, grid, "twin", seed=1)


def test_a_twin_of_oblong_pixels():
    height = scan().height[:, ::2]
    measured = Surface(height, Grid((128, 64), (1e-7, 2e-7)))
    twin = extend(measured, Grid((200, 200), (2e-7, 2e-7)), "twin", seed=1)
    assert describe(twin)["Sq_m"] == approx(describe(measured)["Sq_m"], rel=0.02, abs=0)


def test_mirrored_tiles_on_coarser_and_finer_cells():
    large = extend(scan(), (51.2e-6, 38.4e-6), "mirror")
    for nodes, tolerance in (((128, 96), 0.02), ((1024, 768), 0.02)):
        size = large.grid.size
        grid = Grid(nodes, (size[0] / nodes[0], size[1] / nodes[1]))
        placed = place_on_grid(large, grid)
        tiled = extend(scan(), grid, "mirror")
        assert tiled.grid == grid
        off = (tiled.height - placed.height)[2:-2, 2:-2]  # the rim also depends on the next tiles
        assert off.std() < tolerance * large.height.std()


def test_what_no_spectrum_describes_is_said():
    height = np.where(GRID.x[:, None] > 3.3e-6, 1e-6, 0.0) + scan().height
    notice = extend(Surface(height, GRID), (20e-6, 20e-6), "twin", seed=1).provenance["notice"]
    assert "one spectrum does not describe this scan" in notice
    assert "one spectrum" not in extend(scan(), (20e-6, 20e-6), "twin", seed=1).provenance["notice"]


@pytest.mark.parametrize("nodes", [(128, 128), (300, 129), (700, 500)])
def test_mirrored_tiles_keep_the_scan_in_the_middle(nodes):
    tiled = extend(scan(), (nodes[0] * 1e-7, nodes[1] * 1e-7), "mirror")
    assert tiled.grid.nodes == nodes
    middle = place_on_grid(tiled, GRID)
    assert np.array_equal(middle.height, scan().height)
    for axis, n in enumerate(nodes):
        if n > 128:
            steps = np.abs(np.diff(tiled.height, axis=axis))
            assert steps.max() == np.abs(np.diff(scan().height, axis=axis)).max()
    if nodes != (128, 128):
        assert "repeats itself" in tiled.provenance["notice"]
        assert tiled.provenance["source"] == "mirrored"


@pytest.mark.parametrize(
    ("how", "size", "seed", "words"),
    [
        ("wrap", (1e-5, 1e-5), None, "'wrap' is unknown"),
        ("twin", (1e-5, 1e-5), None, "needs a seed"),
        ("twin", (1e-5, 1e-5), -1, "needs a seed"),
        ("mirror", (1e-5, 1e-5), 1, "^seed: does not apply to how='mirror'"),
        ("twin", (0.0, 1e-5), 1, "^argument `to`: .* are not two positive lengths"),
        ("mirror", (float("nan"), 1e-5), None, "^argument `to`: .* are not two positive lengths"),
    ],
)
def test_bad_requests(how, size, seed, words):
    with pytest.raises(SurfaceError, match=words):
        extend(scan(), size, how, seed=seed)
