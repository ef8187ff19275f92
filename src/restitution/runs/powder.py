"""Grid and velocities of a case for a fine adhesive powder that a desktop run resolves."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from string import Template
from typing import Any

from restitution.case.case import Case
from restitution.case.case_file import parse_case
from restitution.case.derived import deepest_indentation
from restitution.case.generated import GeneratedRoughness
from restitution.contact.checks.edge import MARGIN, largest_reach
from restitution.contact.checks.resolution import adhesive_spacing, divisions
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.errors import CaseError, DomainError
from restitution.runs.refinement import least_refined

_FASTEST = ("5 m/s", "2 m/s", "1 m/s", "0.5 m/s", "0.2 m/s", "0.1 m/s", "0.05 m/s", "0.02 m/s")
_DECADES = 1e-3  # the lowest velocity divided by the highest
_MOST_NODES = 1000  # along each axis, after refinement
_PROBE = 96  # nodes of the grid on which the asperities are measured
_PER_WAVE = 12  # its cells per correlation length


def powder_grid(template: str, values: Mapping[str, str]) -> dict[str, Any]:
    """Choose `nodes`, `spacing`, `slowest` and `fastest` for the other `values` of `template`.

    The cells resolve the adhesion of the asperities, and the highest velocity is the highest whose
    contact fits on an affordable grid. Raises `CaseError` if there is none.
    """

    def case(nodes: int, spacing: float, fastest: str) -> Case:
        text = Template(template).substitute(values, **_filled(nodes, spacing, fastest))
        return parse_case(text)

    probe = _length(case(_PROBE, 1e-9, _FASTEST[0])) / _PER_WAVE
    spacing = probe / divisions(probe, _needed(case(_PROBE, probe, _FASTEST[0])))
    for fastest in _FASTEST:
        shown = case(_PROBE, probe, fastest)
        edge = 2 * MARGIN * largest_reach(_contact(shown), deepest_indentation(shown))
        if edge / spacing <= _MOST_NODES:
            coarser = 2 * spacing  # `refine` halves these cells where that is needed
            return _filled(2 * math.ceil(0.5 * edge / coarser), coarser, fastest)
    raise CaseError(
        f"radius, rms: a grid of {_MOST_NODES} x {_MOST_NODES} nodes that resolves the adhesion of "
        f"the asperities (cells of {1e9 * spacing:.2g} nm) does not contain the contact at "
        f"{_FASTEST[-1]}; choose smoother or smaller particles, or a larger correlation length"
    )


def _filled(nodes: int, spacing: float, fastest: str) -> dict[str, Any]:
    number, unit = fastest.split()
    return {
        "nodes": nodes,
        "spacing": f"{1e9 * spacing:.3g} nm",
        "fastest": fastest,
        "slowest": f"{float(number) * _DECADES:g} {unit}",
    }


def _length(case: Case) -> float:
    (part,) = case.roughness
    assert isinstance(part, GeneratedRoughness)
    assert part.correlation_length is not None  # the template gives one
    return min(part.correlation_length)


def _contact(case: Case) -> Contact:
    return case.refined(1).contact(Path())


def _needed(case: Case) -> float:
    """Cell size (m) that resolves the adhesion of the asperities which touch first."""
    contact = least_refined(case, Path()).contact(Path())
    depth = 0.3 * float(contact.surface.height.std())
    try:
        return adhesive_spacing(solve(contact, depth))
    except DomainError as error:
        raise CaseError(f"rms: {error}") from None
