"""Figures of one run, drawn from its stored results alone."""

from __future__ import annotations

import textwrap
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from restitution.contact.checks.resolution import NODES_PER_PATCH
from restitution.results.reader import RunResults
from restitution.results.writer import replace_file
from restitution.theory import JKR, AdhesiveThorntonNing, Hertz, ImpactLaw, ThorntonNing

_SIZE = (6.4, 4.4)
_WIDE = (10.4, 4.4)
_DASHES = (":", "-.", "--", "-")  # of coarser grids, the coarsest first
_SMOOTH = "smooth, same model"
_THORNTON_NING = "smooth, Thornton–Ning (truncated pressure)"
_UNRESOLVED = f"open: not resolved (patches below {NODES_PER_PATCH} nodes)"


def write_figures(out: Path) -> list[Path]:
    """Draw every figure that the `results.nc` in `out` supports; return the files written."""
    results = RunResults(out).dataset
    written = []
    for name, figure in figures(results):
        path = out / f"{name}.png"
        write_figure(path, figure)
        written.append(path)
    return written


def write_figure(path: Path, figure: Figure) -> None:
    """Write one figure as PNG, all of it or nothing."""
    FigureCanvasAgg(figure)
    with warnings.catch_warnings():
        # A title may be in a script that the font does not have: boxes are all it can get.
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        replace_file(path, lambda to: figure.savefig(to, format="png", dpi=150))


