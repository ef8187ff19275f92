"""EDEM: tables of interactions and materials, to be typed into the panels of EDEM.

The tables were not tested in EDEM. EDEM's Hertz–Mindlin model has Tsuji's damping with the
coefficient of Antypov & Elliott (Altair's documentation). EDEM's hysteretic spring model is that of
Walton & Braun, with the loading stiffness K1 and the unloading stiffness K2. K1 is
5 R* min(Y1, Y2), where Y1 and Y2 are the yield strengths. The coefficient of restitution of this
model, (K1/K2)^½, is the same at every velocity. The coefficient of restitution of the exported law
depends on the velocity. So the exported K2 holds at one velocity only.

Adhesive pairs have two further models, fitted by the published formulas. Hertz-Mindlin with JKR V2
(Altair's documentation) begins at first touch and ends where the JKR spheres snap off, with the
damping of Hertz-Mindlin. EEPA (Thakur et al., Granular Matter 16 (2014) 383) has the loading
stiffness k1 = (4/3) E* R*^(1/2), a constant pull-off force f0, and k2 = k1/(1 - lambda_p).
"""

from __future__ import annotations

import math

import numpy as np

from restitution.dem.damped_adhesion import DampedAdhesion, fit_damping
from restitution.dem.export_common import NOT_RUN, Export
from restitution.dem.pair import ExportedPair, pull_off_force
from restitution.dem.pair_table import PairTable
from restitution.dem.text import commented, identifier, number
from restitution.laws.law import Array, Law
from restitution.results.writer import table_text
from restitution.theory import EEPA, JKR

CODE = "EDEM"
INTERACTIONS, MATERIALS = "restitution_edem.csv", "restitution_edem_materials.csv"
_ENDS = (
    "in Hertz-Mindlin the overlap is back to zero, according to its formulas (whether EDEM cuts "
    "off the tensile damping force earlier is not documented); in the hysteretic spring model the "
    "force is back to zero."
)
_NOTES = [
    "Tables to be typed into EDEM (not tested in EDEM): Interactions, and Bulk Material.",
    "hysteretic_*: the hysteretic spring model fitted to the law, with K2 at the velocity above;",
    "    its restitution is (K1/K2)^(1/2); EDEM computes K1 from the yield strength K1/(5 R*).",
    "    Empty if there is no such fit, or if the velocity is outside its fitted range.",
]
_ADHESIVE_NOTES = [
    "jkr_v2_*: Hertz-Mindlin with JKR V2, whose pull-off force (3/2) pi gamma R* is that above;",
    "    give jkr_v2_restitution as its coefficient of restitution. It sticks below the velocity",
    "    jkr_v2_sticks_below_m_per_s; above, e is off by up to jkr_v2_worst.",
    "eepa_*: EEPA with surface energy 0, slope and tensile exponent 1.5, and coefficient of",
    "    restitution 1 (no further damping); e is off by up to eepa_worst. f0 attracts.",
]
_LEAST = 0.01  # smallest coefficient of restitution that is offered for JKR V2
_NODES = 3000


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """Notes and the two tables; names and texts. Raises `DomainError`."""
    export = Export(table, velocity, CODE, 0.0, _ENDS, accuracy=NOT_RUN.format(CODE))
    friction = f"{export.friction_note('#')}\n# Rolling friction 0 is a placeholder."
    ending = f"{export.ending('#')}\n".lstrip()
    adhesive = any(pair.law.work_of_adhesion > 0 for pair in export.pairs)
    notes = [*_NOTES, *(_ADHESIVE_NOTES if adhesive else [])]
    comments = f"{export.head('#')}\n{commented(notes, '#')}\n{friction}\n{ending}"
    return {
        INTERACTIONS: table_text(
            [_interaction(pair) | (_sticky(pair) if adhesive else {}) for pair in export.pairs]
        )
        + comments,
        MATERIALS: table_text(_materials(table)) + comments,
    } | export.notes()


def _interaction(pair: ExportedPair) -> dict[str, str]:
    k1, k2 = _springs(pair)
    return {
        "material_1": identifier(pair.first, pair.i),
        "material_2": identifier(pair.second, pair.j),
        "coefficient_of_restitution": number(pair.restitution),
        "restitution_error": f"{pair.law.at(pair.velocity).error:.2g}",
        "pull_off_force_N": _cell(pull_off_force(pair.law, pair.velocity)),
        "coefficient_of_static_friction": number(pair.friction),
        "coefficient_of_rolling_friction": "0",
        "hysteretic_K1_N_per_m": _cell(k1),
        "hysteretic_K2_N_per_m": _cell(k2),
        "hysteretic_restitution": _cell(math.sqrt(k1 / k2)),
        "hysteretic_yield_strength_Pa": _cell(k1 / (5 * pair.law.radius)),
    }


