"""The figures on the page of `restitution app`, as JSON for Plotly."""

from __future__ import annotations

import json
import math
from base64 import b64encode
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from restitution.case.case import Case
from restitution.case.derived import derived_quantities
from restitution.contact.contact import Contact
from restitution.contact.state import State
from restitution.curve.point import Point
from restitution.display import quantity
from restitution.numerics.grid import Grid
from restitution.plots import interactive
from restitution.plots.figure import Axis, Figure, Map
from restitution.plots.run import abscissae, load_displacement, restitution_figure
from restitution.plots.surface import surface_map
from restitution.results.writer import curve_variables
from restitution.surfaces import Surface, describe

_MOST_PIXELS = 200  # largest number of pixels of a map along either axis


class Raw(str):
    """JSON text that `as_json` inserts without encoding it."""


def as_json(content: Mapping[str, Any]) -> str:
    """Format `content` as one line of JSON; NaN and infinity become null, arrays base64 text."""
    parts = [
        f"{json.dumps(key)}: "
        + (value if isinstance(value, Raw) else json.dumps(_finite(value), allow_nan=False))
        for key, value in content.items()
    ]
    return "{" + ", ".join(parts) + "}"


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    if isinstance(value, np.ndarray):
        array = np.ascontiguousarray(value, dtype=np.float64)
        return {"dtype": "f8", "bdata": b64encode(array.tobytes()).decode()}
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def live_dataset(case: Case, contact: Contact, points: Sequence[Point]) -> xr.Dataset:
    """Make a dataset of `points`, with everything that the figures of COR and of force need."""
    derived = {f"derived_{k}": str(v) for k, v in derived_quantities(case, contact).items()}
    return xr.Dataset(curve_variables(points), attrs={"title": case.title, **derived})


def curve_figures(results: xr.Dataset) -> Raw:
    """Draw the figures of COR and of force as JSON; omit figures without data."""
    if not results.sizes["indentation_max"]:
        return Raw("{}")
    figures = {axis.name: restitution_figure(results, axis) for axis in abscissae(results)}
    figures["force"] = load_displacement(results)
    return Raw(as_json({name: drawing(figure) for name, figure in figures.items()}))


def drawing(figure: Figure) -> Raw:
    """Convert the first panel of `figure` to JSON for the plotting library."""
    panel = figure.panels[0]
    if isinstance(panel, Map):  # whose colours the library in the browser does not know by name
        return Raw(interactive.draw(panel, figure).to_json())
    return Raw(as_json(interactive.contents(panel, figure)))


def surface_content(surface: Surface) -> dict[str, Any]:
    """Return the map of `surface` and its statistics, for `as_json`."""
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
    if unit == " m":
        return quantity(value, "m")
    return f"{1e-3 * value:.4g} 1/mm" if unit == " per m" else f"{value:.4g}{unit}"


def _thinned(surface: Surface) -> Surface:
    step = math.ceil(max(surface.grid.nodes) / _MOST_PIXELS)
    if step == 1:
        return surface
    height, (hx, hy) = surface.height[::step, ::step], surface.grid.spacing
    return Surface(height, Grid(height.shape, (step * hx, step * hy)), surface.provenance)


class ContactMaps:
    """Coarse maps of pressure and plastic displacement at every depth of a curve."""

    def __init__(self, contact: Contact) -> None:
        self._down = contact.surface.provenance.get("y_axis") == "down"
        self._maps: list[tuple[float, Map, Map]] = []

    def add(self, state: State, indentation: float) -> None:
        """Store maps of `state` with at most `_MOST_PIXELS` nodes along each axis."""
        grid, box = state.contact.grid, state.box
        step = math.ceil(max(state.box_pressure.shape) / _MOST_PIXELS)
        x, y = 1e6 * grid.x[box[0]][::step], 1e6 * grid.y[box[1]][::step]
        pressure = state.box_pressure[::step, ::step]
        plastic = state.plastic_displacement[box][::step, ::step]
        touched = (pressure != 0) | (plastic != 0)
        MPa, nm = (np.where(touched, values, np.nan) for values in (1e-6 * pressure, 1e9 * plastic))
        pressed = Map(x, y, MPa, Axis("pressure", "MPa"), "viridis")
        yielded = Map(x, y, nm, Axis("plastic displacement", "nm"), "magma")
        self._maps.append((indentation, pressed, yielded))

    def __len__(self) -> int:
        return len(self._maps)

    def line(self, number: int) -> str:
        """Return the maps at one depth as a line of JSON. The axes span the maps of all depths."""
        indentation, pressed, yielded = self._maps[number]
        largest = [np.nanmax(part.values, initial=0.0) for part in (pressed, yielded)]
        content: dict[str, Any] = {
            "indentation_m": indentation,
            "largest": {"pressure_MPa": largest[0], "plastic_nm": largest[1]},
            "pressure": self._drawn(pressed),
        }
        if largest[1]:
            content["plastic"] = self._drawn(yielded)
        return as_json(content)

    def _drawn(self, part: Map) -> Raw:
        plot = interactive.draw(part, Figure(""))
        x, y = (
            [min(nodes[0] for nodes in axes), max(nodes[-1] for nodes in axes)]
            for axes in zip(*((pressed.x, pressed.y) for _, pressed, _ in self._maps), strict=True)
        )
        plot.update_xaxes(range=x)
        plot.update_yaxes(range=y[::-1] if self._down else y)
        return Raw(plot.to_json())
