"""Solve the contact of a case at one of its depths."""

from __future__ import annotations

from restitution.case.case import Case
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.prescribed_force import solve_at_force
from restitution.contact.prescribed_velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.runs.messages import naming_keys


def load_to(case: Case, contact: Contact, depth: float, start: State | None = None) -> State:
    """Load `contact` to `depth`, one of `case.depths()`.

    Depending on the case, `depth` is an indentation (m), a force (N) or an impact velocity (m/s).
    `start` is the state at a shallower depth. Raises the errors of `solve`, `solve_at_force` or
    `solve_at_velocity`.
    """
    with naming_keys():
        if case.load is not None:
            return solve_at_force(contact, depth, start=start)
        if case.impact is not None:
            return solve_at_velocity(contact, depth, start=start)
        return solve(contact, depth, start=start)
