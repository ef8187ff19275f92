"""Results of a periodic contact: the rows of `periodic.csv`, and the content of `results.nc`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np
import xarray as xr

from restitution.contact.state import State
from restitution.curve.periodic import Histogram, PeriodicPoint
from restitution.display import quantity, summary_html, summary_text
from restitution.results.checksums import check_file
from restitution.results.coordinates import with_coordinates
from restitution.results.schema import PERIODIC_FILE
from restitution.results.stored_files import read_json, read_maps, read_netcdf, stored_file
from restitution.results.tables import read_cells, read_numbers
from restitution.results.writer import curve_variables, dataset_with_maps

COLUMNS = PeriodicPoint.columns()
_HISTOGRAM = {
    "pressure": ("binned_pressure", "Pa", "contact pressure in the middle of a bin"),
    "density": (
        "pressure_density",
        "Pa-1",
        "fraction of all nodes that have this contact pressure, per Pa",
    ),
}


@dataclass(frozen=True)
class PeriodicResults:
    """The results of a periodic case in `folder`; a missing or damaged file raises `OutputError`.

    Attributes:
        folder: Results folder.
    """

    folder: Path | None

    @classmethod
    def of(
        cls,
        folder: Path | None,
        points: Sequence[PeriodicPoint],
        summary: dict[str, Any],
        dataset: xr.Dataset,
    ) -> Self:
        results = cls(folder)
        vars(results).update(points=tuple(points), summary=summary, dataset=dataset)
        return results

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The whole content of `results.nc`, loaded into memory: curve and maps, in SI units."""
        return with_coordinates(read_netcdf(self._file("results.nc")))

    @cached_property
    def maps(self) -> xr.Dataset:
        """The maps of every depth (`maps.nc`), which a case with maps = "all" stores."""
        return read_maps(self._file("maps.nc").parent)

    @cached_property
    def points(self) -> tuple[PeriodicPoint, ...]:
        path = self._file(PERIODIC_FILE)
        cells = read_cells(path, set(COLUMNS) - {"stiffness_Pa_per_m"})
        rows = [read_numbers(path, line, row, COLUMNS) for line, row in enumerate(cells, 2)]
        check_file(path)
        return tuple(map(PeriodicPoint.of_cells, rows))

    @property
    def rows(self) -> list[dict[str, Any]]:
        return [point.cells() for point in self.points]

    @cached_property
    def summary(self) -> dict[str, Any]:
        return read_json(self._file("summary.json"))

    def _file(self, name: str) -> Path:
        return stored_file(self.folder, name)

    def _summary(self) -> list[str]:
        pressure = self.dataset["nominal_pressure"].values
        low, high = (quantity(float(end), "Pa") for end in (pressure[0], pressure[-1]))
        return [f"{self.folder or 'in memory'}: {pressure.size} nominal pressures, {low} to {high}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


def periodic_dataset(
    points: Sequence[PeriodicPoint], histograms: Sequence[Histogram], deepest: State
) -> xr.Dataset:
    """The content of `results.nc`: curve, histograms and maps of the deepest state."""
    distributions = {
        variable: (
            ("depth", "pressure_bin"),
            np.array([getattr(one, name) for one in histograms]),
            {"units": unit, "long_name": words},
        )
        for name, (variable, unit, words) in _HISTOGRAM.items()
    }
    return dataset_with_maps(
        curve_variables(points, "depth") | distributions,
        deepest,
        pressure="contact pressure at the deepest state",
        lowering="lowering by yielding",
    )
