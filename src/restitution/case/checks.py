"""Checks of the keys of a case that concern several of its tables."""

from __future__ import annotations

import math

from restitution.case.generated import GeneratedRoughness
from restitution.case.impacts import ImpactsTable
from restitution.case.measured import MeasuredRoughness
from restitution.case.schema import ImpactTable
from restitution.case.tables import DEPTHS, CaseTables


def check_tables(case: CaseTables) -> None:
    """Raise `ValueError` if tables or keys of `case` do not fit each other."""
    given = [name for name in DEPTHS if getattr(case, name) is not None]
    if len(given) != 1:
        which = f"[{'] and ['.join(given)}]" if given else "none of them"
        raise ValueError(
            "give one of the tables [indentation], [load], [impact] and [pressure]; this case "
            f"has {which}"
        )
    if case.periodic:
        _check_period(case)
    elif case.pressure is not None:
        raise ValueError(
            "[pressure] is the nominal pressure of a periodic contact: add periodic = true to "
            "[grid], or give [load]"
        )
    if case.impact is not None:
        _check_masses(case)
        if case.impact.oblique:
            _check_oblique(case, case.impact)
    elastic = math.isinf(case.yielding().hardness)
    if case.interface.plasticity == "truncated" and elastic:
        raise ValueError(
            'interface.plasticity = "truncated" needs a yield_pressure, which is "elastic" '
            "here; give a pressure, or remove plasticity"
        )
    if case.grid.nodes is None:
        _check_scan_brings_grid(case)
    factors, depths = len(case.factors()), len(case.depths())
    if factors != depths:
        raise ValueError(
            f'grid.refine: {factors} values for {depths} depths; give one for each depth, or "auto"'
        )
    for name in ("realisations", "below_grid", "split"):
        if len({getattr(part, name) for part in case.roughness} - {1, None}) > 1:
            raise ValueError(
                f"roughness.{name}: differs between the tables; give the same value in all"
            )
    if case.impacts is not None:
        _check_impacts(case, case.impacts)


def _check_impacts(case: CaseTables, impacts: ImpactsTable) -> None:
    if case.impact is None:
        raise ValueError(
            "[impacts]: needs [impact], whose velocities are those at which COR is measured"
        )
    if not isinstance(case.grid.refine, int):
        raise ValueError("grid.refine: must be one number with [impacts]")
    if case.realisations > 1:
        raise ValueError(
            "roughness.realisations: must be 1 with [impacts], which measures COR at many "
            "places; remove this key"
        )
    named, tables = len(impacts.rough or [""]), len(case.roughness)
    if named > 1 and named != tables:
        raise ValueError(
            f"impacts.rough: names {named} bodies for {tables} tables [[roughness]]; give one for "
            'each table, or "both"'
        )
    for part in case.roughness:
        if isinstance(part, GeneratedRoughness) and not part.periodic:
            raise ValueError(
                "roughness.periodic: must be true with [impacts], because the surface repeats "
                "beyond its edges; remove this key"
            )
    if case.interface.plasticity == "truncated":
        raise ValueError(
            'interface.plasticity: "truncated" defines a single impact; remove this key to use '
            "[impacts]"
        )
    if impacts.place == "track" and all(body.radius for body in case.bodies().values()):
        raise ValueError(
            'impacts.place: "track" needs a wall; give second.radius = "flat", or place = "random"'
        )
    if (grid := case.grid.grid()) is not None:
        pair = case.pair()
        hardness = case.yielding().model.of_smooth(pair).hardness
        impacts.require_possible(grid, case.impact.series(), pair, hardness)


