"""Figures of one run, drawn from its stored results alone."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from restitution.contact.resolution import NODES_PER_PATCH
from restitution.studies.results import replace_file
from restitution.theory import hertz, thornton_ning

_SIZE = (6.4, 4.4)
_UNRESOLVED = f"open: fewer than {NODES_PER_PATCH} nodes in the largest patch"


def write_figures(out: Path) -> list[Path]:
    """Draw every figure that the `results.nc` in `out` supports; return the files written."""
    with xr.open_dataset(out / "results.nc", engine="netcdf4") as stored:
        results = stored.load()
    written = []
    for name, figure in figures(results):
        path = out / f"{name}.png"
        write_figure(path, figure)
        written.append(path)
    return written


def write_figure(path: Path, figure: Figure) -> None:
    """Write one figure as PNG, all of it or nothing."""
    FigureCanvasAgg(figure)
    replace_file(path, lambda to: figure.savefig(to, format="png", dpi=150))


def figures(results: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    """Name and figure, one after another."""
    if results.sizes["indentation_max"] == 0:
        return
    yield "load-displacement", load_displacement(results)
    yield "restitution-indentation", restitution_against_indentation(results)
    if np.isfinite(results["impact_velocity"]).any():
        yield "restitution-velocity", restitution_against_velocity(results)
    yield "pressure", pressure_map(results)


def load_displacement(results: xr.Dataset) -> Figure:
    """Force against indentation, loading and unloading."""
    figure, axes = _axes(results, "indentation (µm)", "normal force (N)")
    depth, force = results["indentation"].values, results["force"].values
    origin = np.zeros(1)
    axes.plot(1e6 * np.append(origin, depth), np.append(origin, force), "o-", ms=3.5,
              color="C0", label="loading")  # fmt: skip
    for k in range(results.sizes.get("unloading", 0)):
        axes.plot(1e6 * results["unloading_indentation"][k], results["unloading_force"][k], "-",
                  color="C1", label="unloading" if k == 0 else None)  # fmt: skip
    R, E_star, p_y = _parameters(results)
    fine = np.linspace(0, depth.max(), 400)
    force_hertz = hertz.force(fine, R, E_star)
    shown = force_hertz <= 1.3 * force.max()
    axes.plot(1e6 * fine[shown], force_hertz[shown], ":", color="0.4", label="Hertz, smooth")
    if np.isfinite(p_y):
        axes.plot(1e6 * fine, thornton_ning.loading_force(fine, R, E_star, p_y), "--",
                  color="0.4", label="Thornton–Ning, smooth")  # fmt: skip
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False)
    return figure


def restitution_against_indentation(results: xr.Dataset) -> Figure:
    """Coefficient of restitution against maximum indentation."""
    figure, axes = _axes(results, "maximum indentation (µm)", "coefficient of restitution")
    depth = results["indentation"].values
    _plot_restitution(axes, results, 1e6 * depth)
    R, E_star, p_y = _parameters(results)
    if np.isfinite(p_y):
        fine = _between(depth)
        reference = thornton_ning.restitution_at_indentation(fine, R, E_star, p_y)
        axes.plot(1e6 * fine, reference, "--", color="0.4", label="Thornton–Ning, smooth")
    axes.legend(frameon=False, loc="lower left")
    return figure


def restitution_against_velocity(results: xr.Dataset) -> Figure:
    """Coefficient of restitution against impact velocity."""
    figure, axes = _axes(results, "impact velocity (m/s)", "coefficient of restitution")
    velocity = results["impact_velocity"].values
    _plot_restitution(axes, results, velocity)
    R, E_star, p_y = _parameters(results)
    if np.isfinite(p_y):
        fine = _between(velocity)
        mass = float(results.attrs["derived_reduced_mass_kg"])
        reference = thornton_ning.restitution(fine, R, E_star, p_y, mass)
        axes.plot(fine, reference, "--", color="0.4", label="Thornton–Ning, smooth")
    axes.legend(frameon=False, loc="lower left")
    return figure


def pressure_map(results: xr.Dataset) -> Figure:
    """Contact pressure at the deepest point, on the part of the grid that is in contact."""
    pressure = results["pressure"]
    touching = np.argwhere(pressure.values > 0)
    low = np.maximum(touching.min(axis=0) - 4, 0)
    high = touching.max(axis=0) + 5
    part = pressure[low[0] : high[0], low[1] : high[1]]
    depth = float(results["indentation"].max())
    figure, axes = _axes(results, "x (µm)", "y (µm)", size=(5.6, 4.8))
    return _map(
        figure, axes, part.where(part > 0), 1e-6, "viridis",
        f"pressure (MPa) at an indentation of {1e6 * depth:.3g} µm",
    )  # fmt: skip


def surface_map(height: xr.DataArray, title: str) -> Figure:
    """Heights of a surface, with a colour bar in micrometres."""
    figure = Figure(figsize=(5.6, 4.8), layout="constrained")
    axes = figure.add_subplot()
    axes.set(xlabel="x (µm)", ylabel="y (µm)", title=_plain(title))
    return _map(figure, axes, height, 1e6, "cividis", "height (µm)")


def _map(
    figure: Figure, axes: Axes, values: xr.DataArray, scale: float, colours: str, label: str
) -> Figure:
    x, y = (1e6 * values[name].values for name in ("x", "y"))
    hx, hy = (_cell(edge) for edge in (x, y))
    extent = (x[0] - hx / 2, x[-1] + hx / 2, y[0] - hy / 2, y[-1] + hy / 2)
    image = axes.imshow(scale * values.values.T, origin="lower", extent=extent, cmap=colours,
                        interpolation="nearest")  # fmt: skip
    figure.colorbar(image, ax=axes, label=label)
    return figure


def _cell(centres: NDArray[np.float64]) -> float:
    return float(centres[1] - centres[0]) if centres.size > 1 else 1.0


def _axes(
    results: xr.Dataset, x: str, y: str, size: tuple[float, float] = _SIZE
) -> tuple[Figure, Axes]:
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.add_subplot()
    axes.set(xlabel=x, ylabel=y, title=_plain(results.attrs.get("title", "")))
    return figure, axes


def _plain(text: str) -> str:
    """A user's text, kept from being read as mathematics."""
    return text.replace("$", r"\$")


def _parameters(results: xr.Dataset) -> tuple[float, float, float]:
    """R*, E* and p_y (inf when elastic) of the stored case."""
    p_y = results.attrs["derived_yield_pressure_Pa"]
    return (
        float(results.attrs["derived_reduced_radius_m"]),
        float(results.attrs["derived_contact_modulus_Pa"]),
        np.inf if p_y == "None" else float(p_y),
    )


def _between(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.geomspace(values.min(), values.max(), 300)


def _plot_restitution(axes: Axes, results: xr.Dataset, x: NDArray[np.float64]) -> None:
    cor = results["restitution"].values
    resolved = results["largest_patch_nodes"].values >= NODES_PER_PATCH
    axes.plot(x, cor, "-", color="C0", lw=1)
    axes.plot(x[resolved], cor[resolved], "o", ms=4.5, color="C0", label="this contact")
    if not resolved.all():
        axes.plot(x[~resolved], cor[~resolved], "o", ms=4.5, mfc="white", color="C0",
                  label=_UNRESOLVED)  # fmt: skip
    axes.set_xscale("log")
    axes.set_ylim(0, 1.03)
