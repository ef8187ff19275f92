"""Contact at the edge of the grid: detect it, and find a grid that is large enough."""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.checks.findings import EdgePredicted, EdgeReached
from restitution.contact.contact import Contact
from restitution.contact.state import State
from restitution.errors import DomainError

MARGIN = 1.2  # width of the recommended grid divided by the largest width of the contact

# First touch counts as off-centre if its distance from the centre exceeds this fraction of the
# width of the grid.
_OFF_CENTRE = 0.25


class EdgeReachedError(DomainError):
    """The contact reaches the edge of the grid."""

    def __init__(self, finding: EdgeReached) -> None:
        wide, long = (1e6 * edge for edge in finding.size)
        super().__init__(
            f"the contact reaches the edge of the {wide:.4g} um x {long:.4g} um grid at an "
            f"indentation of {1e9 * finding.indentation:.4g} nm; use a grid of about "
            f"{finding.needed_in_words()} or stop at a smaller indentation"
        )
        self.finding = finding

    def __reduce__(self) -> tuple[type[EdgeReachedError], tuple[EdgeReached]]:
        return EdgeReachedError, (self.finding,)


def require_inside_grid(state: State) -> None:
    """Raise `EdgeReachedError` if a node on the edge of a grid that is not periodic touches."""
    if state.contact.periodic:
        return
    touching, (rows, columns), (nx, ny) = state.box_touching, state.box, state.contact.grid.nodes
    if (
        (rows.start == 0 and touching[:1].any())
        or (rows.stop == nx and touching[-1:].any())
        or (columns.start == 0 and touching[:, :1].any())
        or (columns.stop == ny and touching[:, -1:].any())
    ):
        raise EdgeReachedError(edge_reached(state.contact, state.indentation))


def edge_reached(contact: Contact, indentation: float) -> EdgeReached:
    provenance, size = contact.surface.provenance, contact.grid.size
    touch, levelling, scan = first_touch(contact), None, None
    if provenance.get("source") == "measured":
        wide, long = size
        levelling = str(provenance.get("levelling"))
        scan = float(provenance.get("size_x_m", wide)), float(provenance.get("size_y_m", long))
    return EdgeReached(
        indentation=indentation,
        size=size,
        needed=needed_edges(contact, indentation),
        first_touch=touch,
        off_centre=max(abs(x) / w for x, w in zip(touch, size, strict=True)) > _OFF_CENTRE,
        levelling=levelling,
        scan=scan,
    )


def edge_predicted(contact: Contact, indentation: float, gap: float) -> EdgePredicted:
    return EdgePredicted(**vars(edge_reached(contact, indentation)), gap=gap)


def first_touch(contact: Contact) -> tuple[float, float]:
    """Coordinates x and y of the smallest gap (m), where the bodies touch first."""
    i, j = np.unravel_index(int(contact.gap.argmin()), contact.gap.shape)
    return float(contact.grid.x[i]), float(contact.grid.y[j])


def largest_reach(contact: Contact, indentation: float) -> float:
    """Distance (m) from the centre within which all contact at `indentation` (m) lies.

    Contact is possible only where the initial gap r²/(2R*) − z − c is below the indentation δ, so
    only for r² < 2R*(δ + z_max + c). The constant c makes the smallest gap 0.
    """
    R, x, y = contact.pair.radius, contact.grid.x[:, None], contact.grid.y[None, :]
    height = contact.surface.height
    shift = float(((x * x + y * y) / (2 * R) - height).min())
    # With adhesion, bodies touch at a negative indentation, too.
    return math.sqrt(2 * R * max(indentation + float(height.max()) + shift, 0.0))


def needed_edges(contact: Contact, indentation: float) -> tuple[float, float]:
    """Edge lengths (m) of a grid that contains the contact; at least those of the present grid."""
    wide, long = contact.grid.size
    # The contact reaches the edge of the grid or is expected to reach it. So a larger grid is
    # recommended even if the present grid is already wider than the largest contact.
    needed = max(2 * largest_reach(contact, indentation), min(wide, long)) * MARGIN
    return max(wide, needed), max(long, needed)
