"""Twins of scans: Rq, skewness, rms slope and spectrum within stated bounds."""

import numpy as np
import pytest

from restitution import describe, extend, level, read_surface, remove_outliers
from tolerance import approx


@pytest.mark.parametrize(("name", "outliers"), [("di-3.di", None), ("mi-1.mi", 8.0), ("own", None)])
def test_a_twin_of_a_scan(request, name, outliers):
    own = name == "own"
    file = request.getfixturevalue("own_scan" if own else "topographies")
    scan = read_surface(file if own else file / name)
    if outliers:  # slipped scan lines, which no spectrum describes
        scan = remove_outliers(scan, outliers)
    scan = level(scan, "tilt")
    want, found = describe(scan), []
    for seed in range(4):
        twin = extend(scan, tuple(2 * edge for edge in scan.grid.size), "twin", seed=seed)
        have = describe(twin)
        assert have["Sq_m"] == approx(want["Sq_m"], rel=1e-3, abs=0)
        assert have["Ssk"] == approx(want["Ssk"], abs=0.02)
        assert have["Sku"] == approx(want["Sku"], rel=0.015, abs=0)
        assert have["Sdq"] == approx(want["Sdq"], rel=0.02)
        assert twin.provenance["spectrum_misfit"] < 0.35
        found.append((have["Sdq"] / want["Sdq"], twin.provenance["spectrum_misfit"]))
    slope, misfit = np.mean(found, axis=0)
    assert slope == approx(1, abs=0.01)
    assert misfit < 0.25


def test_a_scan_that_no_spectrum_describes_is_said_to_be_one(topographies):
    scan = level(read_surface(topographies / "nid-1.nid"), "curvature")
    twin = extend(scan, (40e-6, 40e-6), "twin", seed=1)
    assert "one spectrum does not describe this scan" in twin.provenance["notice"]
