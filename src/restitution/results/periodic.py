"""Results of a periodic contact: the rows of `periodic.csv`, and the content of `results.nc`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from restitution.contact.checks.resolution import median_patch, resolves_contact
from restitution.contact.state import Array, State
from restitution.display import quantity, summary_html, summary_text
from restitution.results.checksums import check_file
from restitution.results.coordinates import with_coordinates
from restitution.results.schema import PERIODIC_FILE, Column
from restitution.results.stored_files import read_json, read_maps, read_netcdf
from restitution.results.tables import read_cells, read_numbers
from restitution.results.writer import curve_variables, dataset_with_maps

_PATCH = "size of the median patch: half of the contact nodes are in patches at least as large"
COLUMNS = {
    "indentation_m": Column("indentation", "m", "approach of the mean planes since first touch"),
    "mean_gap_m": Column("mean_gap", "m", "distance of the mean planes"),
    "nominal_pressure_Pa": Column("nominal_pressure", "Pa", "force divided by nominal area"),
    "force_N": Column("force", "N", "normal force on one period"),
    "relative_area": Column("relative_area", "1", "fraction of all nodes that are in contact"),
    "corrected_relative_area": Column(
        "corrected_relative_area",
        "1",
        "relative area, corrected for the staircase shape of the contact edge",
    ),
    "largest_pressure_Pa": Column("largest_pressure", "Pa", "largest pressure of a node"),
    "stored_energy_J": Column("stored_energy", "J", "elastic energy of one period"),
    "plastic_work_J": Column("plastic_work", "J", "work dissipated by yielding"),
    "adhesive_work_J": Column("adhesive_work", "J", "work done by adhesion"),
    "adhesive_loss_J": Column("adhesive_loss", "J", "energy dissipated by jumps of the contact"),
    "loading_work_J": Column("loading_work", "J", "work of loading"),
    "stiffness_Pa_per_m": Column(
        "stiffness",
        "Pa m-1",
        "increase of the nominal pressure per approach at a constant contact area; empty in "
        "complete contact, where the mean gap cannot decrease",
        optional=True,
    ),
    "contact_nodes": Column("contact_nodes", "1", "nodes in contact"),
    "contact_patches": Column("contact_patches", "1", "contact patches (nodes joined by an edge)"),
    "largest_patch_nodes": Column("largest_patch_nodes", "1", "nodes in the largest patch"),
    "median_patch_nodes": Column("median_patch_nodes", "1", _PATCH),
    "resolved": Column("resolved", "1", "the grid resolves patches and adhesion", flag=True),
    "residual": Column("residual", "1", "largest violation of the contact conditions"),
    "convolutions": Column("convolutions", "1", "number of convolutions in the solution"),
}


_BINS = 50
_HISTOGRAM = {
    "pressure": Column("binned_pressure", "Pa", "contact pressure in the middle of a bin"),
    "density": Column(
        "pressure_density", "Pa-1", "fraction of all nodes that have this contact pressure, per Pa"
    ),
}


@dataclass(frozen=True, eq=False)
class Histogram:
    """Distribution of the contact pressure: its `density` (1/Pa) at each `pressure` (Pa).

    The sum of the density times the width of a bin is the relative contact area.
    """

    pressure: Array
    density: Array


@dataclass(frozen=True)
class PeriodicResults:
    """The results of a periodic case in `folder`; a missing or damaged file raises `OutputError`.

    Attributes:
        folder: Results folder.
    """

    folder: Path

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The whole content of `results.nc`, loaded into memory: curve and maps, in SI units."""
        return with_coordinates(read_netcdf(self.folder / "results.nc"))

    @cached_property
    def maps(self) -> xr.Dataset:
        """The maps of every depth (`maps.nc`), which a case with maps = "all" stores."""
        return read_maps(self.folder)

    @cached_property
    def rows(self) -> list[dict[str, float]]:
        """The rows of `periodic.csv`, with NaN for empty cells."""
        path = self.folder / PERIODIC_FILE
        cells = read_cells(path, set(COLUMNS) - {"stiffness_Pa_per_m"})
        rows = [read_numbers(path, line, row, COLUMNS) for line, row in enumerate(cells, 2)]
        check_file(path)
        return rows

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The content of `summary.json`."""
        return read_json(self.folder / "summary.json")

    def _summary(self) -> list[str]:
        pressure = self.dataset["nominal_pressure"].values
        low, high = (quantity(float(end), "Pa") for end in (pressure[0], pressure[-1]))
        return [f"{self.folder}: {pressure.size} nominal pressures, {low} to {high}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


def periodic_row(state: State, stiffness: float) -> dict[str, float]:
    """Make the row of `periodic.csv` for one state of loading and its stiffness (Pa/m)."""
    patches = state.patch_sizes()
    median = median_patch(patches)
    values = (
        state.indentation,
        state.mean_gap,
        state.nominal_pressure,
        state.force,
        state.relative_area,
        state.corrected_area / math.prod(state.contact.grid.size),
        float(state.box_pressure.max(initial=0.0)),
        state.stored_energy,
        state.plastic_work,
        state.adhesive_work,
        state.adhesive_loss,
        state.loading_work,
        stiffness if math.isfinite(stiffness) else math.nan,
        state.contact_nodes,
        patches.size,
        int(patches[0]) if patches.size else 0,
        median,
        resolves_contact(state),
        state.residual,
        state.convolutions,
    )
    return dict(zip(COLUMNS, values, strict=True))


def pressure_histogram(state: State) -> Histogram:
    """Distribution of the contact pressure over the nodes in contact."""
    pressure = state.box_pressure[state.box_touching]
    ends = min(0.0, float(pressure.min(initial=0.0))), float(pressure.max(initial=0.0))
    counts, edges = np.histogram(pressure, _BINS, ends if ends[1] > ends[0] else (0.0, 1.0))
    share = counts / math.prod(state.contact.grid.nodes)
    return Histogram(0.5 * (edges[1:] + edges[:-1]), share / np.diff(edges))


def periodic_dataset(
    rows: Sequence[Mapping[str, float]], histograms: Sequence[Histogram], deepest: State
) -> xr.Dataset:
    """Make the content of `results.nc`, with units: curve, histograms, maps of the deepest state.

    `rows` and `histograms` have one item for each depth.
    """
    distributions = {
        column.variable: column.labelled(
            ("depth", "pressure_bin"), np.array([getattr(one, name) for one in histograms])
        )
        for name, column in _HISTOGRAM.items()
    }
    return dataset_with_maps(
        curve_variables(rows, COLUMNS, "depth") | distributions,
        deepest,
        pressure="contact pressure at the deepest state",
        lowering="lowering by yielding",
    )
