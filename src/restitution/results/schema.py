"""What stored results are called, and what their columns mean: names, units and limits."""

from __future__ import annotations

import math

from restitution.contact.resolution import ADHESIVE_NODES, NODES_PER_PATCH

LOCK = ".restitution-lock"  # of the process that writes in a folder
# Column of curve.csv → (variable in results.nc, its unit, what it is).
COLUMNS: dict[str, tuple[str, str, str]] = {
    "indentation_m": ("indentation", "m", "maximum indentation"),
    "force_N": ("force", "N", "normal force at maximum indentation"),
    "contact_area_m2": ("contact_area", "m2", "real contact area"),
    "stored_energy_J": ("stored_energy", "J", "elastic energy at maximum indentation"),
    "plastic_work_J": ("plastic_work", "J", "work dissipated by yielding"),
    "loading_work_J": ("loading_work", "J", "work of loading"),
    "unloading_work_J": ("unloading_work", "J", "work returned until separation"),
    "restitution": ("restitution", "1", "coefficient of restitution"),
    "impact_velocity_m_per_s": ("impact_velocity", "m s-1", "approach velocity that reaches here"),
    "contact_nodes": ("contact_nodes", "1", "nodes in contact"),
    "contact_patches": ("contact_patches", "1", "contact patches (nodes joined by an edge)"),
    "largest_patch_nodes": ("largest_patch_nodes", "1", "nodes in the largest contact patch"),
    "residual": ("residual", "1", "largest violation of the contact conditions over indentation"),
    "convolutions": ("convolutions", "1", "convolutions that loading and unloading took"),
    "pull_off_force_N": ("pull_off_force", "N", "largest tension on the way back"),
    "separation_indentation_m": ("separation_indentation", "m", "where the bodies part"),
    "restitution_error": ("restitution_error", "1", "numerical error of the restitution"),
    "sticks": ("sticks", "1", "nothing is returned: the pair does not come apart by itself"),
    "adhesion_resolved": (
        "adhesion_resolved",
        "1",
        f"pull-off radius of at least {ADHESIVE_NODES} nodes",
    ),
    "median_patch_nodes": ("median_patch_nodes", "1", "nodes in the patch of the median node"),
    "resolved": (
        "resolved",
        "1",
        f"half of the contact in patches of {NODES_PER_PATCH} nodes or more",
    ),
    "discretisation_error": (
        "discretisation_error",
        "1",
        "restitution's error by the grid, and by the waves that it leaves out of a scan",
    ),
    "surface_scatter": ("surface_scatter", "1", "restitution's error as one surface of many"),
    "material_error": ("material_error", "1", "restitution's error by library values"),
    "total_error": (
        "total_error",
        "1",
        "all these errors of the restitution, in quadrature",
    ),
    "model_error": ("model_error", "1", "restitution's error by the model of plasticity"),
}
# What the curve of an ensemble has besides: its other columns are means.
SPREAD_COLUMNS: dict[str, tuple[str, str, str]] = {
    "realisations": ("realisations", "1", "surfaces that reached this depth"),
    "restitution_std": ("restitution_std", "1", "standard deviation over the surfaces"),
    "restitution_low": ("restitution_low", "1", "lower end of the 95 % interval of the mean"),
    "restitution_high": ("restitution_high", "1", "upper end of the 95 % interval of the mean"),
}
UNLOADING_COLUMNS = ("indentation_max_m", "indentation_m", "force_N")
FLAGS = frozenset({"sticks", "adhesion_resolved", "resolved"})
# Columns whose cells are empty where there is no answer.
OPTIONAL = frozenset(
    {
        "impact_velocity_m_per_s",
        "pull_off_force_N",
        "separation_indentation_m",
        "discretisation_error",
        "surface_scatter",
        "material_error",
        "total_error",
        "restitution_std",
        "restitution_low",
        "restitution_high",
    }
)
# Columns and their lowest and highest values.
RANGES = {
    **dict.fromkeys(("restitution", "restitution_low", "restitution_high"), (0.0, 1.0)),
    **dict.fromkeys(
        (
            "impact_velocity_m_per_s", "contact_area_m2", "stored_energy_J", "plastic_work_J",
            "contact_nodes", "contact_patches", "largest_patch_nodes", "median_patch_nodes",
            "residual", "convolutions", "restitution_error", "model_error", "discretisation_error",
            "surface_scatter", "material_error", "total_error",
            "restitution_std", "realisations",
        ),
        (0.0, math.inf),
    ),
}  # fmt: skip
STATUS = ("complete", "failed", "missing")
