"""The columns of stored results: names, units, meanings and limits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.contact.checks.resolution import ADHESIVE_NODES, NODES_PER_PATCH


@dataclass(frozen=True)
class Column:
    """A column of a table of results: its variable in `results.nc`, unit, meaning and limits.

    Cells of a `flag` column are true or false, and cells of an `optional` column may be empty. All
    other cells are finite numbers from `low` to `high`.
    """

    variable: str
    unit: str
    meaning: str
    low: float = -math.inf
    high: float = math.inf
    optional: bool = False
    flag: bool = False

    def labelled(self, along: str | tuple[str, ...], values: object) -> tuple[object, ...]:
        """Make the variable of `results.nc`: dimensions `along`, `values`, unit and meaning."""
        return along, values, {"units": self.unit, "long_name": self.meaning}


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
        "residual",
        "1",
        "largest violation of the contact conditions, divided by indentation",
        low=0.0,
    ),
    "convolutions": Column(
        "convolutions", "1", "number of convolutions in loading and unloading", low=0.0
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
    "sticks": Column("sticks", "1", "the bodies stick: unloading returns no work", flag=True),
    "adhesion_resolved": Column(
        "adhesion_resolved",
        "1",
        f"the pull-off radius has at least {ADHESIVE_NODES} nodes, or the grid resolves the range "
        "of the attraction",
        flag=True,
    ),
    "median_patch_nodes": Column(
        "median_patch_nodes",
        "1",
        "size of the median patch: half of the contact nodes are in patches at least as large",
        low=0.0,
    ),
    "resolved": Column(
        "resolved",
        "1",
        f"the median patch has at least {NODES_PER_PATCH} nodes",
        flag=True,
    ),
    "discretisation_error": Column(
        "discretisation_error",
        "1",
        "error of restitution due to the grid, and to waves of a scan that the grid omits",
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
        "model_error",
        "1",
        "error of restitution due to the models of plasticity and adhesion",
        low=0.0,
    ),
    "refine": Column(
        "refinement",
        "1",
        "number of parts into which a cell of [grid] is divided along each axis",
        low=1.0,
    ),
}
# Additional columns of the curve of an ensemble. Its other columns combine the surfaces, mostly as
# means (`runs.ensemble.mean_rows`).
SPREAD_COLUMNS = {
    "realisations": Column(
        "realisations", "1", "number of surfaces that reached this depth", low=0.0
    ),
    "restitution_std": Column(
        "restitution_std",
        "1",
        "standard deviation of restitution among surfaces",
        optional=True,
        low=0.0,
    ),
    "restitution_low": Column(
        "restitution_low",
        "1",
        "lower end of the 95 % confidence interval of the mean restitution",
        optional=True,
        low=0.0,
        high=1.0,
    ),
    "restitution_high": Column(
        "restitution_high",
        "1",
        "upper end of the 95 % confidence interval of the mean restitution",
        optional=True,
        low=0.0,
        high=1.0,
    ),
}
ALL_COLUMNS = COLUMNS | SPREAD_COLUMNS
PERIODIC_FILE = "periodic.csv"  # the curve of a periodic contact, instead of curve.csv
OBLIQUE_FILE = "oblique.csv"
# Columns of the table of oblique impacts. The tangential restitution and the angle of rebound refer
# to the velocity of the centres of the bodies.
OBLIQUE_COLUMNS = {
    "impact_velocity_m_per_s": Column(
        "oblique_velocity", "m s-1", "velocity of the centres before the impact", low=0.0
    ),
    "angle_rad": Column("oblique_angle", "rad", "angle of impact from the normal", low=0.0),
    "first_spin_before_rad_per_s": Column(
        "oblique_first_spin_before", "rad s-1", "spin of the first body before the impact"
    ),
    "second_spin_before_rad_per_s": Column(
        "oblique_second_spin_before", "rad s-1", "spin of the second body before the impact"
    ),
    "friction": Column("oblique_friction", "1", "coefficient of friction", low=0.0),
    "normal_restitution": Column(
        "oblique_normal_restitution", "1", "normal restitution", low=0.0, high=1.0
    ),
    "normal_restitution_error": Column(
        "oblique_normal_restitution_error", "1", "error of normal_restitution", 0.0, optional=True
    ),
    "tangential_restitution": Column(
        "oblique_tangential_restitution", "1", "tangential restitution", optional=True
    ),
    "rebound_angle_rad": Column("oblique_rebound_angle", "rad", "angle of rebound"),
    "first_spin_rad_per_s": Column(
        "oblique_first_spin", "rad s-1", "spin of the first body after the impact"
    ),
    "second_spin_rad_per_s": Column(
        "oblique_second_spin", "rad s-1", "spin of the second body after the impact"
    ),
    "tangential_restitution_error": Column(
        "oblique_tangential_restitution_error",
        "1",
        "error of tangential_restitution",
        low=0.0,
        optional=True,
    ),
    "rebound_angle_error_rad": Column(
        "oblique_rebound_angle_error", "rad", "error of rebound_angle", low=0.0, optional=True
    ),
    "first_spin_error_rad_per_s": Column(
        "oblique_first_spin_error", "rad s-1", "error of first_spin", low=0.0, optional=True
    ),
    "second_spin_error_rad_per_s": Column(
        "oblique_second_spin_error", "rad s-1", "error of second_spin", low=0.0, optional=True
    ),
    "friction_loss_J": Column("oblique_friction_loss", "J", "energy lost to friction", low=0.0),
    "normal_loss_J": Column(
        "oblique_normal_loss", "J", "energy lost in the normal contact", low=0.0
    ),
    "slides": Column(
        "oblique_slides", "1", "the whole contact slides from beginning to end", flag=True
    ),
}
# Additional columns of the oblique impacts of an ensemble. Its other columns are means over the
# surfaces, except `slides`, which is true if the contact slides on all surfaces.
OBLIQUE_SPREAD_COLUMNS = {
    "realisations": Column(
        "oblique_realisations", "1", "number of surfaces with this impact", low=0.0
    ),
    "tangential_restitution_std": Column(
        "oblique_tangential_restitution_std",
        "1",
        "standard deviation of tangential_restitution among surfaces",
        low=0.0,
        optional=True,
    ),
}
UNLOADING_COLUMNS = ("max_indentation_m", "indentation_m", "force_N")
STATUS = ("complete", "failed", "missing")  # possible states of a case in the table of a study
LOCK = ".restitution-lock"  # name of the lock file, which the process that writes to a folder holds
