"""The columns of stored results: names, units, meanings and limits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.contact.checks.resolution import ADHESIVE_NODES, NODES_PER_PATCH


@dataclass(frozen=True)
class Column:
    """A column of `curve.csv`: its variable in `results.nc`, its unit, meaning and limits.

    A `flag` is true or false, and an `optional` cell may be empty. All other cells are finite
    numbers from `low` to `high`.
    """

    variable: str
    unit: str
    meaning: str
    low: float = -math.inf
    high: float = math.inf
    optional: bool = False
    flag: bool = False


COLUMNS = {
    "max_indentation_m": Column("indentation", "m", "maximum indentation"),
    "force_N": Column("force", "N", "normal force at maximum indentation"),
    "contact_area_m2": Column("contact_area", "m2", "real contact area", low=0.0),
    "stored_energy_J": Column(
        "stored_energy", "J", "elastic energy at maximum indentation", low=0.0
    ),
    "plastic_work_J": Column("plastic_work", "J", "work dissipated by yielding", low=0.0),
    "loading_work_J": Column("loading_work", "J", "work of loading"),
    "unloading_work_J": Column("unloading_work", "J", "work returned until separation"),
    "restitution": Column("restitution", "1", "coefficient of restitution", low=0.0, high=1.0),
    "impact_velocity_m_per_s": Column(
        "impact_velocity", "m s-1", "impact velocity for this indentation", optional=True, low=0.0
    ),
    "contact_nodes": Column("contact_nodes", "1", "nodes in contact", low=0.0),
    "contact_patches": Column(
        "contact_patches", "1", "contact patches (nodes joined by an edge)", low=0.0
    ),
    "largest_patch_nodes": Column(
        "largest_patch_nodes", "1", "nodes in the largest contact patch", low=0.0
    ),
    "residual": Column(
        "residual", "1", "largest violation of the contact conditions over indentation", low=0.0
    ),
    "convolutions": Column(
        "convolutions", "1", "convolutions that loading and unloading took", low=0.0
    ),
    "pull_off_force_N": Column(
        "pull_off_force", "N", "largest tension during unloading", optional=True
    ),
    "separation_indentation_m": Column(
        "separation_indentation", "m", "indentation at separation", optional=True
    ),
    "restitution_error": Column(
        "restitution_error", "1", "numerical error of the restitution", low=0.0
    ),
    "sticks": Column(
        "sticks", "1", "the pair does not separate: unloading returns no work", flag=True
    ),
    "adhesion_resolved": Column(
        "adhesion_resolved", "1", f"pull-off radius of at least {ADHESIVE_NODES} nodes", flag=True
    ),
    "median_patch_nodes": Column(
        "median_patch_nodes", "1", "nodes in the patch of the median contact node", low=0.0
    ),
    "resolved": Column(
        "resolved",
        "1",
        f"half of the contact in patches of {NODES_PER_PATCH} nodes or more",
        flag=True,
    ),
    "discretisation_error": Column(
        "discretisation_error",
        "1",
        "error of restitution due to the grid, and to waves of a scan that it leaves out",
        optional=True,
        low=0.0,
    ),
    "surface_scatter": Column(
        "surface_scatter",
        "1",
        "error of restitution due to scatter among surfaces",
        optional=True,
        low=0.0,
    ),
    "material_error": Column(
        "material_error",
        "1",
        "error of restitution due to the spread of library values",
        optional=True,
        low=0.0,
    ),
    "total_error": Column(
        "total_error",
        "1",
        "total error of restitution: the errors above, in quadrature",
        optional=True,
        low=0.0,
    ),
    "model_error": Column(
        "model_error", "1", "error of restitution due to the model of plasticity", low=0.0
    ),
    "refine": Column(
        "refinement", "1", "cells along x and y that one cell of [grid] is divided into", low=1.0
    ),
}
# Additional columns of the curve of an ensemble, whose other columns are means.
SPREAD_COLUMNS = {
    "realisations": Column("realisations", "1", "surfaces that reached this depth", low=0.0),
    "restitution_std": Column(
        "restitution_std", "1", "standard deviation over the surfaces", optional=True, low=0.0
    ),
    "restitution_low": Column(
        "restitution_low",
        "1",
        "lower end of the 95 % interval of the mean",
        optional=True,
        low=0.0,
        high=1.0,
    ),
    "restitution_high": Column(
        "restitution_high",
        "1",
        "upper end of the 95 % interval of the mean",
        optional=True,
        low=0.0,
        high=1.0,
    ),
}
ALL_COLUMNS = COLUMNS | SPREAD_COLUMNS
UNLOADING_COLUMNS = ("max_indentation_m", "indentation_m", "force_N")
STATUS = ("complete", "failed", "missing")  # of a case in the table of a study
LOCK = ".restitution-lock"  # held by the process that writes in a folder
