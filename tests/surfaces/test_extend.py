import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, describe, extend, generate_surface, place_on_grid

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
    assert have["Sq_m"] == pytest.approx(want["Sq_m"], rel=1e-9)
    assert have["Ssk"] == pytest.approx(want["Ssk"], abs=0.01)
    assert have["Sku"] == pytest.approx(want["Sku"], abs=0.05)
    assert have["Sdq"] == pytest.approx(want["Sdq"], rel=0.05)
    assert have["rms_curvature_per_m"] == pytest.approx(want["rms_curvature_per_m"], rel=0.1)
    assert twin.provenance["spectrum_misfit"] < 0.35
    assert twin.provenance["scan_Sq_m"] == want["Sq_m"]
    assert "not the scan itself" in twin.provenance["notice"]


def test_a_twin_keeps_the_lay():
    measured = scan(correlation_length=(4e-6, 0.8e-6), lay=0.5)
    twin = extend(measured, (25e-6, 25e-6), "twin", seed=1)

    def direction(surface):
        gx, gy = (np.diff(surface.height, axis=a)[:127, :127] for a in (0, 1))
        return 0.5 * np.arctan2(2 * (gx * gy).mean(), (gx * gx - gy * gy).mean())

    assert direction(twin) == pytest.approx(direction(measured), abs=0.15)


def test_the_same_seed_is_the_same_twin_and_another_is_another():
    one, same, other = (extend(scan(), (20e-6, 20e-6), "twin", seed=s).height for s in (1, 1, 2))
    assert np.array_equal(one, same)
    assert abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.1
    middle = one[:128, :128]
    assert abs(np.corrcoef(middle.ravel(), scan().height.ravel())[0, 1]) < 0.4


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
        ("twin", (1e-5, 1e-5), None, "needs one"),
        ("twin", (1e-5, 1e-5), -1, "needs one"),
        ("mirror", (1e-5, 1e-5), 1, "does not belong"),
        ("twin", (0.0, 1e-5), 1, "not two positive lengths"),
        ("mirror", (float("nan"), 1e-5), None, "not two positive lengths"),
    ],
)
def test_bad_requests(how, size, seed, words):
    with pytest.raises(SurfaceError, match=words):
        extend(scan(), size, how, seed=seed)