def figures(results: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    """Name and figure, one after another."""
    if results.sizes["indentation_max"] == 0:
        return
    yield "load-displacement", load_displacement(results)
    yield "restitution-indentation", restitution_against_indentation(results)
    if (results["impact_velocity"] > 0).any():
        yield "restitution-velocity", restitution_against_velocity(results)
    if "pressure" in results and results["pressure"].any():  # none of a mean of surfaces
        yield "pressure", pressure_map(results)


def load_displacement(results: xr.Dataset) -> Figure:
    """Force against indentation, loading and unloading; again on logarithmic axes."""
    figure = Figure(figsize=_WIDE, layout="constrained")
    linear, logarithmic = figure.subplots(1, 2)
    depth, force = results["indentation"].values, results["force"].values
    unloading = range(results.sizes.get("unloading", 0))
    R, E_star, p_y = _parameters(results)
    w = _work_of_adhesion(results)
    low = min([depth.min(), *(_last_carrying(results, k) for k in unloading)])
    lowest = np.nanmin(results["unloading_force"].values, initial=0.0) if unloading else 0.0
    fine = np.geomspace(0.7 * low, depth.max(), 400)
    for axes, start in ((linear, np.zeros(1)), (logarithmic, np.empty(0))):
        axes.plot(1e6 * np.append(start, depth), np.append(start, force), "o-", ms=3.5,
                  color="C0", label="loading")  # fmt: skip
        for k in unloading:
            x, y = results["unloading_indentation"][k].values, results["unloading_force"][k].values
            shown = y > 0 if axes is logarithmic else np.isfinite(y)
            axes.plot(1e6 * x[shown], y[shown], "-", color="C1",
                      label="unloading" if k == 0 else None)  # fmt: skip
        if "smooth_force" in results and np.isfinite(p_y):
            axes.plot(1e6 * results["smooth_indentation"], results["smooth_force"], "-", lw=1,
                      color="0.4", label=_SMOOTH)  # fmt: skip
        if w > 0:
            jkr = JKR(R, E_star, w)
            reach = np.append(np.linspace(float(jkr.break_indentation), 0, 60), fine)
            elastic, law = jkr.force(reach), "JKR, smooth elastic"
        else:
            reach, elastic, law = fine, Hertz(R, E_star).force(fine), "Hertz, smooth"
        shown = elastic <= 1.3 * force.max()
        axes.plot(1e6 * reach[shown], elastic[shown], ":", color="0.4", label=law)
        if np.isfinite(p_y):
            axes.plot(1e6 * fine, ThorntonNing(R, E_star, p_y).loading_force(fine), "--",
                      color="0.4", label=_THORNTON_NING)  # fmt: skip
        axes.set(xlabel="indentation (µm)", ylabel="normal force (N)")
    linear.set_title(plain(results.attrs.get("title", "")))
    if lowest >= 0:
        linear.set_xlim(left=0)
        linear.set_ylim(bottom=0)
    linear.axhline(0, color="0.8", lw=0.6, zorder=0)
    linear.legend(edgecolor="none", fontsize="small")
    logarithmic.set_title("the same, logarithmic")
    logarithmic.set(xscale="log", yscale="log")
    logarithmic.set_xlim(0.7e6 * low, 1.3e6 * depth.max())
    carrying = force[force > 0]
    if carrying.size:
        logarithmic.set_ylim(0.3 * carrying.min(), 2 * carrying.max())
    return figure


def restitution_against_indentation(results: xr.Dataset) -> Figure:
    """Coefficient of restitution against maximum indentation."""
    figure, axes = _axes(results, "maximum indentation (µm)", "coefficient of restitution")
    depth = results["indentation"].values
    _plot_restitution(axes, results, 1e6 * depth)
    _plot_smooth(axes, results, "smooth_indentation", 1e6)
    R, E_star, p_y = _parameters(results)
    if np.isfinite(p_y):
        fine = _between(depth)
        reference = ThorntonNing(R, E_star, p_y).restitution_at_indentation(fine)
        axes.plot(1e6 * fine, reference, "--", color="0.4", label=_THORNTON_NING)
    if (w := _work_of_adhesion(results)) > 0:
        fine = _between(depth)
        reference = JKR(R, E_star, w).restitution_at_indentation(fine)
        axes.plot(1e6 * fine, reference, ":", color="0.4", label="JKR, smooth elastic")
    figure.legend(frameon=False, fontsize="small", loc="outside lower center", ncols=2)
    return figure


def restitution_against_velocity(results: xr.Dataset) -> Figure:
    """Coefficient of restitution against impact velocity."""
    figure, axes = _axes(results, "impact velocity (m/s)", "coefficient of restitution")
    velocity = results["impact_velocity"].values
    _plot_restitution(axes, results, velocity)
    _plot_smooth(axes, results, "smooth_impact_velocity", 1.0)
    R, E_star, p_y = _parameters(results)
    w, fine = _work_of_adhesion(results), _between(velocity)
    mass = float(results.attrs["derived_reduced_mass_kg"])
    law: ImpactLaw | None = None
    if w > 0 and np.isfinite(p_y):
        # Where adhesion and yield do not simply add, this law has no answer and no line.
        law = AdhesiveThorntonNing(R, E_star, p_y, w)
        label = "smooth, Thornton–Ning with adhesion"
    elif w > 0:
        law, label = JKR(R, E_star, w), "JKR, smooth elastic"
    elif np.isfinite(p_y):
        law, label = ThorntonNing(R, E_star, p_y), _THORNTON_NING
    if law is not None:
        axes.plot(fine, law.restitution(fine, mass), "--", color="0.4", label=label)
    figure.legend(frameon=False, fontsize="small", loc="outside lower center", ncols=2)
    return figure


def pressure_map(results: xr.Dataset) -> Figure:
    """Contact pressure at the deepest point, on the part of the grid that is in contact."""
    pressure = results["pressure"]
    touching = np.argwhere(pressure.values != 0)
    low = np.maximum(touching.min(axis=0) - 4, 0)
    high = touching.max(axis=0) + 5
    part = pressure[low[0] : high[0], low[1] : high[1]]
    depth = float(results["indentation"].max())
    figure, axes = _axes(results, "x (µm)", "y (µm)", size=(5.6, 4.8))
    if results.attrs.get("surface_y_axis") == "down":
        axes.invert_yaxis()
    return _map(
        figure, axes, part.where(part != 0), 1e-6, "viridis",
        f"pressure (MPa) at an indentation of {1e6 * depth:.3g} µm",
    )  # fmt: skip


def surface_map(height: xr.DataArray, title: str, y_axis: str = "up") -> Figure:
    """Heights of a surface, with a colour bar in micrometres; `y_axis` runs "up" or "down"."""
    figure = Figure(figsize=(5.6, 4.8), layout="constrained")
    axes = figure.add_subplot()
    axes.set(xlabel="x (µm)", ylabel="y (µm)", title=plain(title))
    if y_axis == "down":
        axes.invert_yaxis()
    return _map(figure, axes, height, 1e6, "cividis", "height (µm)")


def _map(
    figure: Figure, axes: Axes, values: xr.DataArray, scale: float, colours: str, label: str
) -> Figure:
    downwards = axes.yaxis_inverted()
    x, y = (1e6 * values[name].values for name in ("x", "y"))
    hx, hy = (_cell(edge) for edge in (x, y))
    extent = (x[0] - hx / 2, x[-1] + hx / 2, y[0] - hy / 2, y[-1] + hy / 2)
    image = axes.imshow(scale * values.values.T, origin="lower", extent=extent, cmap=colours,
                        interpolation="nearest")  # fmt: skip
    if downwards:
        axes.invert_yaxis()  # which imshow has set upwards
    figure.colorbar(image, ax=axes, label=label)
    return figure


def _cell(centres: NDArray[np.float64]) -> float:
    return float(centres[1] - centres[0]) if centres.size > 1 else 1.0


def _axes(
    results: xr.Dataset, x: str, y: str, size: tuple[float, float] = _SIZE
) -> tuple[Figure, Axes]:
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.add_subplot()
    axes.set(xlabel=x, ylabel=y, title=plain(results.attrs.get("title", "")))
    return figure, axes


def plain(text: str) -> str:
    """A user's text as a title: at most two lines, and kept from being read as mathematics."""
    lines = textwrap.wrap(text, 55, max_lines=2, placeholder=" …")
    return "\n".join(lines).replace("$", r"\$")


def _parameters(results: xr.Dataset) -> tuple[float, float, float]:
    """R*, E* and p_y (inf when elastic) of the stored case."""
    p_y = results.attrs["derived_yield_pressure_Pa"]
    return (
        float(results.attrs["derived_reduced_radius_m"]),
        float(results.attrs["derived_contact_modulus_Pa"]),
        np.inf if p_y == "None" else float(p_y),
    )


def _work_of_adhesion(results: xr.Dataset) -> float:
    return float(results.attrs.get("derived_work_of_adhesion_J_per_m2", 0.0))


def _between(values: NDArray[np.float64]) -> NDArray[np.float64]:
    values = values[values > 0]
    return np.geomspace(values.min(), values.max(), 300)


def _last_carrying(results: xr.Dataset, k: int) -> float:
    """Indentation (m) of the last point of unloading curve `k` that still carries a force."""
    force = results["unloading_force"][k].values
    depths = results["unloading_indentation"][k].values[(force > 0)]
    return float(min(depths[depths > 0], default=np.inf))


def _plot_smooth(axes: Axes, results: xr.Dataset, x: str, scale: float) -> None:
    """The smooth bodies under the model of the case, where the run stored them."""
    if x not in results:
        return
    limits = axes.get_xlim()
    axes.plot(scale * results[x], results["smooth_restitution"], "-", lw=1, color="0.4",
              label=_SMOOTH)  # fmt: skip
    axes.set_xlim(limits)


def _plot_restitution(axes: Axes, results: xr.Dataset, x: NDArray[np.float64]) -> None:
    cor = results["restitution"].values
    resolved = results["resolved"].values.astype(bool)
    label = "this contact"
    if "restitution_std" in results:
        std = results["restitution_std"].values
        label = f"mean of {results['realisations'].values.max():.0f} surfaces"
        axes.fill_between(x, results["restitution_low"], results["restitution_high"], color="C0",
                          alpha=0.25, lw=0, label="95 % interval of the mean")  # fmt: skip
        for sign, words in ((1, "± standard deviation"), (-1, None)):
            axes.plot(x, cor + sign * std, ":", color="C0", lw=1, label=words)
    for coarser, style in zip(results.get("coarser_restitution", ()), _DASHES, strict=False):
        axes.plot(x, coarser, style, color="C1", lw=1,
                  label=f"refine = {int(coarser['refine'])}")  # fmt: skip
    error = results["total_error"].values
    if np.isfinite(error).any():
        axes.errorbar(x, cor, yerr=error, fmt="none", ecolor="C0", elinewidth=1, capsize=2,
                      label="total error")  # fmt: skip
    axes.plot(x, cor, "-", color="C0", lw=1)
    axes.plot(x[resolved], cor[resolved], "o", ms=4.5, color="C0", label=label)
    if not resolved.all():
        axes.plot(x[~resolved], cor[~resolved], "o", ms=4.5, mfc="white", color="C0",
                  label=_UNRESOLVED)  # fmt: skip
    axes.set_xscale("log")
    axes.set_ylim(0, 1.03)
