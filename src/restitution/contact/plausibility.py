"""What speaks against a contact before it is solved: slips of a unit, and theory's limits."""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.edge import edge_advice, first_touch
from restitution.contact.resolution import predicted_radius
from restitution.errors import CaseError
from restitution.surfaces import level, rms_slope
from restitution.theory import Hertz, Kendall

_TILTED = 0.5  # of the variance of the heights that a plane explains
_OBLONG = 0.01  # difference of the edges of a pixel
_STEEP = 0.5  # rms slope beyond which small-slope theory misleads
_PRESSURES = (1e-5, 0.3)  # p_y/E* of materials, from soft polymers to the ideal strength
_NEAR_EDGE = 0.1  # of the width of the grid
_DISPLACED = 0.7  # of the displacement outside a smooth contact, for rough ones carry less force


def require_small(contact: Contact, indentation: float) -> None:
    """Raise `CaseError` where the roughness or the contact is larger than the particle."""
    pair, height = contact.pair, contact.surface.height
    radius = min(pair.first.radius, pair.second.radius)
    if height.size and (peak := float(height.max() - height.mean())) >= radius:
        raise CaseError(
            f"radius: the particle of {1e6 * radius:.4g} um is smaller than its roughness, whose "
            f"highest peak is {1e6 * peak:.4g} um above the mean; check the units of the radius "
            "and of the roughness"
        )
    foreseen = predicted_radius(pair, indentation, contact.hardness)
    if foreseen > pair.radius:
        raise CaseError(
            f"the contact is foreseen to reach {1e6 * foreseen:.4g} um from the centre at an "
            f"indentation of {1e9 * indentation:.4g} nm, beyond R* = {1e6 * pair.radius:.4g} um: "
            "stop earlier, or check the units of the depths and of the radius"
        )


def input_warnings(contact: Contact, indentation: float) -> list[str]:
    """What the input of `contact` says against loading it to `indentation` (m)."""
    checks = (
        _tilt(contact), _edge(contact, indentation), _steepness(contact),
        _yield_pressure(contact), _oblong(contact), _coarse_grid(contact), _made_up(contact),
    )  # fmt: skip
    return [line for line in checks if line]


def _tilt(contact: Contact) -> str | None:
    surface = contact.surface
    # Of a composite each part has its own.
    levelled = {value for key, value in surface.provenance.items() if key.endswith("levelling")}
    if not levelled & {"none", "center"}:
        return None
    variance = float(np.var(surface.height))
    explained = 1 - float(np.var(level(surface, "tilt").height)) / variance if variance else 0.0
    if explained <= _TILTED:
        return None
    return (
        f"{surface.provenance['file']}: the scan is tilted (a plane explains {explained:.0%} of "
        'the variance of its heights): set roughness.detrend = "tilt" or "curvature"'
    )


def _edge(contact: Contact, indentation: float) -> str | None:
    """Contact at the rim of the grid, with a margin for what smooth bodies do not tell."""
    radius = predicted_radius(contact.pair, indentation, contact.hardness)
    gap, grid = contact.gap, contact.grid
    half_width = 0.5 * min(grid.size)
    if radius >= half_width:  # `predicted_warnings` says so
        return None
    rim = float(min(gap[0].min(), gap[-1].min(), gap[:, 0].min(), gap[:, -1].min()))
    position = zip(first_touch(contact), grid.size, strict=True)
    near = any(abs(at) > (0.5 - _NEAR_EDGE) * edge for at, edge in position)
    if not near and rim >= _closed_gap(contact, indentation, half_width):
        return None
    return (
        f"the contact is foreseen to reach the edge of the grid: the gap there is "
        f"{1e9 * rim:.4g} nm at first touch, and the deepest indentation is "
        f"{1e9 * indentation:.4g} nm; {edge_advice(contact, indentation)}"
    )


def _closed_gap(contact: Contact, indentation: float, distance: float) -> float:
    """The undeformed gap up to which bodies are foreseen to touch `distance` off the centre, m.

    It is the indentation less the displacement F/(πE*r) outside a smooth contact. Adhesion deepens
    the indentation by the pull-off displacement of a punch as wide as the contact (JKR). Where the
    roughness is as high as the indentation is deep, single asperities carry the load, and displace
    little.
    """
    pair, p_y, w = contact.pair, contact.hardness, contact.work_of_adhesion
    E_star, deeper = pair.contact_modulus, indentation
    for _ in range(10):  # a fixed point: `radius` grows with its square root at most
        radius = predicted_radius(pair, deeper, p_y)
        if not contact.adhesive:
            break
        deeper = indentation + float(Kendall(E_star, w).pull_off_displacement(radius))
    elastic = float(Hertz(pair.radius, E_star).force_at_contact_radius(radius))
    force = min(elastic, math.pi * radius**2 * p_y)
    share = max(_DISPLACED - float(np.std(contact.surface.height)) / indentation, 0.0)
    return deeper - share * force / (math.pi * E_star * distance)


def _steepness(contact: Contact) -> str | None:
    slope = rms_slope(contact.surface)
    if slope <= _STEEP:
        return None
    return (
        f"the rms slope of the surface is {slope:.2g}: half-space theory holds for small slopes, "
        f"below about {_STEEP}; check the units of the heights, or level or filter the surface"
    )


def _yield_pressure(contact: Contact) -> str | None:
    ratio = contact.hardness / contact.pair.contact_modulus
    low, high = _PRESSURES
    if math.isinf(ratio) or low <= ratio <= high:
        return None
    return (
        f"the yield pressure is {ratio:.2g} of the contact modulus E*, where materials have "
        f"{low:g} to {high:g}: check the units of yield_pressure and youngs_modulus"
    )


def _oblong(contact: Contact) -> str | None:
    """Scans are square in their pixels: others may lack lines, stretched over the stated size."""
    provenance = contact.surface.provenance
    for key, hx in provenance.items():
        if not key.endswith("pixel_x_m") or (key != "pixel_x_m" and not key.startswith("part_")):
            continue
        of = key.removesuffix("pixel_x_m")
        hy = float(provenance[f"{of}pixel_y_m"])
        if abs(float(hx) / hy - 1) > _OBLONG and (f"{of}file" in provenance):
            return (
                f"{provenance[f'{of}file']}: the pixels are {1e6 * float(hx):.4g} x {1e6 * hy:.4g} "
                "um, not square: if scan lines are missing in the file, it is stretched; check the "
                "size"
            )
    return None


def _coarse_grid(contact: Contact) -> str | None:
    provenance, grid = contact.surface.provenance, contact.grid
    for axis, h in zip("xy", grid.spacing, strict=True):
        pixel = float(provenance.get(f"pixel_{axis}_m", h))
        if h > 1.001 * pixel:
            return (
                f"the grid spacing {1e6 * h:.3g} um is coarser than the scan's pixel "
                f"{1e6 * pixel:.3g} um along {axis}: waves shorter than {2e6 * h:.3g} um are "
                "taken out of it; make cells smaller (grid.refine), down to the pixel, to keep them"
            )
    return None


def _made_up(contact: Contact) -> str | None:
    """What the surface says of itself where it is not what was measured."""
    notice = contact.surface.provenance.get("notice")
    return None if notice is None else str(notice)
