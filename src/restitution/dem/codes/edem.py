"""EDEM: tables of interactions and materials, to be typed into the panels of EDEM.

The tables were not tested in EDEM. EDEM's Hertz–Mindlin model has Tsuji's damping with the
coefficient of Antypov & Elliott (Altair's documentation). EDEM's hysteretic spring model is that of
Walton & Braun, with the loading stiffness K1 and the unloading stiffness K2. K1 is
5 R* min(Y1, Y2), where Y1 and Y2 are the yield strengths. The coefficient of restitution of this
model, (K1/K2)^½, is the same at every velocity. The coefficient of restitution of the exported law
depends on the velocity. So the exported K2 holds at one velocity only.
"""

from __future__ import annotations

import math

from restitution.dem.export_common import Export, commented, identifier, number
from restitution.dem.pair import ExportedPair, pull_off_force
from restitution.dem.pair_table import PairTable
from restitution.results.writer import table_text

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


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """Notes and the two tables; names and texts. Raises `DomainError`."""
    export = Export(table, velocity, CODE, 0.0, _ENDS)
    friction = f"{export.friction_note('#')}\n# Rolling friction 0 is a placeholder."
    ending = f"{export.ending('#')}\n".lstrip()
    comments = f"{export.head('#')}\n{commented(_NOTES, '#')}\n{friction}\n{ending}"
    return {
        INTERACTIONS: table_text([_interaction(pair) for pair in export.pairs]) + comments,
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
