"""Checks of a contact before it is solved: wrong units, and the limits of the theory."""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.checks.edge import edge_predicted, first_touch
from restitution.contact.checks.findings import (
    CoarserThanScan,
    ContactBeyondRadius,
    Finding,
    OblongPixels,
    RoughnessAboveRadius,
    SurfaceNotice,
    UnusualYieldPressure,
)
from restitution.contact.checks.resolution import (
    coarse_scan,
    predicted_radius,
    resolution_findings,
)
from restitution.contact.checks.scans import scan_findings, too_steep
from restitution.contact.contact import Contact
from restitution.contact.interface import interface_of
from restitution.theory import Hertz, Kendall

# Limits beyond which an input is doubtful.
_OBLONG = 0.01  # relative difference between the two edge lengths of a pixel
# Plausible range of p/E*, where p is the pressure of a fully plastic contact. The lower limit
# belongs to very soft metals, the upper limit to the ideal strength of solids.
_PRESSURES = (1e-5, 0.3)
_NEAR_EDGE = 0.1  # distance of first touch from the edge, as a fraction of the width of the grid

# The displacement outside the contact is computed for smooth bodies and multiplied by this factor.
# The factor is below 1, because at the same indentation the force between rough bodies is smaller
# than between smooth bodies.
_DISPLACED = 0.7


def impossible(contact: Contact, indentation: float) -> Finding | None:
    """Return a finding if loading `contact` to `indentation` (m) is meaningless, otherwise None."""
    if contact.periodic:
        return too_steep(contact.surface) or interface_of(contact).grid_finding(contact)
    pair, height = contact.pair, contact.surface.height
    radius = min(pair.first.radius, pair.second.radius)
    if height.size and (peak := float(height.max() - height.mean())) >= radius:
        return RoughnessAboveRadius(radius, peak)
    if steep := too_steep(contact.surface):
        return steep
    predicted = predicted_radius(pair, indentation, contact.hardness)
    if predicted > pair.radius:
        return ContactBeyondRadius(predicted, indentation, pair.radius)
    return interface_of(contact).grid_finding(contact) or coarse_scan(contact, indentation)


def doubtful(contact: Contact, indentation: float) -> list[Finding]:
    """Find reasons to doubt the result of loading `contact` to `indentation` (m)."""
    periodic = contact.periodic
    checks = (
        None if periodic else _edge(contact, indentation),
        _yield_pressure(contact),
        _oblong(contact),
        _coarse_grid(contact),
        _made_up(contact),
    )
    by_radius = [] if periodic else resolution_findings(contact, indentation)
    heights = scan_findings(contact.surface, contact.pair.radius)
    return by_radius + heights + [finding for finding in checks if finding]


def _edge(contact: Contact, indentation: float) -> Finding | None:
    radius = predicted_radius(contact.pair, indentation, contact.hardness)
    gap, grid = contact.gap, contact.grid
    half_width = 0.5 * min(grid.size)
    if radius >= half_width:  # reported as `contact-beyond-grid`
        return None
    rim = float(min(gap[0].min(), gap[-1].min(), gap[:, 0].min(), gap[:, -1].min()))
    position = zip(first_touch(contact), grid.size, strict=True)
    near = any(abs(at) > (0.5 - _NEAR_EDGE) * edge for at, edge in position)
    if not near and rim >= _closed_gap(contact, indentation, half_width):
        return None
    return edge_predicted(contact, indentation, rim)


def _closed_gap(contact: Contact, indentation: float, distance: float) -> float:
    """Largest undeformed gap (m) that is predicted to close at `distance` from the centre.

    It is the indentation (with adhesion, plus the pull-off displacement of a flat punch as wide as
    the contact) minus the elastic displacement F/(πE*r), which is smaller for rough bodies.
    """
    pair, p_y, w = contact.pair, contact.hardness, interface_of(contact).work_of_adhesion
    E_star, deeper = pair.contact_modulus, indentation
    # The fixed-point iteration converges, because `deeper` grows only with the root of the radius.
    for _ in range(10):
        radius = predicted_radius(pair, deeper, p_y)
        if not w:
            break
        deeper = indentation + float(Kendall(E_star, w).pull_off_displacement(radius))
    elastic = float(Hertz(pair.radius, E_star).force_at_contact_radius(radius))
    force = min(elastic, math.pi * radius**2 * p_y)
    share = max(_DISPLACED - float(np.std(contact.surface.height)) / indentation, 0.0)
    return deeper - share * force / (math.pi * E_star * distance)


def _yield_pressure(contact: Contact) -> Finding | None:
    ratio = contact.hardness / contact.pair.contact_modulus
    low, high = _PRESSURES
    usual = math.isinf(ratio) or low <= ratio <= high
    return None if usual else UnusualYieldPressure(ratio, low, high)


def _oblong(contact: Contact) -> Finding | None:
    """Return a finding if pixels are not square, which suggests missing scan lines in the file."""
    provenance = contact.surface.provenance
    for key, hx in provenance.items():
        if not key.endswith("pixel_x_m") or (key != "pixel_x_m" and not key.startswith("part_")):
            continue
        of = key.removesuffix("pixel_x_m")
        hy = float(provenance[f"{of}pixel_y_m"])
        if abs(float(hx) / hy - 1) > _OBLONG and (f"{of}file" in provenance):
            return OblongPixels(str(provenance[f"{of}file"]), float(hx), hy)
    return None


def _coarse_grid(contact: Contact) -> Finding | None:
    provenance, grid = contact.surface.provenance, contact.grid
    for axis, h in zip("xy", grid.spacing, strict=True):
        pixel = float(provenance.get(f"pixel_{axis}_m", h))
        if h > 1.001 * pixel:
            return CoarserThanScan(h, pixel, axis)
    return None


def _made_up(contact: Contact) -> Finding | None:
    notice = contact.surface.provenance.get("notice")
    return None if notice is None else SurfaceNotice(str(notice))
