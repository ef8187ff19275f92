"""What follows from a case before anything is solved."""

from __future__ import annotations

import math

from restitution.case.case import Case
from restitution.contact.contact import Contact
from restitution.contact.resolution import expected_pull_off_error, foreseen_radius
from restitution.theory import hertz, jkr, sticking, thornton_ning, yielding


def deepest_indentation(case: Case) -> float:
    """The deepest indentation, m.

    Under a prescribed load it is where smooth elastic bodies carry it; at a prescribed velocity,
    where it takes smooth bodies (Thornton and Ning's, if they yield).
    """
    last, pair = case.depths()[-1], case.pair()
    if case.indentation is not None:
        return last
    if case.load is not None:
        return float(hertz.indentation_from_force(last, pair.radius, pair.contact_modulus))
    assert pair.mass is not None  # Case._check_masses
    # As good as elastic: beyond any pressure of a contact.
    p_y = min(case.yielding().hardness, pair.contact_modulus)
    return float(
        thornton_ning.indentation_from_velocity(
            last, pair.radius, pair.contact_modulus, p_y, pair.mass
        )
    )


def derived_quantities(case: Case, contact: Contact) -> dict[str, float | None]:
    """R*, E*, m*, yield quantities and the foreseen contact, keyed with SI units; None: not so."""
    pair, p_y = contact.pair, contact.hardness
    deepest = deepest_indentation(case)
    radius = foreseen_radius(pair, deepest, p_y)
    elastic = math.isinf(p_y)
    mass = pair.mass
    arguments = (pair.radius, pair.contact_modulus, contact.first_yield_pressure)
    return {
        "reduced_radius_m": pair.radius,
        "contact_modulus_Pa": pair.contact_modulus,
        "reduced_mass_kg": mass,
        "yield_strength_Pa": contact.yield_strength if contact.grows else None,
        "yield_pressure_Pa": None if elastic else p_y,
        "yield_indentation_m": None if elastic else float(yielding.yield_indentation(*arguments)),
        "yield_force_N": None if elastic else float(yielding.yield_force(*arguments)),
        "yield_velocity_m_per_s": (
            None if elastic or mass is None else float(yielding.yield_velocity(*arguments, mass))
        ),
        **_adhesion(case, contact),
        "deepest_indentation_m": deepest,
        "foreseen_contact_radius_m": radius,
        "nodes_over_contact_radius": radius / max(contact.grid.spacing),
        "domain_half_width_m": 0.5 * min(contact.grid.size),
    }


def _adhesion(case: Case, contact: Contact) -> dict[str, float | None]:
    if not contact.adhesive:
        return {}
    pair, w = contact.pair, contact.work_of_adhesion
    arguments = (pair.radius, pair.contact_modulus, w)
    a_c = float(jkr.pull_off_radius(*arguments))
    return {
        "work_of_adhesion_J_per_m2": w,
        "pull_off_force_smooth_N": float(jkr.pull_off_force(pair.radius, w)),
        "pull_off_radius_m": a_c,
        "nodes_over_pull_off_radius": a_c / max(contact.grid.spacing),
        "expected_pull_off_error": expected_pull_off_error(contact),
        "tabor_parameter": float(
            sticking.tabor_parameter(*arguments, case.interface.equilibrium_separation)
        ),
        "sticking_velocity_m_per_s": (
            None if pair.mass is None else float(sticking.sticking_velocity(*arguments, pair.mass))
        ),
    }
