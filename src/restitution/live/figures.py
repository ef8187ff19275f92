"""The figures of the page, as JSON for the plotting library."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from restitution.case.case import Case
from restitution.case.derived import derived_quantities
from restitution.contact.contact import Contact
from restitution.contact.state import State
from restitution.display import quantity
from restitution.plots import interactive
from restitution.plots.figure import Axis, Colours, Figure, Map
from restitution.plots.run import abscissae, load_displacement, restitution_figure
from restitution.plots.surface import surface_map
from restitution.results.writer import curve_variables
from restitution.surfaces import Surface, describe

Array = NDArray[np.float64]
_MOST_PIXELS = 200  # largest number of pixels of a map along either axis


class Raw(str):
    """JSON text that `as_json` inserts without encoding it."""


def as_json(content: Mapping[str, Any]) -> str:
    """Format `content` as one line of JSON; NaN and infinity become null."""
    parts = [
        f"{json.dumps(key)}: "
        + (value if isinstance(value, Raw) else json.dumps(_finite(value), allow_nan=False))
        for key, value in content.items()
    ]
    return "{" + ", ".join(parts) + "}"


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def live_dataset(case: Case, contact: Contact, rows: Sequence[Mapping[str, float]]) -> xr.Dataset:
    """Convert `rows` to the dataset of a run's figures, without unloading curves and maps."""
    derived = {f"derived_{k}": str(v) for k, v in derived_quantities(case, contact).items()}
    return xr.Dataset(curve_variables(rows), attrs={"title": case.title, **derived})


def curve_figures(results: xr.Dataset) -> Raw:
    """Draw the figures of COR and of force as JSON; omit figures without data."""
    if not results.sizes["indentation_max"]:
        return Raw("{}")
    found = {each.name: restitution_figure(results, each) for each in abscissae(results)}
    found["force"] = load_displacement(results)
    return Raw(as_json({name: drawing(figure) for name, figure in found.items()}))


def drawing(figure: Figure) -> Raw:
    """Convert the first panel of `figure` to JSON for the plotting library."""
    return Raw(interactive.draw(figure.panels[0], figure).to_json())


def surface_content(surface: Surface) -> dict[str, Any]:
    """The map of `surface` and its statistics, for `as_json`."""
    nodes, spacing = surface.grid.nodes, surface.grid.spacing
    rows = [
        ["nodes", " × ".join(map(str, nodes))],
        ["spacing", " × ".join(quantity(h, "m") for h in spacing)],
    ]
    for name, value in describe(surface).items():
        words = name.replace("_", " ")
        bare = words.removesuffix(" per m").removesuffix(" m")
        rows.append([bare, _in_unit(value, words.removeprefix(bare))])
    return {"surface": drawing(surface_map(_thinned(surface))), "statistics": rows}


def _in_unit(value: float | None, unit: str) -> str:
    if value is None:
        return "–"
    return quantity(value, "m") if unit == " m" else f"{value:.4g}{unit.replace('per m', '1/m')}"


def _thinned(surface: Surface) -> Surface:
    step = math.ceil(max(surface.grid.nodes) / _MOST_PIXELS)
    if step == 1:
        return surface
    height = surface.height[::step, ::step]
    spacing = tuple(step * h for h in surface.grid.spacing)
    grid = type(surface.grid)(height.shape, (spacing[0], spacing[1]))
    return Surface(height, grid, surface.provenance)


@dataclass(frozen=True, eq=False)
class _Thumbnail:
    """Pressure (Pa) and plastic displacement (m) at some of the nodes, at `x` and `y` (m)."""

    x: Array
    y: Array
    pressure: Array
    plastic: Array
    indentation: float


class ContactMaps:
    """Small maps of pressure and plastic displacement at every depth of a curve."""

    def __init__(self) -> None:
        self._maps: list[_Thumbnail] = []
        self._down = False

    def add(self, state: State, indentation: float) -> None:
        """Store maps of `state` with at most `_MOST_PIXELS` nodes along each axis."""
        grid, box = state.contact.grid, state.box
        step = math.ceil(max(state.box_pressure.shape) / _MOST_PIXELS)
        x, y = grid.x[box[0]][::step], grid.y[box[1]][::step]
        pressure = state.box_pressure[::step, ::step].copy()
        plastic = state.plastic_displacement[box][::step, ::step].copy()
        self._maps.append(_Thumbnail(x, y, pressure, plastic, indentation))
        self._down = state.contact.surface.provenance.get("y_axis") == "down"

    def __len__(self) -> int:
        return len(self._maps)

    def line(self, number: int) -> str:
        """Return the maps at one depth as a line of JSON; the axes are the same at all depths."""
        at = self._maps[number]
        touched = (at.pressure != 0) | (at.plastic != 0)
        MPa, nm = 1e-6 * at.pressure, 1e9 * at.plastic

        def drawn(values: Array, axis: Axis, colours: Colours) -> Raw:
            blank = np.where(touched, values, np.nan)
            return self._drawn(Map(1e6 * at.x, 1e6 * at.y, blank, axis, colours))

        content: dict[str, Any] = {
            "depth": number,
            "indentation_m": at.indentation,
            "largest": {"pressure_MPa": MPa.max(initial=0.0), "plastic_nm": nm.max(initial=0.0)},
            "pressure": drawn(MPa, Axis("pressure", "MPa"), "viridis"),
        }
        if nm.any():
            content["plastic"] = drawn(nm, Axis("plastic displacement", "nm"), "magma")
        return as_json(content)

    def _drawn(self, part: Map) -> Raw:
        plot = interactive.draw(part, Figure(""))
        x, y = (
            [1e6 * min(one[0] for one in each), 1e6 * max(one[-1] for one in each)]
            for each in ([one.x for one in self._maps], [one.y for one in self._maps])
        )
        plot.update_xaxes(range=x)
        plot.update_yaxes(range=y[::-1] if self._down else y)
        return Raw(plot.to_json())
