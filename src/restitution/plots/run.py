"""Figures of one run, ensemble or convergence study, from its stored results alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import xarray as xr

from restitution.compare.references import (
    Reference,
    force_references,
    restitution_references_by_indentation,
    restitution_references_by_velocity,
)
from restitution.contact.checks.resolution import NODES_PER_PATCH
from restitution.display import quantity
from restitution.plots.cor import IMPACT_VELOCITY, INDENTATION, Abscissa, bars, cor_chart, onset
from restitution.plots.figure import (
    DASH_DOTTED,
    DASHED,
    DOTTED,
    GREY,
    ORANGE,
    SOLID,
    Array,
    Axis,
    Band,
    Chart,
    Colours,
    Figure,
    Line,
    Map,
    Mark,
    Points,
    Series,
)
from restitution.plots.oblique import has_oblique, oblique_figure

MODEL_BAND = "± error of the model"
UNRESOLVED = f"open: not resolved (patches of under {NODES_PER_PATCH} nodes)"

_MARGIN = 1.2  # factor by which a logarithmic axis extends beyond the first and the last point
_RIM = 4  # number of nodes between the contact and each edge of its map
_UNIFORM = 0.01  # pressures with a smaller relative difference count as equal

# If a contact yields, and at least this fraction of its area is at the largest pressure, the
# pressure map is left out.
_SATURATED = 0.95
_SMOOTH = "smooth, same model"
_REFERENCES = {
    INDENTATION: restitution_references_by_indentation,
    IMPACT_VELOCITY: restitution_references_by_velocity,
}
_DASHES = (DOTTED, DASH_DOTTED, DASHED, SOLID)  # line styles of the coarser grids, coarsest first


def run_figures(results: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    if results.sizes["indentation_max"] == 0:
        return
    yield "load-displacement", load_displacement(results)
    for abscissa in abscissae(results):
        yield f"restitution-{abscissa.name}", restitution_figure(results, abscissa)
    if has_map(results):
        yield "pressure", pressure_map(results)
    if has_patches(results):
        yield "patch-law", patch_law(results)
    if has_oblique(results):
        yield "oblique", oblique_figure(results)


def abscissae(results: xr.Dataset) -> list[Abscissa]:
    """Return the x axes of the COR figures; `results` must contain at least one depth."""
    impacts = (results["impact_velocity"] > 0).any()
    return [INDENTATION, IMPACT_VELOCITY] if impacts else [INDENTATION]


def has_map(results: xr.Dataset) -> bool:
    """Whether `results` contain a contact map; those of an ensemble do not."""
    return "pressure" in results and bool(results["pressure"].any())


def has_patches(results: xr.Dataset) -> bool:
    """Whether `results` contain the law of waves below the grid."""
    return "patch_pressure" in results


def patch_law(results: xr.Dataset) -> Figure:
    """Draw the law of waves below the grid: pressure against gap."""
    gap, pressure = 1e9 * results["patch_gap"].values, 1e-6 * results["patch_pressure"].values
    zero = [Mark("y", 0.0)] if pressure.min() < 0 else []
    linear = Chart(
        Axis("gap of the mean planes", "nm"),
        Axis("nominal pressure", "MPa"),
        [Line(gap, pressure, "loading"), *zero],
    )
    return Figure(results.attrs.get("title", ""), [linear])


def load_displacement(results: xr.Dataset) -> Figure:
    depth, force = 1e6 * results["indentation"].values, results["force"].values
    references = _references(force_references(results), 1e6)
    if "smooth_force" in results and results.attrs["derived_yield_pressure_Pa"] != "None":
        x, y = 1e6 * results["smooth_indentation"].values, results["smooth_force"].values
        references.insert(0, Line(x, y, _SMOOTH, color=GREY))
    back = unloading_lines(results)
    loading = Points(np.append(0, depth), np.append(0, force), "loading", joined=True)
    across, up = (_span([loading, *back], name) for name in ("x", "y"))
    linear = Chart(
        Axis("indentation", "µm", low=across[0], high=across[1]),
        Axis("normal force", "N", low=up[0], high=up[1]),
        [loading, *back, *references, *([Mark("y", 0.0)] if up[0] < 0 else [])],
    )
    carrying = force[force > 0]
    ends = (0.3 * carrying.min(), 2 * carrying.max()) if carrying.size else (None, None)
    shown = [depth, *(line.x[(line.x > 0) & (line.y >= (ends[0] or 0))] for line in back)]
    logarithmic = Chart(
        Axis("indentation", "µm", "log", 0.8 * np.concatenate(shown).min(), 1.3 * depth.max()),
        Axis("normal force", "N", "log", *ends),
        [
            Points(depth, force, "loading", joined=True),
            *(
                Line(line.x[line.y > 0], line.y[line.y > 0], line.label, line.name, line.color)
                for line in back
            ),
            *references,
        ],
        title="on logarithmic axes",
    )
    return Figure(results.attrs.get("title", ""), [linear, logarithmic])


def pressure_map(results: xr.Dataset) -> Figure:
    """Draw pressure (unless it is nearly uniform) and plastic displacement at the deepest depth."""
    pressure = 1e-6 * results["pressure"].values
    depth = results.get("plastic_displacement", xr.zeros_like(results["pressure"])).values
    touched, yields = (pressure != 0) | (depth != 0), bool(depth.any())
    where = f"at an indentation of {quantity(float(results['indentation'].max()), 'm')}"
    share = float(np.mean(pressure[touched] > (1 - _UNIFORM) * pressure.max()))
    saturated = yields and share >= _SATURATED
    maps: list[tuple[Axis, Array, Colours, str]] = []
    if not saturated:
        axis = Axis("pressure", "MPa")
        maps.append((axis, np.where(touched, pressure, np.nan), "viridis", f"pressure {where}"))
    if yields:
        scale, unit = (1e6, "µm") if depth.max() >= 1e-6 else (1e9, "nm")
        title = f"plastic displacement {where}"
        if saturated:
            title += f"; {100 * share:.3g} % of the contact at the yield pressure, "
            title += f"{pressure.max():.4g} MPa"
        axis = Axis("plastic displacement", unit)
        maps.append((axis, np.where(touched, scale * depth, np.nan), "magma", title))
    nodes = np.argwhere(touched)
    low, high = np.maximum(nodes.min(axis=0) - _RIM, 0), nodes.max(axis=0) + _RIM + 1
    x, y = (slice(*ends) for ends in zip(low, high, strict=True))
    down = results.attrs.get("surface_y_axis") == "down"
    X, Y = 1e6 * results["x"].values[x], 1e6 * results["y"].values[y]
    panels = [
        Map(X, Y, values[x, y], axis, colours, title, down) for axis, values, colours, title in maps
    ]
    return Figure(results.attrs.get("title", ""), panels)


def restitution_figure(results: xr.Dataset, abscissa: Abscissa) -> Figure:
    scale, variable = abscissa.scale, abscissa.variable
    x, cor = scale * results[variable].values, results["restitution"].values
    series: list[Series] = []
    label = "this contact"
    if "restitution_std" in results:
        label = f"mean of {results['realisations'].values.max():.0f} surfaces"
        low, high = (results[f"restitution_{end}"].values for end in ("low", "high"))
        std = results["restitution_std"].values
        series.append(Band(x, low, high, "95 % interval of the mean"))
        series += [
            Line(x, cor + sign * std, "± standard deviation", dash=DOTTED) for sign in (1, -1)
        ]
    series += [
        Line(x, coarser.values, f"refine = {int(coarser['refine'])}", color=ORANGE, dash=dash)
        for coarser, dash in zip(results.get("coarser_restitution", ()), _DASHES, strict=False)
    ]
    model = results["model_error"].values
    if np.nanmax(model, initial=0.0) > 0:
        low, high = np.clip(cor - model, 0.0, 1.0), np.clip(cor + model, 0.0, 1.0)
        series.append(Band(x, low, high, MODEL_BAND, GREY, DOTTED))
    error, error_label = bars(cor, results["total_error"].values)
    series.append(
        Points(
            x,
            cor,
            label,
            joined=True,
            error=error,
            error_label=error_label,
            open=~results["resolved"].values.astype(bool),
            open_label=UNRESOLVED,
            via=_onset(results, abscissa),
        )
    )
    with_losses = results["restitution_with_losses"].values
    if (with_losses < cor).any():
        series.append(Line(x, with_losses, "with plate, waves and viscosity", dash=DASH_DOTTED))
    if {f"smooth_{variable}", "smooth_restitution"} <= set(results.variables):
        smooth = scale * results[f"smooth_{variable}"].values
        series.append(Line(smooth, results["smooth_restitution"].values, _SMOOTH, color=GREY))
    series += _references(_REFERENCES[abscissa](results), scale)
    inside = x[x > 0]
    axis = replace(abscissa.axis, low=inside.min() / _MARGIN, high=inside.max() * _MARGIN)
    return Figure(results.attrs.get("title", ""), [cor_chart(axis, series)])


def _onset(results: xr.Dataset, abscissa: Abscissa) -> tuple[Array, Array] | None:
    """Points of the curve at the sticking velocity (`onset`), on the axis `abscissa`."""
    V, e = results["impact_velocity"].values, results["restitution"].values
    known = np.isfinite(e) & (V > 0)
    V, e = V[known], e[known]
    between, onset_of = onset(V, e)
    if not between.size:
        return None
    values = results[abscissa.variable].values[known]
    x = np.exp(np.interp(np.log(between), np.log(V), np.log(values)))
    return abscissa.scale * x, onset_of


def _references(references: list[Reference], scale: float) -> list[Series]:
    return [
        Line(
            scale * reference.x,
            reference.y,
            reference.label,
            color=GREY,
            dash=DASHED if reference.yields else DOTTED,
        )
        for reference in references
    ]


def unloading_lines(results: xr.Dataset) -> list[Line]:
    """Make a line of each unloading curve, without the NaN values that pad it."""
    lines = []
    for k in range(results.sizes.get("unloading", 0)):
        x, y = (results[f"unloading_{name}"][k].values for name in ("indentation", "force"))
        known, start = np.isfinite(y), 1e6 * float(results["unloading_from"][k])
        name = f"unloading from {start:.3g} µm"
        lines.append(Line(1e6 * x[known], y[known], "unloading", name, ORANGE))
    return lines


def _span(series: list[Points | Line], name: str) -> tuple[float, float | None]:
    """The ends of an axis with a margin; the upper end is None if all values are zero."""
    values: Array = np.concatenate([getattr(part, name) for part in series])
    low, high = float(values.min()), float(values.max())
    margin = 0.05 * (high - low)
    return (low - margin if low < 0 else 0.0), (high + margin or None)


_SHOWN = 4  # number of depths that are drawn


def depth_maps_figure(maps: xr.Dataset, title: str, *, downwards: bool = False) -> Figure:
    """Draw the pressure at up to four depths of `maps`, on one part of the grid."""
    pressure = maps["pressure"]
    along = str(pressure.dims[0])
    touched = np.argwhere(pressure.values.any(axis=0))
    if not touched.size:
        return Figure(title, [])
    low, high = np.maximum(touched.min(axis=0) - _RIM, 0), touched.max(axis=0) + _RIM + 1
    x, y = (slice(*ends) for ends in zip(low, high, strict=True))
    X, Y = 1e6 * maps["x"].values[x], 1e6 * maps["y"].values[y]
    count = maps.sizes[along]
    panels = []
    for number in np.unique(np.linspace(0, count - 1, _SHOWN).round().astype(int)):
        values = 1e-6 * pressure.values[number, x, y]
        depth = quantity(float(maps[along][number]), "m")
        shown = np.where(values != 0, values, np.nan)
        axis = Axis("pressure", "MPa")
        panels.append(Map(X, Y, shown, axis, title=f"at {depth}", downwards=downwards))
    return Figure(title, panels)
