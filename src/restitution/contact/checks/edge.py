"""Contact at the edge of its grid: where it is, and which grid would hold it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from restitution.contact.checks.finding import Finding
from restitution.contact.contact import Contact
from restitution.contact.state import State
from restitution.errors import DomainError

_MARGIN = 1.2  # of a grid over the width that the contact may take
_OFF_CENTRE = 0.25  # of the width of the grid


class EdgeReachedError(DomainError):
    """The contact reaches the edge of the grid; `finding` says where, and what would hold it."""

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
    """Raise `EdgeReachedError` when a node on the rim of the grid is in contact."""
    p, grid = state.box_pressure, state.contact.grid
    (top, left), (bottom, right) = (
        (part.start for part in state.box),
        (part.stop for part in state.box),
    )
    nx, ny = grid.nodes
    reached = (
        (top == 0 and p[:1].any())
        or (bottom == nx and p[-1:].any())
        or (left == 0 and p[:, :1].any())
        or (right == ny and p[:, -1:].any())
    )
    if reached:
        raise EdgeReachedError(
            Finding("edge-reached", edge_values(state.contact, state.indentation))
        )


def edge_values(contact: Contact, indentation: float) -> dict[str, Any]:
    """What a finding about the edge of the grid holds, lengths in m.

    `indentation`; `size` of the grid; `needed` edges; `first_touch` and whether it is
    `off_centre`; of a measured surface, else None, its `levelling` and the size of the `scan`.
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
    """The `needed` edge lengths of a finding, in µm."""
    wide, long = finding["needed"]
    return f"{1e6 * wide:.3g} um" + ("" if math.isclose(wide, long) else f" x {1e6 * long:.3g} um")


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
