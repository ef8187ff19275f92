"""What helps when a contact reaches the edge of its grid."""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.contact import Contact

_MARGIN = 1.2  # of a grid over the width that the contact may take


def first_touch(contact: Contact) -> tuple[float, float]:
    """Where the bodies touch first: x, y of the lowest gap, m."""
    i, j = np.unravel_index(int(contact.gap.argmin()), contact.gap.shape)
    return float(contact.grid.x[i]), float(contact.grid.y[j])


def needed_edges(contact: Contact, indentation: float) -> tuple[float, float]:
    """Edge lengths (m) of a grid that holds the contact at `indentation`; none below the present.

    Contact lies where h₀ < δ. With heights up to z_max and h₀ = r²/(2R*) − z − c that is within
    r² < 2R*(δ + z_max + c): sqrt(2R*δ) for smooth bodies.
    """
    R, x, y = contact.pair.radius, contact.grid.x[:, None], contact.grid.y[None, :]
    height = contact.surface.height
    shift = float(((x * x + y * y) / (2 * R) - height).min())
    reach = math.sqrt(2 * R * (indentation + float(height.max()) + shift))
    wide, long = contact.grid.size
    # The edge that is reached has to move out even where heights alone would explain it.
    needed = max(2 * reach, min(wide, long)) * _MARGIN
    return max(wide, needed), max(long, needed)


def edge_advice(contact: Contact, indentation: float) -> str:
    """What to change, as the end of a sentence, so that `contact` stays inside a grid."""
    x, y = first_touch(contact)
    wide, long = contact.grid.size
    off_centre = max(abs(x) / wide, abs(y) / long) > 0.25
    where = (
        f"the bodies touch first at x = {1e6 * x:.3g} um, y = {1e6 * y:.3g} um, off the centre; "
        if off_centre
        else ""
    )
    edges = needed_edges(contact, indentation)
    provenance = contact.surface.provenance
    size = f"{1e6 * edges[0]:.3g} um" + (
        "" if math.isclose(*edges) else f" x {1e6 * edges[1]:.3g} um"
    )
    if provenance.get("source") != "measured":
        return (
            f"{where}use a grid of about {size} (more grid.nodes or a larger grid.spacing) or stop "
            "at a smaller indentation"
        )
    scan = tuple(
        float(provenance.get(key, have))
        for key, have in zip(("size_x_m", "size_y_m"), contact.grid.size, strict=True)
    )
    detrend = {
        "tilt": 'roughness.detrend = "curvature", ',
        "curvature": "",
    }.get(str(provenance.get("levelling")), 'roughness.detrend = "tilt" or "curvature", ')
    if edges[0] <= scan[0] and edges[1] <= scan[1]:
        larger = f"a grid of about {size} (the scan has {1e6 * scan[0]:.3g} x {1e6 * scan[1]:.3g})"
    else:
        larger = "a larger scan, roughness.extend"
    return f"{where}use {detrend}{larger}, a smaller radius, or stop at a smaller indentation"
