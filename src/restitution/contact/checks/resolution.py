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
from restitution.contact.checks.finding import Finding
from restitution.contact.cohesive.equilibrium import needed_spacing
from restitution.contact.contact import Contact
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
# With four or more nodes per pull-off radius and `crack-closure`, the pull-off force of smooth
# spheres is within 2.3 % of JKR. This held for all tested positions of the apex relative to the
# nodes (docs/adhesion.md).
ADHESIVE_NODES = 4
# With `cohesive`, cells up to this fraction of sqrt(r z0) at asperities of radius r change the
# pull-off force by at most 1.5 % (docs/adhesion.md).
_COARSEST_ON_ASPERITIES = 0.5
# Relative error of the pull-off force of a cohesive contact if the grid resolves the range of the
# attraction.
_COHESIVE_PULL_OFF = 0.01
# A grid spacing counts as finer than the pixel of a scan if it is smaller by more than this
# fraction.
_NEARLY_EQUAL = 0.01
_HALF_SPACE = 0.2  # ratio of contact radius to R* above which the half-space approximation fails


def predicted_radius(pair: Pair, indentation: float, yield_pressure: float = math.inf) -> float:
    """Contact radius (m) of smooth bodies: sqrt(R*δ) if elastic, sqrt(2R*δ) if fully plastic.

    δ is the `indentation` (m), R* the reduced radius (m), and `yield_pressure` (Pa) the pressure of
    a fully plastic contact.
    """
    R = pair.radius
    yielded = math.inf
    if math.isfinite(yield_pressure):
        yielded = float(FirstYield(R, pair.contact_modulus, yield_pressure).indentation)
    # Between first yield and the fully plastic limit, the area divided by πR*δ grows from 1 to 2.
    fullness = 1.0 if indentation <= yielded else 2.0 - (yielded / indentation) ** 0.25
    return float(Hertz(fullness * R, pair.contact_modulus).contact_radius(indentation))


def adhesive_nodes(state: State) -> float:
    """Nodes per pull-off radius of an asperity with `adhesion = "jkr"`; inf otherwise."""
    contact = state.contact
    if not contact.adhesive or contact.cohesive:
        return math.inf
    return pull_off_radius(contact, radius_of_asperities(state)) / max(contact.grid.spacing)


def adhesive_spacing(state: State) -> float:
    """Largest cell size (m) that resolves the adhesion of the asperities in contact.

    With `jkr` it is a quarter of the contact radius at pull-off (`pull_off_radius`) of a sphere of
    radius r = `radius_of_asperities`. With `cohesive` it is `needed_spacing`, but at most
    0.5 sqrt(r z0). It is inf without adhesion.
    """
    contact = state.contact
    if not contact.adhesive:
        return math.inf
    radius = radius_of_asperities(state)
    if contact.cohesive:
        reach = _COARSEST_ON_ASPERITIES * math.sqrt(radius * contact.equilibrium_separation)
        return min(needed_spacing(contact), reach)
    return pull_off_radius(contact, radius) / ADHESIVE_NODES


def resolves_adhesion(state: State) -> bool:
    """Whether the grid resolves the adhesion of the asperities in contact."""
    return max(state.contact.grid.spacing) <= adhesive_spacing(state)


def resolves_contact(state: State) -> bool:
    """Whether the grid resolves the contact: the patches, and adhesion at their asperities."""
    return resolves(median_patch(state.patch_sizes())) and resolves_adhesion(state)


def tabor_parameter(state: State) -> float:
    """Tabor parameter µ of the contact, for spheres of radius `radius_of_asperities`."""
    contact = state.contact
    asperity = JKR(
        radius_of_asperities(state), contact.pair.contact_modulus, contact.work_of_adhesion
    )
    return float(asperity.tabor_parameter(contact.equilibrium_separation))


def radius_of_asperities(state: State) -> float:
    """Radius of curvature (m) of the asperities in contact.

    The curvature of the undeformed gap is averaged over the nodes in contact. The radius is the
    inverse of this average, but at most R*, the value for smooth spheres.
    """
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


def pull_off_radius(contact: Contact, radius: float) -> float:
    """Contact radius a_c (m) at pull-off of a sphere of reduced radius `radius` (m), after JKR."""
    sphere = JKR(radius, contact.pair.contact_modulus, contact.work_of_adhesion)
    return float(sphere.pull_off_radius)


def expected_pull_off_error(contact: Contact) -> float:
    """Expected relative error of the pull-off force of smooth spheres on this grid.

    See docs/adhesion.md.
    """
    if contact.cohesive:
        return _COHESIVE_PULL_OFF
    nodes = pull_off_radius(contact, contact.pair.radius) / max(contact.grid.spacing)
    return {"pohrt-popov": 1.5, "crack-closure": 0.25}[contact.detachment] / nodes


