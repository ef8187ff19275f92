"""What the checks of a contact say to the user of a case file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from restitution.contact.checks.edge import EdgeReachedError, edge_reached
from restitution.contact.checks.findings import ImpossibleSlope, SteepSurface
from restitution.contact.checks.inputs import doubtful, impossible
from restitution.contact.checks.resolution import predicted_radius
from restitution.contact.checks.scans import scan_findings, too_steep
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact
from restitution.contact.jkr.limit import JKRLimit, hysteresis_ratio
from restitution.display import quantity
from restitution.errors import DomainError, NotConvergedError
from restitution.surfaces import Surface
from restitution.theory import JKR

# `no_range` divides the energy that adhesion dissipates between smooth bodies by the prediction of
# JKR for this energy. It warns only if the ratio is at most this value.
_NEARLY_JKR = 0.9
# A run will fail if the predicted contact radius is larger than this factor times half the width of
# the grid.
_FAR_BEYOND = 2.0
_KEYS = {"force": "load", "velocity": "impact"}  # argument of a solver: key of the case file


def require_possible(contact: Contact, indentation: float) -> None:
    """Raise `CaseError` or `SurfaceError` if results at `indentation` (m) would be meaningless."""
    if (finding := impossible(contact, indentation)) is not None:
        raise finding.error(finding.text())


def input_warnings(
    contact: Contact, indentation: float, prescribed: str = "indentation"
) -> list[str]:
    """Warnings about doubtful properties of `contact` loaded to `indentation` (m).

    `prescribed` is the table of the case file that prescribes the depths.
    """
    return [finding.text(prescribed) for finding in doubtful(contact, indentation)]


def surface_warnings(surface: Surface, reduced_radius: float = math.inf) -> list[str]:
    """Warnings about doubtful heights of `surface` between bodies of the reduced radius R* (m)."""
    findings = scan_findings(surface, reduced_radius)
    steep = too_steep(surface)
    if isinstance(steep, ImpossibleSlope):
        findings = [steep if isinstance(one, SteepSurface) else one for one in findings]
    notice = surface.provenance.get("notice")
    return [finding.text() for finding in findings] + ([] if notice is None else [str(notice)])


def failure_at_edge(contact: Contact, indentation: float, prescribed: str) -> str | None:
    """Sentence which says that a run to `indentation` (m) will fail at the edge, or None."""
    if contact.periodic:
        return None
    radius = predicted_radius(contact.pair, indentation, contact.hardness)
    if radius <= _FAR_BEYOND * min(contact.grid.size) / 2:
        return None
    advice = edge_reached(contact, indentation).advice(prescribed)
    return (
        "A run will fail at the deeper depths, because the contact will reach the edge of the "
        f"grid; {advice}."
    )


def no_range(contact: Contact) -> list[str]:
    """Warn if `contact` neglects the range of the attraction because of a coarse grid."""
    adhesion, pair = contact.adhesion, contact.pair
    if not isinstance(adhesion, JKRLimit):
        return []
    w, z0 = adhesion.work_of_adhesion, adhesion.equilibrium_separation
    tabor = float(JKR(pair.radius, pair.contact_modulus, w).tabor_parameter(z0))
    lost = hysteresis_ratio(tabor)
    if lost > _NEARLY_JKR:
        return []
    needed = quantity(Cohesive(w, z0).coarsest_spacing(pair), "m")
    return [
        'interface.adhesion is not given, and the grid is too coarse for "cohesive" (it needs '
        f'a spacing of {needed}), so "jkr" is used, which neglects the range '
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
        finding = error.finding
        if needed is not None:
            wide, long = map(max, finding.needed, needed())
            finding = replace(finding, needed=(wide, long))
        raise DomainError(finding.text(prescribed)) from error
    except (DomainError, NotConvergedError) as error:
        if error.argument not in _KEYS:
            raise
        raise error.renamed(_KEYS) from error
