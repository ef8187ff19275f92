"""Error of the pull-off force that the steps and the neglected range of attraction cause."""

from __future__ import annotations

import math

from restitution.contact.checks.resolution import radius_of_asperities
from restitution.contact.state import State
from restitution.theory import JKR, MaugisDugdale

_STEPS = 0.02  # relative error due to the steps of unloading around the largest tension
# Traction of the Maugis-Dugdale law, in units of w/z₀, with the pull-off force of Lennard-Jones
# (docs/adhesion.md).
_TRACTION = 0.548


def pull_off_error(state: State, pull_off_force: float) -> float:
    """Error (N) of `pull_off_force` after loading to `state`, without that of grid and surface.

    In the JKR limit it includes the difference of Maugis' pull-off force (1992) at the asperities
    in contact from that of JKR.
    """
    contact = state.contact
    if not contact.adhesive or math.isnan(pull_off_force):
        return 0.0 if not contact.adhesive else math.nan
    parts = [_STEPS]
    if not contact.cohesive:
        radius, w = radius_of_asperities(state), contact.work_of_adhesion
        E_star = contact.pair.contact_modulus
        traction = _TRACTION * w / contact.equilibrium_separation
        maugis = float(MaugisDugdale(radius, E_star, w, traction).pull_off_force)
        parts.append(maugis / float(JKR(radius, E_star, w).pull_off_force) - 1)
    return math.hypot(*parts) * pull_off_force
