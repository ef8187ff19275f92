"""The page of a run, ensemble or convergence study."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from restitution.case.omissions import default_yield
from restitution.contact.checks.resolution import NODES_PER_PATCH
from restitution.curve.oblique import ObliquePoint
from restitution.display import quantity
from restitution.losses.losses import NAMES
from restitution.pages.answer import answer_of
from restitution.pages.methods import methods
from restitution.pages.page import Cell, Drawing, Listing, Page, PageTable, write_page
from restitution.pages.run_in import run_in_parts
from restitution.pages.scans import of_scans
from restitution.pages.words import column_unit, table_of
from restitution.plots.cor import Abscissa
from restitution.plots.oblique import has_oblique, oblique_figure
from restitution.plots.run import (
    abscissae,
    depth_maps_figure,
    has_map,
    has_patches,
    load_displacement,
    patch_law,
    pressure_map,
    restitution_figure,
    unloading_lines,
)
from restitution.results.reader import EnsembleResults, RunResults, read_run
from restitution.results.tables import has_maps


def write_run_page(out: Path, velocity: float | None = None) -> Path:
    """Write `report.html` from the `results.nc` and `summary.json` in `out`."""
    run = read_run(out)
    results, summary = run.dataset, run.summary
    top: list[Drawing] = []
    parts: list[PageTable | Drawing | Listing] = []
    details: list[PageTable | Listing] = []
    if results.sizes["indentation_max"]:
        top = [_restitution(results, abscissa) for abscissa in reversed(abscissae(results))]
        parts.append(_force(results))
        if run.oblique and has_oblique(results):
            parts.append(_oblique_drawing(results, run.oblique))
        if run.run_in:
            worn, impacts, surfaces = run_in_parts(run.run_in, run.impacts, summary["run_in"])
            top, parts = [worn, top[0]], [impacts, *top[1:], *parts]
            details = [surfaces]
        if has_patches(results):
            parts.append(_patches(results))
        if has_map(results):
            parts.append(_pressure(results))
        if has_maps(out):
            parts.append(maps_drawing(run.maps, results))
    page = Page(
        title=summary["title"] or "Restitution",
        intro=list(filter(None, (_in_words(run), default_yield(_yield_source(summary))))),
        warnings=summary["warnings"],
        answer=answer_of(run, velocity),
        top=top,
        parts=parts,
        details=[
            *details,
            *of_scans(summary.get("surface", {})),
            *groups(summary),
            _diagnostics(results, summary),
            Listing("Case file", results.attrs["case"]),
            methods(summary),
        ],
    )
    return write_page(out / "report.html", page)


def _yield_source(summary: Mapping[str, Any]) -> str:
    return str(summary["model"].get("yield_pressure", "given"))


def _in_words(run: RunResults) -> str:
    summary = run.summary
    nx, ny = summary["model"]["nodes"]
    h = summary["model"]["spacing"][0]
    what = f"{summary['depths_computed']} of {summary['depths_asked']} depths"
    if isinstance(run, EnsembleResults):
        what += f", means of {run.surfaces} surfaces"
    if "grids" in summary:
        what += f", on grids refined {', '.join(map(str, summary['grids']))} times"
    ended = "" if summary["status"] == "complete" else f"; {summary['status']}: {summary['reason']}"
    return f"{what}; {nx} × {ny} nodes, spacing {quantity(h, 'm')}{ended}"


def _span(values: NDArray[np.float64], digits: str) -> str:
    """The smallest and the largest known value in words; "" if none is known."""
    known = values[~np.isnan(values)]
    return f" from {known.min():{digits}} to {known.max():{digits}}" if known.size else ""


_ERRORS = {
    "restitution_error": "± solver",
    "total_error": "± total",
    "model_error": "± model",
    "restitution_with_losses": "COR with losses",
} | {f"{name}_factor": f"factor of {name}" for name in NAMES}


def _restitution(results: xr.Dataset, abscissa: Abscissa) -> Drawing:
    words, unit = abscissa.axis.label, abscissa.axis.unit
    x = abscissa.scale * results[abscissa.variable].values
    cor = results["restitution"].values
    resolved = results["resolved"].values.astype(bool)
    errors = ["restitution_error", "total_error", "model_error"]
    if (results["restitution_with_losses"].values < cor).any():
        errors += ["restitution_with_losses", *(f"{name}_factor" for name in NAMES)]
    columns = zip(x, cor, resolved, *(results[name].values for name in errors), strict=True)
    few = int(np.count_nonzero(~resolved))
    return Drawing(
        f"Restitution against {words}",
        restitution_figure(results, abscissa),
        f"Coefficient of restitution{_span(cor, '.3f')} against {words}{_span(x, '.3g')} {unit}",
        f"Open markers ({few} of {cor.size}): not resolved by the grid, because at least half of "
        f"the contact is in patches of fewer than {NODES_PER_PATCH} nodes, or the cells are too "
        "large for adhesion."
        if few
        else "The grid resolves the contact at every point.",
        PageTable(
            "Restitution",
            [abscissa.axis.title, "COR", "resolved", *(_ERRORS[name] for name in errors)],
            [
                [float(a), _rounded(b), "yes" if good else "no", *map(_rounded, of_cor)]
                for a, b, good, *of_cor in columns
            ],
        ),
    )


def _rounded(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.4f}"


def _force(results: xr.Dataset) -> Drawing:
    depth, load = 1e6 * results["indentation"].values, results["force"].values
    scale, unit = column_unit(load, "N")
    rows: list[list[Cell]] = [
        ["loading", float(d), scale * float(f)] for d, f in zip(depth, load, strict=True)
    ]
    unloading = list(unloading_lines(results))
    for line in unloading:
        rows += [
            [line.name, float(d), scale * float(f)] for d, f in zip(line.x, line.y, strict=True)
        ]
    return Drawing(
        "Load and displacement",
        load_displacement(results),
        f"Normal force against indentation, up to {quantity(load.max(), 'N')} at "
        f"{quantity(1e-6 * depth.max(), 'm')}",
        f"The loading curve{', and unloading curves from some of the depths' * bool(unloading)}.",
        PageTable("Curves", ["curve", "indentation (µm)", f"force ({unit})"], rows),
    )


def _patches(results: xr.Dataset) -> Drawing:
    gap, pressure = 1e9 * results["patch_gap"].values, 1e-6 * results["patch_pressure"].values
    return Drawing(
        "Waves below the grid",
        patch_law(results),
        f"Nominal pressure of the patches against the gap of their mean planes, from "
        f"{pressure.min():.3g} to {pressure.max():.3g} MPa",
        "The law of the waves that the grid does not carry, solved on periodic patches. Tension is "
        "negative.",
        PageTable(
            "Law of the patches",
            ["gap (nm)", "pressure (MPa)"],
            [[float(g), float(p)] for g, p in zip(gap[::20], pressure[::20], strict=True)],
        ),
    )


def _pressure(results: xr.Dataset) -> Drawing:
    lowered = "plastic_displacement" in results and bool(results["plastic_displacement"].any())
    yields = " Plastic displacement: the depth by which yielding has lowered the surface."
    most = quantity(float(results["pressure"].max()), "Pa")
    return Drawing(
        "Contact pressure",
        pressure_map(results),
        f"Map of the contact pressure at the largest indentation, up to {most}",
        f"At the largest indentation; areas without contact are blank.{yields * lowered}",
        pressure_percentiles(results),
    )


def maps_drawing(maps: xr.Dataset, results: xr.Dataset) -> Drawing:
    depth = str(maps["pressure"].dims[0])
    largest = [maps[name].max(("x", "y")).values for name in ("pressure", "plastic_displacement")]
    title, down = results.attrs.get("title", ""), results.attrs.get("surface_y_axis") == "down"
    return Drawing(
        "Contact pressure at several depths",
        depth_maps_figure(maps, title, downwards=down),
        f"Maps of the contact pressure, up to {quantity(largest[0].max(), 'Pa')}",
        f"All {maps.sizes[depth]} depths are in maps.nc.",
        PageTable(
            "Largest values of each depth",
            ["indentation (nm)", "pressure (MPa)", "plastic displacement (nm)"],
            np.column_stack(
                [1e9 * maps[depth].values, 1e-6 * largest[0], 1e9 * largest[1]]
            ).tolist(),
        ),
    )


def pressure_percentiles(results: xr.Dataset) -> PageTable:
    columns = {
        f"{words} ({unit})": scale * results[name].values[results[name].values != 0]
        for name, words, scale, unit in (
            ("pressure", "pressure", 1e-6, "MPa"),
            ("plastic_displacement", "plastic displacement", 1e6, "µm"),
        )
        if name in results and results[name].values.any()
    }
    return PageTable(
        "Distribution over the contact",
        ["percentile", *columns],
        [
            [share, *(float(np.percentile(values, share)) for values in columns.values())]
            for share in (10, 50, 90, 100)
        ],
    )


def _diagnostics(results: xr.Dataset, summary: Mapping[str, Any]) -> PageTable:
    resolved = results["resolved"].values.astype(bool)
    values = {k: v for k, v in summary["diagnostics"].items() if not isinstance(v, list)}
    values["depths_resolved"] = f"{np.count_nonzero(resolved)} of {resolved.size}"
    if summary.get("observed_order") is not None:
        values["observed_order_of_convergence"] = summary["observed_order"]
    return table_of("Diagnostics", values | {"convolutions": summary["convolutions"]})


def groups(summary: Mapping[str, Any]) -> Iterator[PageTable]:
    for key, title in (
        ("derived", "Derived quantities"),
        ("surface_statistics", "Surface"),
        ("surface", "Origin of the surface"),
        ("model", "Model"),
        ("conventions", "Conventions"),
    ):
        if group := summary.get(key):
            yield table_of(title, group)


_NOTE = (
    "Tangential restitution and angles refer to the velocity of the centres. Spins are positive in "
    "the direction in which friction turns a body without spin. The dotted line marks the angle "
    "from which the whole contact slides. The error of the tangential restitution e_t includes the "
    "errors of the tangential law and of the normal restitution e_n."
)


def _oblique_drawing(results: xr.Dataset, points: Sequence[ObliquePoint]) -> Drawing:
    known = [e_t for point in points if not math.isnan(e_t := point.tangential_restitution)]
    ends = f"from {min(known):.3f} to {max(known):.3f} " if known else ""
    cells: list[list[Cell]] = [
        [
            point.velocity,
            math.degrees(point.angle),
            point.normal_restitution,
            point.tangential_restitution,
            point.tangential_restitution_error,
            math.degrees(point.rebound_angle),
            point.first_spin,
            point.second_spin,
            point.friction_loss,
            point.normal_loss,
            "yes" if point.slides else "no",
        ]
        for point in points
    ]
    return Drawing(
        "Oblique impacts",
        oblique_figure(results),
        f"Tangential restitution {ends}against the angle of impact, angle of rebound and spin",
        _NOTE,
        PageTable(
            "Oblique impacts",
            [
                "velocity (m/s)",
                "angle (°)",
                "e_n",
                "e_t",
                "± e_t",
                "rebound (°)",
                "first spin (rad/s)",
                "second spin (rad/s)",
                "friction loss (J)",
                "normal loss (J)",
                "slides",
            ],
            cells,
        ),
    )
