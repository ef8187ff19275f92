"""Quantities computed from a case without solving the contact."""

from __future__ import annotations

import math

from restitution.case.case import Case
from restitution.contact.checks.resolution import predicted_radius
from restitution.contact.contact import Contact
from restitution.theory import JKR, FirstYield


def deepest_indentation(case: Case) -> float:
    """The deepest indentation (m), by `Case.indentation_at`."""
    return case.indentation_at(case.depths()[-1])


def derived_quantities(case: Case, contact: Contact) -> dict[str, float | None]:
    """The derived quantities of `summary.json`, by name and SI unit; None if one does not apply."""
    pair, yields = contact.pair, contact.plasticity.of_smooth(contact.pair)
    p_y = yields.hardness
    if contact.periodic:
        return _of_period(contact)
    deepest = deepest_indentation(case)
    radius = predicted_radius(pair, deepest, p_y)
    elastic = math.isinf(p_y)
    mass = pair.mass
    first = (
        None
        if elastic
        else FirstYield(pair.radius, pair.contact_modulus, yields.first_yield_pressure(pair))
    )
    return {
        "reduced_radius_m": pair.radius,
        "contact_modulus_Pa": pair.contact_modulus,
        "reduced_mass_kg": mass,
        "yield_strength_Pa": getattr(contact.plasticity, "yield_strength", None),
        "yield_pressure_Pa": None if elastic else p_y,
        "yield_indentation_m": None if first is None else float(first.indentation),
        "yield_force_N": None if first is None else float(first.force),
        "yield_velocity_m_per_s": (
            None if first is None or mass is None else float(first.velocity(mass))
        ),
        **_adhesion(case, contact),
        "deepest_indentation_m": deepest,
        "predicted_contact_radius_m": radius,
        "nodes_over_contact_radius": radius / max(contact.grid.spacing),
        "domain_half_width_m": 0.5 * min(contact.grid.size),
    }


def _of_period(contact: Contact) -> dict[str, float | None]:
    """For a periodic contact; `reduced_pressure_Pa` is E* times the rms slope."""
    elastic, (wide, long) = math.isinf(contact.hardness), contact.grid.size
    adhesion = contact.adhesion
    return {
        "contact_modulus_Pa": contact.pair.contact_modulus,
        "yield_pressure_Pa": None if elastic else contact.hardness,
        "rms_slope": contact.slope,
        "reduced_pressure_Pa": contact.pair.contact_modulus * contact.slope,
        "mean_gap_at_first_touch_m": float(contact.gap.mean()),
        "nominal_area_m2": wide * long,
        **({} if adhesion is None else {"work_of_adhesion_J_per_m2": adhesion.work_of_adhesion}),
    }


def _adhesion(case: Case, contact: Contact) -> dict[str, float | None]:
    adhesion = contact.adhesion
    if adhesion is None or not adhesion.attracts:
        return {}
    pair, w = contact.pair, adhesion.work_of_adhesion
    smooth = JKR(pair.radius, pair.contact_modulus, w)
    a_c = float(smooth.pull_off_radius)
    return {
        "work_of_adhesion_J_per_m2": w,
        "pull_off_force_smooth_N": float(smooth.pull_off_force),
        "pull_off_radius_m": a_c,
        "nodes_over_pull_off_radius": a_c / max(contact.grid.spacing),
        "expected_pull_off_error": adhesion.expected_pull_off_error(contact),
        "tabor_parameter": float(smooth.tabor_parameter(case.interface.equilibrium_separation)),
        "sticking_velocity_m_per_s": (
            None if pair.mass is None else float(smooth.sticking_velocity(pair.mass))
        ),
    }
