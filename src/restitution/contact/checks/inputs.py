"""Checks of a contact before it is solved: wrong units, and the limits of the theory."""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.checks.edge import edge_values, first_touch
from restitution.contact.checks.finding import Finding
from restitution.contact.checks.resolution import (
    coarse_scan,
    predicted_radius,
    resolution_findings,
)
from restitution.contact.checks.scans import scan_findings, too_steep
from restitution.contact.cohesive.equilibrium import needed_spacing, resolves_range
from restitution.contact.contact import Contact
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
    """Return a finding if loading `contact` to `indentation` (m) is meaningless, otherwise None.

    The findings and their values are:

    * `roughness-above-radius`: `radius` of the smaller particle, and height `peak` of the highest
      point above the mean (m);
    * `contact-beyond-radius`: predicted contact `radius`, `indentation`, `reduced_radius` (m);
    * `pixel-above-contact`: see `coarse_scan`;
    * `impossible-slope`, `spikes`: see `too_steep`;
    * `range-unresolved`: `spacing` and `needed` spacing (m) of a cohesive contact, and whether
      the contact is `periodic`.

    Flat bodies have no radius, so only slopes and `range-unresolved` apply to a periodic contact.
    """
    if contact.periodic:
        return too_steep(contact.surface) or _coarse_range(contact)
    pair, height = contact.pair, contact.surface.height
    radius = min(pair.first.radius, pair.second.radius)
    if height.size and (peak := float(height.max() - height.mean())) >= radius:
        return Finding("roughness-above-radius", {"radius": radius, "peak": peak})
    if steep := too_steep(contact.surface):
        return steep
    predicted = predicted_radius(pair, indentation, contact.hardness)
    if predicted > pair.radius:
        return Finding(
            "contact-beyond-radius",
            {"radius": predicted, "indentation": indentation, "reduced_radius": pair.radius},
        )
    return _coarse_range(contact) or coarse_scan(contact, indentation)


def doubtful(contact: Contact, indentation: float) -> list[Finding]:
    """Find reasons to doubt the result of loading `contact` to `indentation` (m).

    The result contains the findings of `resolution_findings` and `scan_findings`, and the following
    ones. Each code is followed by the names of its values:

    * `edge-predicted`: smallest `gap` on the edge of the grid at first touch (m), and the values of
      `edge_values`;
    * `unusual-yield-pressure`: `ratio` of the pressure of a fully plastic contact to E*, and the
      usual range of this ratio, `low` to `high`;
    * `oblong-pixels`: `file`, and edges `x` and `y` of a pixel (m);
    * `coarser-than-scan`: grid `spacing` and pixel edge `pixel` (m) along an `axis`, x or y;
    * `surface-notice`: `notice`, a text from the provenance of the surface. It says how the
      surface differs from the scan from which it was made.

    For a periodic contact, the findings that depend on the radius of the bodies are left out.
    """
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
    return by_radius + heights + [found for found in checks if found]


def _coarse_range(contact: Contact) -> Finding | None:
    if not contact.cohesive or resolves_range(contact):
        return None
    return Finding(
        "range-unresolved",
        {
            "spacing": max(contact.grid.spacing),
            "needed": needed_spacing(contact),
            "periodic": contact.periodic,
        },
    )


def _edge(contact: Contact, indentation: float) -> Finding | None:
    """Return a finding if contact at the edge of the grid is expected, otherwise None."""
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
    return Finding("edge-predicted", {"gap": rim, **edge_values(contact, indentation)})


def _closed_gap(contact: Contact, indentation: float, distance: float) -> float:
    """Largest undeformed gap (m) that is predicted to close at `distance` from the centre.

    The result is the indentation minus the elastic displacement at this distance. With adhesion,
    the pull-off displacement of a flat punch as wide as the contact is added to the indentation.

    At the distance r, the displacement around a smooth contact under the force F is F/(πE*r). For
    rough bodies it is reduced. The reduction is larger if the roughness is large compared with the
    indentation: only a few asperities are then in contact, and the force is smaller.
    """
    pair, p_y, w = contact.pair, contact.hardness, contact.work_of_adhesion
    E_star, deeper = pair.contact_modulus, indentation
    # The fixed-point iteration converges, because `deeper` grows only with the root of the radius.
    for _ in range(10):
        radius = predicted_radius(pair, deeper, p_y)
        if not contact.adhesive:
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
    values = {"ratio": ratio, "low": low, "high": high}
    return None if usual else Finding("unusual-yield-pressure", values)


def _oblong(contact: Contact) -> Finding | None:
    """Return a finding if pixels are not square, which suggests missing scan lines in the file."""
    provenance = contact.surface.provenance
    for key, hx in provenance.items():
        if not key.endswith("pixel_x_m") or (key != "pixel_x_m" and not key.startswith("part_")):
            continue
        of = key.removesuffix("pixel_x_m")
        hy = float(provenance[f"{of}pixel_y_m"])
        if abs(float(hx) / hy - 1) > _OBLONG and (f"{of}file" in provenance):
            return Finding(
                "oblong-pixels", {"file": provenance[f"{of}file"], "x": float(hx), "y": hy}
            )
    return None


def _coarse_grid(contact: Contact) -> Finding | None:
    provenance, grid = contact.surface.provenance, contact.grid
    for axis, h in zip("xy", grid.spacing, strict=True):
        pixel = float(provenance.get(f"pixel_{axis}_m", h))
        if h > 1.001 * pixel:
            return Finding("coarser-than-scan", {"spacing": h, "pixel": pixel, "axis": axis})
    return None


def _made_up(contact: Contact) -> Finding | None:
    notice = contact.surface.provenance.get("notice")
    return None if notice is None else Finding("surface-notice", {"notice": str(notice)})
