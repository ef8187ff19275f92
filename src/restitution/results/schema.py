"""The columns of stored results: names, units, meanings and limits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.contact.checks.resolution import NODES_PER_PATCH


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
        """Make a variable of `results.nc` with the dimensions `along` and the values `values`."""
        return along, values, {"units": self.unit, "long_name": self.meaning}


def _magnitude(variable: str, meaning: str, *, unit: str = "1", optional: bool = False) -> Column:
    """Make a column of numbers that are not negative."""
    return Column(variable, unit, meaning, low=0.0, optional=optional)


COLUMNS = {
    "max_indentation_m": Column("indentation", "m", "maximum indentation"),
    "force_N": Column("force", "N", "normal force at maximum indentation"),
    "contact_area_m2": _magnitude("contact_area", "real contact area", unit="m2"),
    "stored_energy_J": _magnitude(
        "stored_energy", "elastic energy at maximum indentation", unit="J"
    ),
    "plastic_work_J": _magnitude("plastic_work", "work dissipated by yielding", unit="J"),
    "loading_work_J": Column("loading_work", "J", "work of loading"),
    "unloading_work_J": Column("unloading_work", "J", "work returned until separation"),
    "restitution": Column(
        "restitution",
        "1",
        "coefficient of restitution; empty if no impact has this maximum indentation",
        low=0.0,
        high=1.0,
        optional=True,
    ),
    "impact_velocity_m_per_s": _magnitude(
        "impact_velocity", "impact velocity for this indentation", unit="m s-1", optional=True
    ),
    "contact_nodes": _magnitude("contact_nodes", "nodes in contact"),
    "contact_patches": _magnitude("contact_patches", "contact patches (nodes joined by an edge)"),
    "largest_patch_nodes": _magnitude("largest_patch_nodes", "nodes in the largest contact patch"),
    "residual": _magnitude(
        "residual", "largest violation of the contact conditions, divided by indentation"
    ),
    "convolutions": _magnitude("convolutions", "number of convolutions in loading and unloading"),
    "pull_off_force_N": Column(
        "pull_off_force", "N", "largest tension during unloading", optional=True
    ),
    "pull_off_error_N": _magnitude(
        "pull_off_error",
        "error of the pull-off force: range of the attraction, solver, and with the total error "
        "grid, surface and materials",
        unit="N",
        optional=True,
    ),
    "separation_indentation_m": Column(
        "separation_indentation", "m", "indentation at separation", optional=True
    ),
    "restitution_error": _magnitude(
        "restitution_error", "error of COR due to the solver", optional=True
    ),
    "sticks": Column("sticks", "1", "the bodies stick: unloading returns no work", flag=True),
    "adhesion_resolved": Column(
        "adhesion_resolved",
        "1",
        "the grid resolves the adhesion of the asperities in contact",
        flag=True,
    ),
    "adhesive_spacing_m": _magnitude(
        "adhesive_spacing",
        "largest cell that resolves the adhesion of the asperities in contact",
        unit="m",
        optional=True,
    ),
    "median_patch_nodes": _magnitude(
        "median_patch_nodes",
        "size of the median patch: half of the contact nodes are in patches at least as large",
    ),
    "resolved": Column(
        "resolved",
        "1",
        f"the median patch has at least {NODES_PER_PATCH} nodes, the grid resolves adhesion, and "
        f"the waves that it omits change restitution little",
        flag=True,
    ),
    "discretisation_error": _magnitude(
        "discretisation_error",
        "error of restitution due to the grid, and to waves of a scan that the grid omits",
        optional=True,
    ),
    "surface_scatter": _magnitude(
        "surface_scatter", "error of restitution due to scatter between surfaces", optional=True
    ),
    "material_error": _magnitude(
        "material_error", "error of restitution due to the spread of library values", optional=True
    ),
    "total_error": _magnitude(
        "total_error", "total error of restitution: the errors above, in quadrature", optional=True
    ),
    "model_error": _magnitude(
        "model_error",
        "error of restitution due to the models of plasticity and adhesion",
        optional=True,
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
    "realisations": _magnitude("realisations", "number of surfaces that reached this depth"),
    "restitution_std": _magnitude(
        "restitution_std", "standard deviation of restitution among surfaces", optional=True
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
    "impact_velocity_m_per_s": _magnitude(
        "oblique_velocity", "velocity of the centres before the impact", unit="m s-1"
    ),
    "angle_rad": _magnitude("oblique_angle", "angle of impact from the normal", unit="rad"),
    "first_spin_before_rad_per_s": Column(
        "oblique_first_spin_before", "rad s-1", "spin of the first body before the impact"
    ),
    "second_spin_before_rad_per_s": Column(
        "oblique_second_spin_before", "rad s-1", "spin of the second body before the impact"
    ),
    "friction": _magnitude("oblique_friction", "coefficient of friction"),
    "normal_restitution": Column(
        "oblique_normal_restitution", "1", "normal restitution", low=0.0, high=1.0
    ),
    "normal_restitution_error": _magnitude(
        "oblique_normal_restitution_error", "error of normal_restitution", optional=True
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
    "tangential_restitution_error": _magnitude(
        "oblique_tangential_restitution_error", "error of tangential_restitution", optional=True
    ),
    "rebound_angle_error_rad": _magnitude(
        "oblique_rebound_angle_error", "error of rebound_angle", unit="rad", optional=True
    ),
    "first_spin_error_rad_per_s": _magnitude(
        "oblique_first_spin_error", "error of first_spin", unit="rad s-1", optional=True
    ),
    "second_spin_error_rad_per_s": _magnitude(
        "oblique_second_spin_error", "error of second_spin", unit="rad s-1", optional=True
    ),
    "friction_loss_J": _magnitude("oblique_friction_loss", "energy lost to friction", unit="J"),
    "normal_loss_J": _magnitude(
        "oblique_normal_loss", "energy lost in the normal contact", unit="J"
    ),
    "slides": Column(
        "oblique_slides", "1", "the whole contact slides from beginning to end", flag=True
    ),
}
# Additional columns of the oblique impacts of an ensemble. Its other columns are means over the
# surfaces, except `slides`, which is true if the contact slides on all surfaces.
OBLIQUE_SPREAD_COLUMNS = {
    "realisations": _magnitude("oblique_realisations", "number of surfaces with this impact"),
    "tangential_restitution_std": _magnitude(
        "oblique_tangential_restitution_std",
        "standard deviation of tangential_restitution among surfaces",
        optional=True,
    ),
}
UNLOADING_COLUMNS = ("max_indentation_m", "indentation_m", "force_N")
STATUS = ("complete", "failed", "missing")  # possible states of a case in the table of a study
LOCK = ".restitution-lock"  # name of the lock file, held by the process that writes to a folder
