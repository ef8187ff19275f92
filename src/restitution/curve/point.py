"""One point of a curve: the results of one impact."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

from restitution.collision import Collision
from restitution.contact.checks.model_error import model_error, pull_off_error
from restitution.contact.checks.resolution import (
    NODES_PER_PATCH,
    adhesive_spacing,
    median_patch,
    resolves_adhesion,
    resolves_contact,
)
from restitution.contact.state import State
from restitution.curve.columns import Record, column, magnitude

PARTS = ("restitution_error", "discretisation_error", "surface_scatter", "material_error")
"""The parts of the total error of COR."""


@dataclass(frozen=True, kw_only=True)
class Point(Record):
    """One impact, in SI units; its fields are the columns of `curve.csv` (docs/results.md)."""

    indentation: float = column("max_indentation_m", "m", "maximum indentation")
    force: float = column("force_N", "N", "normal force at maximum indentation")
    contact_area: float = magnitude("contact_area_m2", "m2", "real contact area")
    stored_energy: float = magnitude(
        "stored_energy_J", "J", "elastic energy at maximum indentation"
    )
    plastic_work: float = magnitude("plastic_work_J", "J", "work dissipated by yielding")
    loading_work: float = column("loading_work_J", "J", "work of loading")
    unloading_work: float = column("unloading_work_J", "J", "work returned until separation")
    restitution: float = magnitude(
        "restitution",
        "1",
        "coefficient of restitution; empty if no impact has this maximum indentation",
        high=1.0,
        optional=True,
    )
    impact_velocity: float = magnitude(
        "impact_velocity_m_per_s", "m s-1", "impact velocity for this indentation", optional=True
    )
    contact_nodes: float = magnitude("contact_nodes", "1", "nodes in contact")
    contact_patches: float = magnitude(
        "contact_patches", "1", "contact patches (nodes joined by an edge)"
    )
    largest_patch_nodes: float = magnitude(
        "largest_patch_nodes", "1", "nodes in the largest contact patch"
    )
    residual: float = magnitude(
        "residual", "1", "largest violation of the contact conditions, divided by indentation"
    )
    convolutions: float = magnitude(
        "convolutions", "1", "number of convolutions in loading and unloading"
    )
    pull_off_force: float = column(
        "pull_off_force_N", "N", "largest tension during unloading", optional=True
    )
    pull_off_error: float = magnitude(
        "pull_off_error_N",
        "N",
        "error of the pull-off force: range of the attraction, solver, and with the total error "
        "grid, surface and materials",
        optional=True,
    )
    separation_indentation: float = column(
        "separation_indentation_m", "m", "indentation at separation", optional=True
    )
    restitution_error: float = magnitude(
        "restitution_error", "1", "error of COR due to the solver", optional=True
    )
    sticks: bool = column("sticks", "1", "the bodies stick: unloading returns no work")
    adhesion_resolved: bool = column(
        "adhesion_resolved", "1", "the grid resolves the adhesion of the asperities in contact"
    )
    adhesive_spacing: float = magnitude(
        "adhesive_spacing_m",
        "m",
        "largest cell that resolves the adhesion of the asperities in contact",
        optional=True,
    )
    median_patch_nodes: float = magnitude(
        "median_patch_nodes",
        "1",
        "size of the median patch: half of the contact nodes are in patches at least as large",
    )
    resolved: bool = column(
        "resolved",
        "1",
        f"the median patch has at least {NODES_PER_PATCH} nodes, the grid resolves adhesion, and "
        f"the waves that it omits change restitution little",
    )
    discretisation_error: float = magnitude(
        "discretisation_error",
        "1",
        "error of restitution due to the grid, and to waves of a scan that the grid omits",
        optional=True,
    )
    surface_scatter: float = magnitude(
        "surface_scatter",
        "1",
        "error of restitution due to scatter between surfaces",
        optional=True,
    )
    material_error: float = magnitude(
        "material_error",
        "1",
        "error of restitution due to the spread of library values",
        optional=True,
    )
    total_error: float = magnitude(
        "total_error",
        "1",
        "total error of restitution: the errors above, in quadrature",
        optional=True,
    )
    model_error: float = magnitude(
        "model_error",
        "1",
        "error of restitution due to the models of plasticity and adhesion",
        optional=True,
    )
    refine: float = column(
        "refine",
        "1",
        "number of parts into which a cell of [grid] is divided along each axis",
        "refinement",
        low=1.0,
    )
    restitution_with_losses: float = magnitude(
        "restitution_with_losses",
        "1",
        "restitution times the three factors that follow",
        high=1.0,
        optional=True,
    )
    plate_factor: float = magnitude(
        "plate_factor", "1", "by bending waves in a thin wall", high=1.0, optional=True
    )
    waves_factor: float = magnitude(
        "waves_factor", "1", "by waves in a thick wall", high=1.0, optional=True
    )
    viscosity_factor: float = magnitude(
        "viscosity_factor", "1", "by internal friction", high=1.0, optional=True
    )
    loss_error: float = magnitude(
        "loss_error",
        "1",
        "difference of restitution_with_losses from the equation of motion with all losses",
        optional=True,
    )

    @classmethod
    def of(cls, state: State, collision: Collision, refine: int = 1, touch: float = 0.0) -> Self:
        """Make the point of an impact whose deepest state is `state`.

        `touch` (m) is the approach at first touch on this grid minus that on the finest grid; it is
        added to the indentations.
        """
        patches = state.patch_sizes()
        # Without positive work of loading, no impact has its deepest point here.
        impact = collision.loading_work > 0
        cor = collision.restitution if impact else math.nan
        velocity = collision.impact_velocity
        return cls(
            indentation=state.indentation + touch,
            force=state.force,
            contact_area=state.contact_area,
            stored_energy=state.stored_energy,
            plastic_work=state.plastic_work,
            loading_work=collision.loading_work,
            unloading_work=collision.unloading_work,
            restitution=cor,
            impact_velocity=math.nan if velocity is None else velocity,
            contact_nodes=state.contact_nodes,
            contact_patches=patches.size,
            largest_patch_nodes=int(patches[0]) if patches.size else 0,
            residual=state.residual,
            convolutions=state.convolutions + collision.convolutions,
            pull_off_force=collision.pull_off_force,
            pull_off_error=pull_off_error(state, collision.pull_off_force),
            separation_indentation=collision.separation_indentation + touch,
            restitution_error=(
                min(collision.restitution_error, max(cor, 1 - cor)) if impact else math.nan
            ),
            sticks=collision.sticks and impact,
            adhesion_resolved=resolves_adhesion(state),
            adhesive_spacing=adhesive_spacing(state) if state.contact.adhesive else math.nan,
            median_patch_nodes=median_patch(patches),
            resolved=resolves_contact(state),
            model_error=model_error(state, cor) if impact else math.nan,
            refine=refine,
        )

    @property
    def ratio(self) -> float:
        """Ratio of unloading to loading work."""
        return self.unloading_work / self.loading_work

    @property
    def final(self) -> float:
        """COR with all losses that are known."""
        known = self.restitution_with_losses
        return self.restitution if math.isnan(known) else known

    @property
    def final_ratio(self) -> float:
        """`ratio`, times the squared factors of all losses; negative or 0 if the bodies stick."""
        return self.final**2 if self.final > 0 else min(self.ratio, 0.0)

    @property
    def combined_error(self) -> float:
        """Root sum of squares of the known parts of the total error of COR.

        COR lies between 0 and 1, so its error cannot exceed the larger of COR and 1 − COR.
        """
        known = [error for part in PARTS if not math.isnan(error := getattr(self, part))]
        return min(math.hypot(*known), max(self.restitution, 1 - self.restitution))


@dataclass(frozen=True, kw_only=True)
class MeanPoint(Point):
    """A point of the mean curve of several surfaces; the other fields combine the surfaces."""

    realisations: float = magnitude(
        "realisations", "1", "number of surfaces that reached this depth"
    )
    restitution_std: float = magnitude(
        "restitution_std",
        "1",
        "standard deviation of restitution among surfaces",
        optional=True,
    )
    restitution_low: float = magnitude(
        "restitution_low",
        "1",
        "lower end of the 95 % confidence interval of the mean restitution",
        high=1.0,
        optional=True,
    )
    restitution_high: float = magnitude(
        "restitution_high",
        "1",
        "upper end of the 95 % confidence interval of the mean restitution",
        high=1.0,
        optional=True,
    )

    @property
    def ratio(self) -> float:
        """Square of the mean COR, or the ratio of the mean works if the mean COR is 0."""
        return self.restitution**2 if self.restitution > 0 else super().ratio
