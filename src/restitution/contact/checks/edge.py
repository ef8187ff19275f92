"""Contact at the edge of the grid: detect it, and find a grid that is large enough."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from restitution.contact.checks.finding import Finding
from restitution.contact.contact import Contact
from restitution.contact.state import State
from restitution.errors import DomainError

MARGIN = 1.2  # width of the recommended grid divided by the largest width of the contact

# First touch counts as off-centre if its distance from the centre exceeds this fraction of the
# width of the grid.
_OFF_CENTRE = 0.25


class EdgeReachedError(DomainError):
    """The contact reaches the edge of the grid; `finding` contains the values of `edge_values`."""

    def __init__(self, finding: Finding) -> None:
        wide, long = (1e6 * edge for edge in finding["size"])
        super().__init__(
            f"the contact reaches the edge of the {wide:.4g} um x {long:.4g} um grid at an "
            f"indentation of {1e9 * finding['indentation']:.4g} nm; use a grid of about "
            f"{edges_in_words(finding)} or stop at a smaller indentation"
        )
        self.finding = finding

    def __reduce__(self) -> tuple[type[EdgeReachedError], tuple[Finding]]:
        return EdgeReachedError, (self.finding,)


def require_inside_grid(state: State) -> None:
    """Raise `EdgeReachedError` if a node on the edge of the grid is in contact.

    The edge of a periodic contact is not checked.
    """
    if state.contact.periodic:
        return
    touching, (rows, columns), (nx, ny) = state.box_touching, state.box, state.contact.grid.nodes
    if (
        (rows.start == 0 and touching[:1].any())
        or (rows.stop == nx and touching[-1:].any())
        or (columns.start == 0 and touching[:, :1].any())
        or (columns.stop == ny and touching[:, -1:].any())
    ):
        raise EdgeReachedError(
            Finding("edge-reached", edge_values(state.contact, state.indentation))
        )


def edge_values(contact: Contact, indentation: float) -> dict[str, Any]:
    """Return the values of a finding about the edge of the grid. Lengths are in m.

    The values are:

    * `indentation`;
    * `size`, the edge lengths of the grid;
    * `needed`, the edge lengths of a grid that is large enough;
    * `first_touch`, the coordinates of first touch;
    * `off_centre`, whether first touch is far from the centre;
    * `levelling` and `scan`, the levelling and the size of a measured surface; None for others.
    """
    provenance, size = contact.surface.provenance, contact.grid.size
    touch = first_touch(contact)
    measured = provenance.get("source") == "measured"
    keys = zip(("size_x_m", "size_y_m"), size, strict=True)
    return {
        "indentation": indentation,
        "size": size,
        "needed": needed_edges(contact, indentation),
        "first_touch": touch,
        "off_centre": max(abs(x) / w for x, w in zip(touch, size, strict=True)) > _OFF_CENTRE,
        "levelling": str(provenance.get("levelling")) if measured else None,
        "scan": tuple(float(provenance.get(key, own)) for key, own in keys) if measured else None,
    }


def edges_in_words(finding: Finding) -> str:
    """The `needed` edge lengths of `finding` as text, in µm."""
    wide, long = finding["needed"]
    return f"{1e6 * wide:.3g} um" + ("" if math.isclose(wide, long) else f" x {1e6 * long:.3g} um")


def first_touch(contact: Contact) -> tuple[float, float]:
    """Coordinates x and y of the smallest gap (m), where the bodies touch first."""
    i, j = np.unravel_index(int(contact.gap.argmin()), contact.gap.shape)
    return float(contact.grid.x[i]), float(contact.grid.y[j])


def largest_reach(contact: Contact, indentation: float) -> float:
    """Distance (m) from the centre within which all contact at `indentation` (m) lies.

    Contact is possible only where the initial gap h₀ is smaller than the indentation δ. At the
    distance r from the centre, h₀ = r²/(2R*) − z − c with the height z ≤ z_max. The constant c
    makes min h₀ = 0. Contact is therefore possible only for r² < 2R*(δ + z_max + c). For smooth
    bodies this is r < sqrt(2R*δ).
    """
    R, x, y = contact.pair.radius, contact.grid.x[:, None], contact.grid.y[None, :]
    height = contact.surface.height
    shift = float(((x * x + y * y) / (2 * R) - height).min())
    return math.sqrt(2 * R * (indentation + float(height.max()) + shift))


def needed_edges(contact: Contact, indentation: float) -> tuple[float, float]:
    """Edge lengths (m) of a grid that contains the contact; at least those of the present grid."""
    wide, long = contact.grid.size
    # The contact reaches the edge of the grid or is expected to reach it. So a larger grid is
    # recommended even if the present grid is already wider than the largest contact.
    needed = max(2 * largest_reach(contact, indentation), min(wide, long)) * MARGIN
    return max(wide, needed), max(long, needed)