def coarse_scan(contact: Contact, indentation: float) -> Finding | None:
    """Return the finding `pixel-above-contact` if a pixel of a scan exceeds the contact radius.

    The values of the finding are the `file`, the `indentation` (m), the contact `radius` (m) at
    this indentation, and `pixel` (m). If the grid spacing is larger than the longest edge of a
    pixel, `pixel` is the grid spacing instead.
    """
    provenance = contact.surface.provenance
    if "file" not in provenance:
        return None
    pixel = max(_coarsest_pixel(contact), *contact.grid.spacing)
    radius = predicted_radius(contact.pair, indentation, contact.hardness)
    if radius >= pixel:
        return None
    return Finding(
        "pixel-above-contact",
        {
            "file": provenance["file"],
            "pixel": pixel,
            "radius": radius,
            "indentation": indentation,
        },
    )


def resolution_findings(contact: Contact, indentation: float) -> list[Finding]:
    """Compare the grid with the contact radius of the smooth bodies at `indentation` (m).

    The findings and their values are:

    * `contact-beyond-grid`: `radius`, `indentation`, `half_width` of the grid (m), and
      `whole_scan`, whether the grid covers a whole scan;
    * `few-nodes`: `radius` (m), and `spacing` (m), the larger one of grid spacing and pixel;
    * `no-half-space`: `radius`, `reduced_radius` (m), and the `limit` of their ratio;
    * `finer-than-scan`: `spacing` before refinement, `pixel` (m).
    """
    grid, pair = contact.grid, contact.pair
    radius = predicted_radius(pair, indentation, contact.hardness)
    pixel = _coarsest_pixel(contact)
    half_width, coarsest = 0.5 * min(grid.size), max(pixel, *grid.spacing)
    beyond_grid = {
        "radius": radius,
        "indentation": indentation,
        "half_width": half_width,
        "whole_scan": grid_of_a_scan(contact),
    }
    half_space = {"radius": radius, "reduced_radius": pair.radius, "limit": _HALF_SPACE}
    # A refined grid is meant to be finer than the pixel.
    finest = min(grid.spacing) * float(contact.surface.provenance.get("refined", 1))
    checks = (
        (radius >= half_width, Finding("contact-beyond-grid", beyond_grid)),
        (
            radius < NODES_PER_RADIUS * coarsest,
            Finding("few-nodes", {"spacing": coarsest, "radius": radius}),
        ),
        (radius > _HALF_SPACE * pair.radius, Finding("no-half-space", half_space)),
        (
            finest < (1 - _NEARLY_EQUAL) * pixel,
            Finding("finer-than-scan", {"spacing": finest, "pixel": pixel}),
        ),
    )
    return [finding for found, finding in checks if found]


def median_patch(patches: NDArray[np.int64]) -> int:
    """Median patch size (nodes): half of all contact nodes are in patches of at least this size.

    `patches` are the sizes (nodes) from `State.patch_sizes`, largest first.
    """
    if patches.size == 0:
        return 0
    covered = np.cumsum(patches)
    return int(patches[np.searchsorted(2 * covered, covered[-1])])


def resolves(median_patch_nodes: float) -> bool:
    """Whether a contact with this result of `median_patch` has enough nodes per patch."""
    return median_patch_nodes >= NODES_PER_PATCH


def unresolved_patches(depths: Sequence[float], median_patches: Sequence[float]) -> list[Finding]:
    """Return the finding `patches-unresolved` if patches have too few nodes at some `depths` (m).

    `median_patches` are the results of `median_patch` at the depths. The values of the finding are
    `few`, the number of depths with too few nodes; `depths`, the number of all depths; and
    `deepest`, the deepest depth (m) with too few nodes.
    """
    few = [depth for depth, n in zip(depths, median_patches, strict=True) if not resolves(n)]
    if not few:
        return []
    return [
        Finding("patches-unresolved", {"few": len(few), "depths": len(depths), "deepest": max(few)})
    ]


def unresolved_adhesion(
    depths: Sequence[float], spacings: Sequence[float], needed: Sequence[float], unrefined: float
) -> list[Finding]:
    """Return the finding `adhesion-unresolved` if cells are too large for the adhesion.

    `spacings` are the cell sizes (m) at the `depths` (m), `needed` the results of
    `adhesive_spacing`, and `unrefined` is the cell size (m) before refinement. The values of the
    finding are `few`, the number of depths with too large cells; `depths`, the number of all
    depths; `from` and `to`, the range of the former (m); `spacing` and `needed`, the smallest
    present and needed cell size there (m); and `refine`, the power of two that divides the cells
    enough.
    """
    rows = list(zip(depths, spacings, needed, strict=True))
    few = [row for row in rows if row[1] > row[2]]
    if not few:
        return []
    finest = min(fine for _, _, fine in few)
    return [
        Finding(
            "adhesion-unresolved",
            {
                "few": len(few),
                "depths": len(rows),
                "from": few[0][0],
                "to": few[-1][0],
                "spacing": min(h for _, h, _ in few),
                "needed": finest,
                "refine": divisions(unrefined, finest),
            },
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
    """The longest edge of a pixel (m) of the scan; 0 for a surface without pixels."""
    return max(float(contact.surface.provenance.get(f"pixel_{a}_m", 0.0)) for a in "xy")
