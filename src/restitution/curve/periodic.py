"""Points of the curve of a periodic contact."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from restitution.contact.checks.resolution import median_patch, resolves_contact
from restitution.contact.state import State
from restitution.curve.columns import Array, Record, column

_BINS = 50


@dataclass(frozen=True, kw_only=True)
class PeriodicPoint(Record):
    """One depth of a periodic contact; its fields are the columns of `periodic.csv`."""

    indentation: float = column(
        "indentation_m", "m", "approach of the mean planes since first touch"
    )
    mean_gap: float = column("mean_gap_m", "m", "distance of the mean planes")
    nominal_pressure: float = column("nominal_pressure_Pa", "Pa", "force divided by nominal area")
    force: float = column("force_N", "N", "normal force on one period")
    relative_area: float = column("relative_area", "1", "fraction of all nodes that are in contact")
    corrected_relative_area: float = column(
        "corrected_relative_area",
        "1",
        "relative area, corrected for the staircase shape of the contact edge",
    )
    largest_pressure: float = column("largest_pressure_Pa", "Pa", "largest pressure of a node")
    stored_energy: float = column("stored_energy_J", "J", "elastic energy of one period")
    plastic_work: float = column("plastic_work_J", "J", "work dissipated by yielding")
    adhesive_work: float = column("adhesive_work_J", "J", "work done by adhesion")
    adhesive_loss: float = column(
        "adhesive_loss_J", "J", "energy dissipated by jumps of the contact"
    )
    loading_work: float = column("loading_work_J", "J", "work of loading")
    stiffness: float = column(
        "stiffness_Pa_per_m",
        "Pa m-1",
        "increase of the nominal pressure per approach at a constant contact area; empty in "
        "complete contact, where the mean gap cannot decrease",
        optional=True,
    )
    contact_nodes: float = column("contact_nodes", "1", "nodes in contact")
    contact_patches: float = column(
        "contact_patches", "1", "contact patches (nodes joined by an edge)"
    )
    largest_patch_nodes: float = column("largest_patch_nodes", "1", "nodes in the largest patch")
    median_patch_nodes: float = column(
        "median_patch_nodes",
        "1",
        "size of the median patch: half of the contact nodes are in patches at least as large",
    )
    resolved: bool = column("resolved", "1", "the grid resolves patches and adhesion")
    residual: float = column("residual", "1", "largest violation of the contact conditions")
    convolutions: float = column("convolutions", "1", "number of convolutions in the solution")

    @classmethod
    def of(cls, state: State, stiffness: float) -> Self:
        patches = state.patch_sizes()
        return cls(
            indentation=state.indentation,
            mean_gap=state.mean_gap,
            nominal_pressure=state.nominal_pressure,
            force=state.force,
            relative_area=state.relative_area,
            corrected_relative_area=state.corrected_area / math.prod(state.contact.grid.size),
            largest_pressure=float(state.box_pressure.max(initial=0.0)),
            stored_energy=state.stored_energy,
            plastic_work=state.plastic_work,
            adhesive_work=state.adhesive_work,
            adhesive_loss=state.adhesive_loss,
            loading_work=state.loading_work,
            stiffness=stiffness if math.isfinite(stiffness) else math.nan,
            contact_nodes=state.contact_nodes,
            contact_patches=patches.size,
            largest_patch_nodes=int(patches[0]) if patches.size else 0,
            median_patch_nodes=median_patch(patches),
            resolved=resolves_contact(state),
            residual=state.residual,
            convolutions=state.convolutions,
        )


@dataclass(frozen=True, eq=False)
class Histogram:
    """Distribution of the contact pressure: its `density` (1/Pa) at each `pressure` (Pa)."""

    pressure: Array
    density: Array

    @classmethod
    def of(cls, state: State) -> Self:
        pressure = state.box_pressure[state.box_touching]
        ends = min(0.0, float(pressure.min(initial=0.0))), float(pressure.max(initial=0.0))
        counts, edges = np.histogram(pressure, _BINS, ends if ends[1] > ends[0] else (0.0, 1.0))
        share = counts / math.prod(state.contact.grid.nodes)
        return cls(0.5 * (edges[1:] + edges[:-1]), share / np.diff(edges))
