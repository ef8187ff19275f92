"""Checks that the grid is large enough for a contact and fine enough to resolve it.

Before a solve, the contact is predicted from smooth spheres. The functions with `unresolved` in
their names use the results of a run.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from restitution.contact.bodies import Pair
from restitution.contact.checks.findings import (
    AdhesionUnresolved,
    ContactBeyondGrid,
    FewNodes,
    Finding,
    FinerThanScan,
    NoHalfSpace,
    PatchesUnresolved,
    PixelAboveContact,
)
from restitution.contact.contact import Contact
from restitution.contact.interface import interface_of
from restitution.contact.state import State
from restitution.numerics.box import widen
from restitution.theory import JKR, FirstYield, Hertz

# Recommended smallest number of nodes per contact radius. With eight nodes per contact radius at
# first yield, COR, force and work of smooth spheres are within 0.3 % of the reference values
# (docs/method.md).
NODES_PER_RADIUS = 8
# If half of the contact area of rough bodies is in patches of at least 20 nodes, COR deviates from
# its value on the finest grid by 2 % (rms) and by at most 5 % (docs/resolution.md).
NODES_PER_PATCH = 20
# A grid spacing counts as finer than the pixel of a scan if it is smaller by more than this
# fraction.
_NEARLY_EQUAL = 0.01
_HALF_SPACE = 0.2  # ratio of contact radius to R* above which the half-space approximation fails


def predicted_radius(pair: Pair, indentation: float, yield_pressure: float = math.inf) -> float:
    """Contact radius (m) of smooth bodies: sqrt(R*δ) if elastic, sqrt(2R*δ) if fully plastic.

    `yield_pressure` (Pa) is that of a fully plastic contact.
    """
    R = pair.radius
    yielded = math.inf
    if math.isfinite(yield_pressure):
        yielded = float(FirstYield(R, pair.contact_modulus, yield_pressure).indentation)
    # Between first yield and the fully plastic limit, the area divided by πR*δ grows from 1 to 2.
    fullness = 1.0 if indentation <= yielded else 2.0 - (yielded / indentation) ** 0.25
    return float(Hertz(fullness * R, pair.contact_modulus).contact_radius(indentation))


def adhesive_spacing(state: State) -> float:
    """Largest cell size (m) that resolves the adhesion of the asperities in contact, or inf."""
    return interface_of(state.contact).needed_spacing(state)


def resolves_adhesion(state: State) -> bool:
    return max(state.contact.grid.spacing) <= adhesive_spacing(state)


def resolves_contact(state: State) -> bool:
    return resolves(median_patch(state.patch_sizes())) and resolves_adhesion(state)


def tabor_parameter(state: State) -> float:
    contact, adhesion = state.contact, interface_of(state.contact)
    radius, E_star = radius_of_asperities(state), contact.pair.contact_modulus
    asperity = JKR(radius, E_star, adhesion.work_of_adhesion)
    return float(asperity.tabor_parameter(adhesion.equilibrium_separation))


def radius_of_asperities(state: State) -> float:
    """Radius of curvature (m) of the undeformed asperities in contact, at most R*."""
    contact, box = state.contact, state.box
    hx, hy = contact.grid.spacing
    around = widen(box, 1, contact.grid.nodes)
    missing = [
        (1 - (inner.start - outer.start), 1 - (outer.stop - inner.stop))
        for outer, inner in zip(around, box, strict=True)
    ]
    gap = np.pad(contact.gap[around], missing, mode="reflect", reflect_type="odd")
    laplacian = np.diff(gap[:, 1:-1], 2, axis=0) / hx**2
    laplacian = laplacian + np.diff(gap[1:-1, :], 2, axis=1) / hy**2
    touching = state.box_touching
    curvature = 0.5 * float(laplacian[touching].mean()) if touching.any() else 0.0
    return min(1 / curvature if curvature > 0 else math.inf, contact.pair.radius)


def coarse_scan(contact: Contact, indentation: float) -> Finding | None:
    """Return a finding if a pixel of a scan, or the grid spacing, exceeds the contact radius."""
    provenance = contact.surface.provenance
    if "file" not in provenance:
        return None
    pixel = max(_coarsest_pixel(contact), *contact.grid.spacing)
    radius = predicted_radius(contact.pair, indentation, contact.hardness)
    if radius >= pixel:
        return None
    return PixelAboveContact(str(provenance["file"]), pixel, radius, indentation)


def resolution_findings(contact: Contact, indentation: float) -> list[Finding]:
    """Compare the grid with the contact radius of the smooth bodies at `indentation` (m)."""
    grid, pair = contact.grid, contact.pair
    radius = predicted_radius(pair, indentation, contact.hardness)
    pixel = _coarsest_pixel(contact)
    half_width, coarsest = 0.5 * min(grid.size), max(pixel, *grid.spacing)
    # A refined grid is meant to be finer than the pixel.
    finest = min(grid.spacing) * float(contact.surface.provenance.get("refined", 1))
    scan = grid_of_a_scan(contact)
    checks = (
        (radius >= half_width, ContactBeyondGrid(radius, indentation, half_width, scan)),
        (radius < NODES_PER_RADIUS * coarsest, FewNodes(coarsest, radius, NODES_PER_RADIUS)),
        (radius > _HALF_SPACE * pair.radius, NoHalfSpace(radius, pair.radius, _HALF_SPACE)),
        (finest < (1 - _NEARLY_EQUAL) * pixel, FinerThanScan(finest, pixel)),
    )
    return [finding for applies, finding in checks if applies]


def median_patch(patches: NDArray[np.int64]) -> int:
    """Half of all contact nodes are in `patches` (`State.patch_sizes`) of at least this size."""
    if patches.size == 0:
        return 0
    covered = np.cumsum(patches)
    return int(patches[np.searchsorted(2 * covered, covered[-1])])


def resolves(median_patch_nodes: float) -> bool:
    return median_patch_nodes >= NODES_PER_PATCH


def unresolved_patches(
    depths: Sequence[float], median_patches: Sequence[float]
) -> list[PatchesUnresolved]:
    """Return a finding if patches have too few nodes at some `depths` (m)."""
    few = [depth for depth, n in zip(depths, median_patches, strict=True) if not resolves(n)]
    if not few:
        return []
    return [PatchesUnresolved(len(few), len(depths), max(few), NODES_PER_PATCH)]


def unresolved_adhesion(
    depths: Sequence[float], spacings: Sequence[float], needed: Sequence[float], unrefined: float
) -> list[AdhesionUnresolved]:
    """Return a finding if the cell sizes `spacings` (m) at some `depths` (m) are above `needed`.

    `unrefined` is the cell size (m) before refinement.
    """
    rows = list(zip(depths, spacings, needed, strict=True))
    few = [row for row in rows if row[1] > row[2]]
    if not few:
        return []
    finest = min(fine for _, _, fine in few)
    return [
        AdhesionUnresolved(
            few=len(few),
            depths=len(rows),
            first=few[0][0],
            last=few[-1][0],
            spacing=min(h for _, h, _ in few),
            needed=finest,
            refine=divisions(unrefined, finest),
        )
    ]


def divisions(spacing: float, needed: float) -> int:
    """The smallest power of two that divides cells of `spacing` into cells of `needed` or less."""
    return int(2 ** max(math.ceil(math.log2(spacing / needed) - 1e-9), 0))


def grid_of_a_scan(contact: Contact) -> bool:
    """Whether the grid covers a whole scan, so that only a larger scan allows a larger grid."""
    provenance = contact.surface.provenance
    if provenance.get("source") != "measured":
        return False
    edges = zip("xy", contact.grid.size, strict=True)
    return all(edge > 0.9 * float(provenance.get(f"size_{a}_m", 0.0)) for a, edge in edges)


def _coarsest_pixel(contact: Contact) -> float:
    return max(float(contact.surface.provenance.get(f"pixel_{a}_m", 0.0)) for a in "xy")