def _sticky(pair: ExportedPair) -> dict[str, str]:
    """JKR V2 and EEPA for an adhesive pair; empty cells without adhesion."""
    law = pair.law
    force = pull_off_force(law, pair.velocity) if law.work_of_adhesion > 0 else math.nan
    names = (
        "jkr_v2_surface_energy_J_per_m2",
        "jkr_v2_restitution",
        "jkr_v2_sticks_below_m_per_s",
        "jkr_v2_worst",
        "eepa_f0_N",
        "eepa_plasticity_ratio",
        "eepa_worst",
    )
    if not force > 0:
        return dict.fromkeys(names, "")
    fit = fit_damping(jkr_v2(law, force), law, force)
    s = fit.strength
    ratio, worst = _eepa(law, force)
    values = (
        force / (1.5 * math.pi * law.radius),
        math.exp(-math.pi * s / math.sqrt(1 - s**2)),
        fit.sticks_below,
        fit.worst,
        -force,
        ratio,
        worst,
    )
    return {name: f"{value:.6g}" for name, value in zip(names, values, strict=True)}


def jkr_v2(law: Law, force: float) -> DampedAdhesion:
    """JKR with the pull-off force `force` (N) until the spheres snap off, and Tsuji's damping."""
    theory = JKR(law.radius, law.contact_modulus, force / (1.5 * math.pi * law.radius))
    least = float(theory.break_radius)
    top = 3 * max(float(law.column("indentation").max()), least**2 / law.radius)
    a = np.linspace(least, least + math.sqrt(2 * top * law.radius), _NODES)
    depth = np.asarray(theory.indentation_at_contact_radius(a))
    scale = 2 * math.sqrt(5 / 6 * 2 * law.contact_modulus * law.mass)
    return DampedAdhesion(
        depth,
        np.asarray(theory.force_at_contact_radius(a)),
        scale * (law.radius * np.maximum(depth, 0.0)) ** 0.25,
        -math.log(_LEAST) / math.hypot(math.log(_LEAST), math.pi),
    )


def _eepa(law: Law, force: float) -> tuple[float, float]:
    """The plasticity ratio λ_p closest to e(V), and the largest difference of e."""
    k1 = 4 / 3 * law.contact_modulus * math.sqrt(law.radius)
    V, e = law.column("velocity"), law.column("restitution")

    def off(ratio: float) -> Array:
        model = EEPA(k1, k1 / (1 - ratio), 0.0, -force, 1.5)
        return np.asarray(np.nan_to_num(model.restitution(V, law.mass)) - e)

    ratios = np.linspace(0, 0.99, 199)
    best = float(min(ratios.tolist(), key=lambda ratio: float(np.sum(off(ratio) ** 2))))
    return best, float(np.abs(off(best)).max())


def _springs(pair: ExportedPair) -> tuple[float, float]:
    """Stiffnesses K1 and K2 (N/m) of the fitted Walton–Braun law; NaN outside its range.

    K2 = k_u + S V (m* K1)^½ at the velocity V of the export.
    """
    fit = pair.fitted("walton-braun")
    if fit is None or not pair.law.fits_hold_at(pair.velocity):
        return math.nan, math.nan
    k1 = fit.parameters["loading_stiffness_N_per_m"]
    k_u = fit.parameters["unloading_stiffness_N_per_m"]
    hardening = fit.parameters.get("hardening_per_m", 0.0)
    return k1, k_u + hardening * pair.velocity * math.sqrt(pair.law.mass * k1)


def _materials(table: PairTable) -> list[dict[str, str]]:
    return [
        {
            "material": identifier(body, k),
            "poissons_ratio": number(body.poissons_ratio),
            "solids_density_kg_per_m3": _cell(body.density),
            "youngs_modulus_Pa": number(body.youngs_modulus),
            "shear_modulus_Pa": number(body.youngs_modulus / (2 * (1 + body.poissons_ratio))),
            "radius_m": _cell(body.radius),
        }
        for k, body in enumerate(table.particles, 1)
    ]


def _cell(value: float | None) -> str:
    return "" if value is None or math.isnan(value) else number(value)