def _check_period(case: CaseTables) -> None:
    for name, body in case.bodies().items():
        if body.radius is not None:
            raise ValueError(f'{name}.radius: must be "flat" if the grid is periodic')
        for loss in ("thickness", "loss_tangent", "relaxation_time"):
            if getattr(body, loss) is not None:
                raise ValueError(
                    f"{name}.{loss}: acts in impacts only, and a periodic contact has none; "
                    "remove it"
                )
    if case.impacts is not None:
        raise ValueError("[impacts]: a periodic contact has no impacts; remove this table")
    if case.impact is not None:
        raise ValueError(
            "[impact]: the bodies of a periodic contact have infinite mass; give "
            "[indentation], [load] or [pressure]"
        )
    if "unloading" in case.model_fields_set:
        raise ValueError(
            "[unloading]: a periodic case writes no unloading curves; remove this table"
        )
    _check_attraction(case)
    yielding = case.yielding()
    if yielding.plasticity != "equilibrium":
        raise ValueError(
            "interface.yield_pressure: a periodic contact needs a constant yield pressure "
            'and plasticity = "equilibrium"; set yield_pressure to a pressure, "2.8 Y", '
            '"hardness" or "elastic"'
        )
    if case.interface.size_effect and case.indentation is None:
        raise ValueError(
            "interface.size_effect: a periodic contact with a size effect needs [indentation], on "
            "which its yield pressure depends"
        )
    if not isinstance(case.grid.refine, int):
        raise ValueError("grid.refine: must be one number if the grid is periodic")
    if not case.roughness:
        raise ValueError(
            "roughness: is missing; smooth flat bodies touch everywhere, so add a table [roughness]"
        )
    if case.realisations > 1:
        raise ValueError("roughness.realisations: a periodic case has one surface; remove this key")
    for part in case.roughness:
        if isinstance(part, GeneratedRoughness) and not part.periodic:
            raise ValueError("roughness.periodic: must be true if the grid is periodic")
    highest = 0.0 if case.pressure is None else max(case.pressure.series())
    if highest >= yielding.hardness:
        raise ValueError(
            f"pressure: {1e-6 * highest:.4g} MPa is not below the yield pressure, "
            f"{1e-6 * yielding.hardness:.4g} MPa"
        )


def _check_attraction(case: CaseTables) -> None:
    if case.interface.adhesive_energy == 0:
        return
    if case.interface.adhesion == "jkr":
        raise ValueError(
            'interface.adhesion: "jkr" is not defined for a periodic contact; use "cohesive"'
        )
    if case.indentation is None:
        raise ValueError(
            "interface.work_of_adhesion: a periodic contact with adhesion needs [indentation], "
            "because the indentation would jump at some values of a prescribed load or pressure"
        )


def _check_masses(case: CaseTables) -> None:
    for name, body in case.bodies().items():
        if body.radius is not None and body.density is None:
            raise ValueError(
                f"{name}.density: is missing; give it, because [impact] needs the mass"
            )


def _check_oblique(case: CaseTables, impact: ImpactTable) -> None:
    key = "impact.spin" if impact.angle is None else "impact.angle"
    if case.interface.friction is None:
        raise ValueError(
            f"interface.friction: is missing; give it, because {key} needs a coefficient of "
            "friction"
        )
    if case.interface.adhesive_energy > 0:
        raise ValueError(
            f"{key}: oblique impacts are computed only for pairs without adhesion; remove "
            "this key, or interface.work_of_adhesion"
        )
    for (name, body), spin in zip(case.bodies().items(), impact.spins(), strict=True):
        if body.radius is None and spin != 0:
            raise ValueError(f'impact.spin: {name} is a wall and does not turn; give "0 rad/s"')


def _check_scan_brings_grid(case: CaseTables) -> None:
    if len(case.roughness) == 1 and isinstance(case.roughness[0], MeasuredRoughness):
        if case.roughness[0].extend is None:
            return
        why = "roughness.extend does not define the size of the grid"
    elif case.roughness:
        why = "only a single measured surface defines its own grid"
    else:
        why = "only a measured surface defines its own grid"
    if "grid" not in case.model_fields_set:
        raise ValueError(f"the table [grid] is missing; give nodes and spacing, because {why}")
    raise ValueError(f"grid: nodes and spacing are missing; give both, because {why}")
