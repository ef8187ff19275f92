"""Findings about the heights of scans: each on both sides of its limit, and its values."""

import math
from dataclasses import asdict

import numpy as np
import pytest

from restitution.contact.checks.inputs import doubtful, impossible
from restitution.contact.checks.scans import scan_findings, too_steep
from restitution.contact.contact import Contact
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, composite, extend, generate_surface
from restitution.surfaces.defects import noted
from tolerance import approx

GRID = Grid((128, 128), (0.5e-6, 0.5e-6))
X, Y = GRID.x[:, None], GRID.y[None, :]
ROUGH = generate_surface(GRID, kind="gaussian", rms=76e-9, correlation_length=3e-6, seed=1).height
RADIUS = 500e-6
SCAN = {"source": "measured", "file": "scan.npy", "levelling": "none"}


def scan(height, **provenance):
    return Surface(height, GRID, {**SCAN, **provenance})


def curved(radius=RADIUS, **provenance):
    return scan(ROUGH - (X**2 + Y**2) / (2 * radius), **provenance)


def codes(surface, radius=RADIUS):
    return [finding.code for finding in scan_findings(surface, radius)]


@pytest.mark.parametrize("steps", ["none", "center", "tilt", "center, tilt"])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_sphere_of_the_particle_is_still_in_the_scan(steps, sign):
    (found,) = scan_findings(curved(sign * RADIUS, levelling=steps), RADIUS)
    assert (found.code, found.file, found.reduced_radius) == (
        "curved-scan",
        "scan.npy",
        RADIUS,
    )
    assert found.radius == approx(sign * RADIUS, rel=0.05)
    assert found.explained > 0.9


def test_a_subtracted_sphere_is_not_found():
    assert codes(curved(levelling="curvature")) == []
    assert codes(curved(levelling="center, curvature")) == []
    assert codes(scan(ROUGH)) == []
    assert codes(Surface(curved().height, GRID, {"source": "generated"})) == []


def test_curvature_counts_if_it_changes_the_contact():
    assert codes(curved(), 0.09 * RADIUS) == []
    assert codes(curved(), 0.11 * RADIUS) == ["curved-scan"]
    assert codes(curved(), 9 * RADIUS) == ["curved-scan"]
    assert codes(curved(), 11 * RADIUS) == []


def test_a_tilted_sphere_needs_more_than_a_plane():
    tilted, bow = scan_findings(scan(curved().height + 0.05 * X), RADIUS)
    assert (tilted.code, tilted.curved, bow.code) == ("tilted-scan", True, "curved-scan")
    (only,) = scan_findings(scan(ROUGH + 0.05 * X), RADIUS)
    assert (only.code, only.curved) == ("tilted-scan", False)


def test_a_curved_scan_between_flat_bodies():
    smooth = scan(-(X**2 + Y**2) / (2 * RADIUS))
    assert codes(smooth, math.inf) == ["curved-scan"]
    period = 2 * np.pi / GRID.size[0]
    wave = scan(1e-7 * (np.cos(period * X) + np.cos(period * Y)))
    assert codes(wave, math.inf) == []


@pytest.mark.parametrize("how", ["twin", "mirror"])
def test_an_extension_keeps_what_was_noted(how):
    seed = {"seed": 1} if how == "twin" else {}
    larger = Grid((256, 256), GRID.spacing)
    assert codes(extend(noted(curved()), larger, how, **seed)) == ["curved-scan"]


def test_each_part_of_a_composite_is_looked_at():
    parts = [noted(curved(file="a.npy")), noted(scan(ROUGH + 0.05 * X, file="b.npy"))]
    found = scan_findings(composite(parts), RADIUS)
    assert [(each.code, each.file) for each in found] == [
        ("curved-scan", "a.npy"),
        ("tilted-scan", "b.npy"),
    ]


def spoiled(height):
    surface = ROUGH.copy()
    surface.ravel()[::811] += height
    return scan(surface)


def test_spikes_come_before_the_slope_that_they_cause():
    (found,) = scan_findings(spoiled(5e-6))
    assert (found.code, found.count, found.threshold) == ("spikes", 21, 8)
    assert too_steep(spoiled(5e-6)) is None
    assert too_steep(spoiled(50e-6)).code == "spikes"


def test_slopes_above_three_are_refused(pair):
    def zigzag(slope):
        return np.where(np.arange(128) % 2, slope * GRID.spacing[0], 0.0)[:, None] + 0 * Y

    contact = Contact(pair, Surface(zigzag(2.99), GRID))
    assert impossible(contact, 1e-7) is None
    assert "steep-surface" in [found.code for found in doubtful(contact, 1e-7)]
    found = impossible(Contact(pair, Surface(zigzag(3.01), GRID)), 1e-7)
    assert asdict(found) == {"slope": approx(3.01), "limit": 3.0, "file": ""}
    assert impossible(Contact(pair, scan(zigzag(3.01))), 1e-7).file == "scan.npy"
