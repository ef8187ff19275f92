"""Messages for the findings of `contact.checks`, in terms of the keys of the case file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from restitution.case.schema import FACTORS
from restitution.contact.checks.edge import EdgeReachedError, edge_values, edges_in_words
from restitution.contact.checks.finding import Code, Finding
from restitution.contact.checks.inputs import doubtful, impossible
from restitution.contact.checks.resolution import (
    NODES_PER_PATCH,
    NODES_PER_RADIUS,
    divisions,
    predicted_radius,
)
from restitution.contact.checks.scans import scan_findings, too_steep
from restitution.contact.cohesive import needed_spacing
from restitution.contact.contact import Contact
from restitution.contact.model_error import hysteresis_ratio
from restitution.display import counted, quantity
from restitution.errors import (
    CaseError,
    DomainError,
    NotConvergedError,
    RestitutionError,
    SurfaceError,
)
from restitution.surfaces import Surface
from restitution.theory import JKR

_ERRORS: dict[Code, type[RestitutionError]] = {
    "roughness-above-radius": CaseError,
    "contact-beyond-radius": CaseError,
    "pixel-above-contact": SurfaceError,
    "range-unresolved": CaseError,
    "impossible-slope": SurfaceError,
    "spikes": SurfaceError,
}
# `no_range` divides the energy that adhesion dissipates between smooth bodies by the prediction of
# JKR for this energy. It warns only if the ratio is at most this value.
_NEARLY_JKR = 0.9
# A run will fail if the predicted contact radius is larger than this factor times half the width of
# the grid.
_FAR_BEYOND = 2.0
CLEANING = "roughness.outliers"  # key that removes spikes
_KEYS = {"force": "load", "velocity": "impact"}  # argument of a solver: key of the case file
# How to avoid a contact that is too large, for each table that prescribes the depths.
_STOPS = {
    "indentation": "stop at a smaller indentation",
    "load": "stop at a smaller load",
    "impact": "stop at a lower impact velocity",
}


def require_possible(contact: Contact, indentation: float) -> None:
    """Raise `CaseError` or `SurfaceError` if results at `indentation` (m) would be meaningless."""
    if (found := impossible(contact, indentation)) is not None:
        raise _ERRORS[found.code](message(found))


def input_warnings(
    contact: Contact, indentation: float, prescribed: str = "indentation"
) -> list[str]:
    """Return a warning for each doubtful property of `contact` loaded to `indentation` (m).

    `prescribed` is the table of the case file that prescribes the depths.
    """
    return [message(found, prescribed) for found in doubtful(contact, indentation)]


def surface_warnings(surface: Surface, reduced_radius: float = math.inf) -> list[str]:
    """Return a warning for each doubtful property of the heights of `surface`.

    `reduced_radius` is the reduced radius R* (m) of the bodies.
    """
    findings = scan_findings(surface, reduced_radius)
    steep = too_steep(surface)
    if steep is not None and steep.code == "impossible-slope":
        findings = [steep if found.code == "steep-surface" else found for found in findings]
    notice = surface.provenance.get("notice")
    return [*map(message, findings), *([] if notice is None else [str(notice)])]


def failure_at_edge(contact: Contact, indentation: float, prescribed: str) -> str | None:
    """Return a sentence which says that a run to `indentation` (m) will fail, or None otherwise.

    The run will fail if the predicted contact is far larger than the grid. `prescribed` is the
    table of the case file that prescribes the depths.
    """
    if contact.periodic:
        return None
    radius = predicted_radius(contact.pair, indentation, contact.hardness)
    if radius <= _FAR_BEYOND * min(contact.grid.size) / 2:
        return None
    advice = _edge_advice(Finding("edge-reached", edge_values(contact, indentation)), prescribed)
    return (
        "A run will fail at the deeper depths, because the contact will reach the edge of the "
        f"grid; {advice}."
    )


def no_range(contact: Contact) -> list[str]:
    """Return a warning if `contact` neglects the range of the attraction because of a coarse grid.

    The list is empty if no warning is needed.
    """
    if contact.cohesive:
        return []
    pair, w = contact.pair, contact.work_of_adhesion
    smooth = JKR(pair.radius, pair.contact_modulus, w)
    tabor = float(smooth.tabor_parameter(contact.equilibrium_separation))
    lost = hysteresis_ratio(tabor)
    if lost > _NEARLY_JKR:
        return []
    return [
        'interface.adhesion is not given, and the grid is too coarse for "cohesive" (it needs '
        f'a spacing of {_nm(needed_spacing(contact))}), so "jkr" is used, which neglects the range '
        f"of the attraction: smooth bodies with this Tabor parameter ({tabor:.2g}) dissipate "
        f"{lost:.2g} times the energy that JKR predicts and have {math.sqrt(lost):.2g} times its "
        "sticking velocity, and rough bodies dissipate even less; model_error includes this "
        "difference"
    ]


@contextmanager
def naming_keys(
    prescribed: str = "indentation", needed: Callable[[], tuple[float, float]] | None = None
) -> Iterator[None]:
    """Replace the names of arguments in errors of the solvers by keys of the case file.

    `prescribed` is the table of the case file that prescribes the depths. `needed` returns the edge
    lengths (m) of a grid that contains the deepest contact of the case. If the contact reaches the
    edge of the grid, the error recommends a grid that is at least as large.
    """
    try:
        yield
    except EdgeReachedError as error:
        found = error.finding
        if needed is not None:
            edges = tuple(map(max, found["needed"], needed()))
            found = Finding(found.code, {**found.values, "needed": edges})
        raise DomainError(message(found, prescribed)) from error
    except (DomainError, NotConvergedError) as error:
        if error.argument not in _KEYS:
            raise
        raise error.renamed(_KEYS) from error


def message(found: Finding, prescribed: str = "indentation") -> str:
    """Describe the finding `found` in one line that also says what to do.

    `prescribed` is the table of the case file that prescribes the depths.
    """
    match found.code:
        case "roughness-above-radius":
            return (
                f"radius: the particle of {1e6 * found['radius']:.4g} um is smaller than its "
                f"roughness, whose highest peak is {1e6 * found['peak']:.4g} um above the mean; "
                "check the units of the radius and of the roughness"
            )
        case "contact-beyond-radius":
            return (
                f"the contact is predicted to reach {1e6 * found['radius']:.4g} um from the centre "
                f"at an indentation of {_nm(found['indentation'])}, beyond R* = "
                f"{1e6 * found['reduced_radius']:.4g} um: stop earlier, or check the units of the "
                "depths and of the radius"
            )
        case "pixel-above-contact":
            return (
                f"{found['file']}: one pixel ({_um(found['pixel'])}) is larger than the contact "
                f"radius at the deepest indentation ({_um(found['radius'])} at "
                f"{_nm(found['indentation'])}), so the scan does not resolve this contact; use a "
                "finer scan, a larger particle or a deeper contact"
            )
        case "range-unresolved":
            times = divisions(found["spacing"], found["needed"])
            return (
                f"grid.spacing: cells of {_nm(found['spacing'])} are too coarse for the range of "
                f'the attraction; interface.adhesion = "cohesive" needs {_nm(found["needed"])} or '
                "less (0.3 times the smaller of E* z0^2/w and sqrt(R* z0), with the work of "
                f"adhesion w and the equilibrium separation z0): multiply grid.refine by {times}"
                + ("" if found["periodic"] else ', or set interface.adhesion = "jkr"')
            )
        case "edge-reached":
            wide, long = (1e6 * edge for edge in found["size"])
            return (
                f"the contact reaches the edge of the {wide:.4g} um x {long:.4g} um grid at an "
                f"indentation of {_nm(found['indentation'])}; {_edge_advice(found, prescribed)}"
            )
        case "edge-predicted":
            return (
                f"the contact is predicted to reach the edge of the grid: the gap there is "
                f"{_nm(found['gap'])} at first touch, and the deepest indentation is "
                f"{_nm(found['indentation'])}; {_edge_advice(found, prescribed)}"
            )
        case "contact-beyond-grid":
            larger = "a larger scan, roughness.extend" if found["whole_scan"] else "more nodes"
            return (
                f"the contact is predicted to reach {_um(found['radius'])} from the centre at an "
                f"indentation of {_nm(found['indentation'])}, but the grid ends at "
                f"{_um(found['half_width'])}: use {larger} or stop earlier"
            )
        case "few-nodes":
            return (
                f"the contact radius of the smooth bodies, {_um(found['radius'])} at the deepest "
                f"indentation, has only {found['radius'] / found['spacing']:.2g} nodes at the "
                f"spacing {_um(found['spacing'])} ({NODES_PER_RADIUS} are needed): use a finer "
                "grid or scan"
            )
        case "no-half-space":
            return (
                f"the contact radius {_um(found['radius'])} is "
                f"{found['radius'] / found['reduced_radius']:.4g} of R*: the half-space "
                f"approximation holds up to about {found['limit']} R* (a tenth of the radius of "
                "two equal spheres)"
            )
        case "finer-than-scan":
            return (
                f"the grid spacing {_um(found['spacing'])} is finer than the scan's pixel "
                f"{_um(found['pixel'])}: roughness below the pixel is missing; use a finer scan"
            )
        case "spikes":
            return (
                f"{found['file']}: {counted(found['count'], 'spike')} of up to "
                f"{quantity(found['height'], 'm')}: {CLEANING} = {found['threshold']:g} replaces "
                "spikes by their surroundings"
            )
        case "tilted-scan":
            remedy = '"curvature"' if found["curved"] else '"tilt" or "curvature"'
            return (
                f"{found['file']}: the scan is tilted (a plane explains {found['explained']:.0%} "
                f"of the variance of its heights): set roughness.detrend = {remedy}"
            )
        case "curved-scan":
            return _curved(found)
        case "impossible-slope":
            keys = "the unit of roughness.rms and the lengths of its waves"
            if found["file"]:
                keys = f"the unit of the heights in {found['file']} and roughness.size"
            return (
                f"roughness: the rms slope is {found['slope']:.3g}, and half-space theory means "
                f"nothing above {found['limit']:g} (real surfaces have slopes below 2): check "
                f"{keys}; heights in nm read as um are 1000 times too large"
            )
        case "steep-surface":
            return (
                f"the rms slope of the surface is {found['slope']:.2g}: half-space theory holds "
                f"for small slopes, below about {found['limit']}; check the units of the heights, "
                "or level or filter the surface"
            )
        case "unusual-yield-pressure":
            return (
                f"the yield pressure is {found['ratio']:.2g} of the contact modulus E*, and "
                f"usual values are {found['low']:g} to {found['high']:g}: check the units of "
                "yield_pressure and youngs_modulus"
            )
        case "oblong-pixels":
            return (
                f"{found['file']}: the pixels are {1e6 * found['x']:.4g} x {1e6 * found['y']:.4g} "
                "um, not square: if scan lines are missing in the file, the scan is stretched; "
                "check the size"
            )
        case "coarser-than-scan":
            return (
                f"the grid spacing {_um(found['spacing'])} is coarser than the scan's pixel "
                f"{_um(found['pixel'])} along {found['axis']}: waves shorter than "
                f"{_um(2 * found['spacing'])} are left out; to keep them, make cells as small as "
                "the pixel (grid.refine)"
            )
        case "surface-notice":
            return str(found["notice"])
        case "patches-unresolved":
            return (
                f"{found['few']} of {found['depths']} depths (up to {_nm(found['deepest'])}) are "
                "not resolved (resolved is false): half of their contact is in patches of fewer "
                f"than {NODES_PER_PATCH} nodes, and their results depend on the grid; refine the "
                "grid (grid.refine)"
            )
        case "adhesion-unresolved":
            return (
                f"adhesion is not resolved at {found['few']} of {found['depths']} depths "
                f"({_nm(found['from'])} to {_nm(found['to'])}; adhesion_resolved is false): cells "
                f"of {_nm(found['spacing'])} are too large for the adhesion of the asperities in "
                f"contact, which needs {_nm(found['needed'])} or less"
                + (
                    f"; set grid.refine = {found['refine']}"
                    if found["refine"] <= FACTORS[-1]
                    else ", finer than grid.refine allows; leave out short waves "
                    "(roughness.shortest), or use a smaller grid.spacing"
                )
            )


def _curved(found: Finding) -> str:
    """Message for a curved scan."""
    radius, whole = found["radius"], found["reduced_radius"]
    form = "hollow" if radius < 0 else "sphere"
    effect = (
        "only a part of it would touch a flat body"
        if math.isinf(whole)
        else f"this adds to the shape of the particles, which R* = {quantity(whole, 'm')} contains"
    )
    return (
        f"{found['file']}: the scan is curved like a {form} with a radius of "
        f"{quantity(abs(radius), 'm')} (which explains {found['explained']:.0%} of the variance of "
        f'its heights), and {effect}: set roughness.detrend = "curvature"'
    )


def _edge_advice(found: Finding, prescribed: str) -> str:
    """Advice on how to keep the contact inside the grid, for the end of a message."""
    x, y = found["first_touch"]
    where = (
        f"the bodies touch first at x = {1e6 * x:.3g} um, y = {1e6 * y:.3g} um, off the centre; "
        if found["off_centre"]
        else ""
    )
    size, scan = edges_in_words(found), found["scan"]
    if scan is None:
        return (
            f"{where}use a grid of about {size} (more grid.nodes or a larger grid.spacing) or "
            f"{_STOPS[prescribed]}"
        )
    detrend = {
        "tilt": 'roughness.detrend = "curvature", ',
        "curvature": "",
    }.get(found["levelling"], 'roughness.detrend = "tilt" or "curvature", ')
    if all(edge <= of for edge, of in zip(found["needed"], scan, strict=True)):
        larger = f"a grid of about {size} (the scan has {1e6 * scan[0]:.3g} x {1e6 * scan[1]:.3g})"
    else:
        larger = "a larger scan, roughness.extend"
    return f"{where}use {detrend}{larger}, a smaller radius, or {_STOPS[prescribed]}"


def _um(length: float) -> str:
    return f"{1e6 * length:.3g} um"


def _nm(length: float) -> str:
    return f"{1e9 * length:.4g} nm"
