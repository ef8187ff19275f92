"""The page of one run, ensemble or convergence, from its stored results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from plotly.graph_objects import Heatmap, Scatter

from restitution.contact.checks.resolution import NODES_PER_PATCH
from restitution.reports.methods import methods
from restitution.reports.page import Cell, Drawing, Listing, Page, Table, new_plot, write_page
from restitution.results.reader import EnsembleResults, RunResults, read_run

_MOST_PIXELS = 320  # of a map, along either axis: more are skipped
_MARGIN = 1.2  # of a logarithmic axis beyond the first and the last point
_SMOOTH = "smooth, same model"


def write_run_page(out: Path) -> Path:
    """Write `report.html` from the `results.nc` and `summary.json` in `out`."""
    run = read_run(out)
    results, summary = run.dataset, run.summary
    parts: list[Table | Drawing | Listing] = []
    if results.sizes["indentation_max"]:
        parts += [against_depth(results), force(results)]
        if (results["impact_velocity"] > 0).any():
            parts.insert(1, against_velocity(results))
        if "pressure" in results and results["pressure"].any():
            parts.append(_pressure(results))
    parts += [
        _trust(results, summary),
        *_groups(summary),
        Listing("Case file", results.attrs["case"]),
        methods(summary),
    ]
    page = Page(
        title=summary["title"] or "Restitution",
        intro=[_in_words(run)],
        warnings=summary["warnings"],
        parts=parts,
    )
    write_page(out / "report.html", page)
    return out / "report.html"


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
    return f"{what}; {nx} × {ny} nodes of {1e6 * h:.4g} µm{ended}"


def against_depth(results: xr.Dataset) -> Drawing:
    """COR against maximum indentation."""
    return _restitution(results, "indentation", 1e6, "maximum indentation", "µm")


def against_velocity(results: xr.Dataset) -> Drawing:
    """COR against impact velocity."""
    return _restitution(results, "impact_velocity", 1.0, "impact velocity", "m/s")


def _restitution(
    results: xr.Dataset, variable: str, scale: float, words: str, unit: str
) -> Drawing:
    x, cor = scale * results[variable].values, results["restitution"].values
    resolved = results["resolved"].values.astype(bool)
    plot = new_plot(f"{words} ({unit})", "coefficient of restitution")
    plot.update_xaxes(type="log", exponentformat="power")
    plot.update_yaxes(range=[0, 1.05])
    inside = x[x > 0]
    if inside.size:
        ends = np.log10([inside.min() / _MARGIN, inside.max() * _MARGIN])
        plot.update_xaxes(range=ends.tolist())
    smooth = {"indentation": "smooth_indentation", "impact_velocity": "smooth_impact_velocity"}
    if smooth[variable] in results:
        plot.add_trace(
            Scatter(x=scale * results[smooth[variable]].values,
                    y=results["smooth_restitution"].values, mode="lines", name=_SMOOTH,
                    line={"color": "#8c959f"})
        )  # fmt: skip
    if "restitution_low" in results:
        for name, fill in (("restitution_low", None), ("restitution_high", "tonexty")):
            plot.add_trace(
                Scatter(x=x, y=results[name].values, mode="lines", line={"width": 0}, fill=fill,
                        fillcolor="rgba(31,119,180,0.25)", hoverinfo="skip",
                        name="95 % interval of the mean", showlegend=fill is not None)
            )  # fmt: skip
    error = results["total_error"].values
    plot.add_trace(
        Scatter(
            x=x, y=cor, mode="lines+markers", name="this contact",
            line={"color": "#1f77b4"},
            marker={"symbol": ["circle" if good else "circle-open" for good in resolved],
                    "size": 8},
            error_y={"array": error, "visible": bool(np.isfinite(error).any())},
            hovertemplate=f"%{{x:.4g}} {unit}<br>COR %{{y:.4f}}<extra></extra>",
        )
    )  # fmt: skip
    columns = [
        f"{words} ({unit})",
        "COR",
        "resolved",
        "restitution_error",
        "total_error",
        "model_error",
    ]
    few = int(np.count_nonzero(~resolved))
    return Drawing(
        f"Restitution against {words}",
        plot,
        f"Coefficient of restitution from {np.nanmin(cor):.3f} to {np.nanmax(cor):.3f} against "
        f"{words} from {np.nanmin(x):.3g} to {np.nanmax(x):.3g} {unit}",
        f"Open markers ({few} of {cor.size}): not resolved, half of the contact is in patches of "
        f"fewer than {NODES_PER_PATCH} nodes.",
        Table(
            "Restitution",
            columns,
            [
                [float(a), float(b), "yes" if good else "no", float(e), float(d), float(m)]
                for a, b, good, e, d, m in zip(
                    x,
                    cor,
                    resolved,
                    results["restitution_error"].values,
                    error,
                    results["model_error"].values,
                    strict=True,
                )
            ],
        ),
    )


def force(results: xr.Dataset) -> Drawing:
    """Force against indentation, loading and unloading."""
    plot = new_plot("indentation (µm)", "normal force (N)")
    depth, load = 1e6 * results["indentation"].values, results["force"].values
    rows: list[list[Cell]] = [
        ["loading", float(d), float(f)] for d, f in zip(depth, load, strict=True)
    ]
    plot.add_trace(Scatter(x=depth, y=load, mode="lines+markers", name="loading"))
    for k in range(results.sizes.get("unloading", 0)):
        x = 1e6 * results["unloading_indentation"][k].values
        y = results["unloading_force"][k].values
        name = f"unloading from {1e6 * float(results['unloading_from'][k]):.3g} µm"
        plot.add_trace(Scatter(x=x, y=y, mode="lines", name=name))
        rows += [[name, float(d), float(f)] for d, f in zip(x, y, strict=True) if f == f]
    if "smooth_force" in results:
        plot.add_trace(
            Scatter(x=1e6 * results["smooth_indentation"].values, y=results["smooth_force"].values,
                    mode="lines", name=_SMOOTH, line={"color": "#8c959f"})
        )  # fmt: skip
    return Drawing(
        "Load and displacement",
        plot,
        f"Normal force against indentation, up to {load.max():.4g} N at {depth.max():.4g} µm",
        "Loading, and the way back from some of the depths.",
        Table("Curves", ["curve", "indentation (µm)", "force (N)"], rows),
    )


def _pressure(results: xr.Dataset) -> Drawing:
    pressure = results["pressure"]
    touching = np.argwhere(pressure.values != 0)
    low, high = np.maximum(touching.min(axis=0) - 4, 0), touching.max(axis=0) + 5
    step = -(-int((high - low).max()) // _MOST_PIXELS)
    part = pressure[low[0] : high[0] : step, low[1] : high[1] : step]
    values = 1e-6 * part.where(part != 0).values
    plot = new_plot("x (µm)", "y (µm)")
    plot.add_trace(
        Heatmap(x=1e6 * part["x"].values, y=1e6 * part["y"].values, z=values.T.astype(np.float32),
                colorscale="Viridis", colorbar={"title": "MPa"},
                hovertemplate="x %{x:.4g} µm, y %{y:.4g} µm<br>%{z:.4g} MPa<extra></extra>")
    )  # fmt: skip
    plot.update_yaxes(scaleanchor="x", constrain="domain")
    plot.update_xaxes(constrain="domain")
    if results.attrs.get("surface_y_axis") == "down":
        plot.update_yaxes(autorange="reversed")
    share = [10, 50, 90, 100]
    pressed = pressure.values[pressure.values != 0]
    return Drawing(
        "Contact pressure",
        plot,
        f"Map of the contact pressure at the deepest point, up to {1e-6 * pressed.max():.4g} MPa",
        "At the deepest point; where nothing is drawn there is no contact.",
        Table(
            "Distribution of the pressure over the contact",
            ["percentile", "pressure (MPa)"],
            [[s, float(1e-6 * np.percentile(pressed, s))] for s in share],
        ),
        square=True,
    )


def _trust(results: xr.Dataset, summary: Mapping[str, Any]) -> Table:
    trust = {key: value for key, value in summary["trust"].items() if not isinstance(value, list)}
    rows: list[list[Cell]] = [[key.replace("_", " "), value] for key, value in trust.items()]
    resolved = results["resolved"].values.astype(bool)
    rows.append(["depths resolved", f"{np.count_nonzero(resolved)} of {resolved.size}"])
    if summary.get("observed_order") is not None:
        rows.append(["observed order of convergence", summary["observed_order"]])
    rows.append(["convolutions", summary["convolutions"]])
    return Table("Trust", ["what", "value"], rows)


def _groups(summary: Mapping[str, Any]) -> list[Table]:
    tables = []
    for key, title in (
        ("derived", "Derived quantities"), ("surface_statistics", "Surface"),
        ("surface", "How the surface was made"), ("model", "Model"), ("conventions", "Conventions"),
    ):  # fmt: skip
        if group := summary.get(key):
            rows = [[name, _shown(value)] for name, value in group.items()]
            tables.append(Table(title, ["what", "value"], rows))
    return tables


def _shown(value: Any) -> Cell:
    if isinstance(value, bool) or not isinstance(value, (int, float, type(None))):
        return str(value)
    return value
