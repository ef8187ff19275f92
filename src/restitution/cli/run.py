"""`restitution run` and `restitution converge`: one case with progress, warnings and figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import typer
from rich.table import Table

from restitution.case.case import Case
from restitution.case.case_file import naming, read_case
from restitution.case.omissions import default_yield
from restitution.cli.console import (
    answers,
    command,
    errors,
    hint_at_kernels,
    print_numbers,
    progress_bar,
    say,
    say_next,
    say_written,
    table_of_numbers,
    warn_once,
)
from restitution.cli.parameters import DeviceName, FigureFormat
from restitution.cli.signals import received
from restitution.contact.checks.findings import CLEANING
from restitution.curve.curve import largest_part, loses
from restitution.curve.periodic import PeriodicPoint
from restitution.curve.point import MeanPoint, Point
from restitution.display import quantity
from restitution.numerics.convolution.device import on_device
from restitution.repeated.points import RunInPoint
from restitution.results.locking import locked
from restitution.results.periodic import PeriodicResults
from restitution.results.reader import RunResults
from restitution.results.schema import LOCK
from restitution.results.tables import is_periodic
from restitution.results.writer import ResultsFolder
from restitution.runs.attraction import in_words
from restitution.runs.convergence import run_convergence
from restitution.runs.ensemble import run_realisations
from restitution.runs.error_budget import steps
from restitution.runs.losses import loss_information
from restitution.runs.run_in import measurements

# If the total error of COR is at least this value at any depth, the name of the largest part of the
# error and the remedy are printed.
_LARGE = 0.05
_REMEDIES = {
    "restitution_error": "a smaller unloading.restitution_error reduces it",
    "discretisation_error": "`restitution converge` computes COR on finer grids",
    "material_error": "give measured properties instead of those of the material library",
}


def run(case: Path, out: Path, device: DeviceName, figures: FigureFormat) -> None:
    _run(case, out, device, figures, run_realisations, lambda read: read.realisations)


def converge(
    case: Path, out: Path, *, grids: int, device: DeviceName, figures: FigureFormat
) -> None:
    start = partial(run_convergence, grids=grids)
    summary = _run(case, out, device, figures, start, lambda _: grids)
    order = summary["observed_order"]
    answers.print(
        "observed order "
        + ("not defined: too few resolved depths" if order is None else f"{order:.2g}")
        + f" on refine = {', '.join(map(str, summary['grids']))}"
    )


def _run(
    case: Path,
    out: Path,
    device: DeviceName,
    figures: FigureFormat,
    start: Callable[..., dict[str, Any]],
    curves: Callable[[Case], int],
) -> dict[str, Any]:
    """Compute, store, print and draw a case, or the depths computed before an interruption.

    `start` has the parameters of `run_realisations`. `curves` returns the number of curves of a
    case, for the progress bar.
    """
    read, text = read_case(case)
    with on_device(device.value), locked(out):
        folder = ResultsFolder(out)
        say(f"Results go to {out}", errors)
        with naming(case):
            losses = loss_information(read)
        for information in filter(None, (default_yield(read.yielding().source), losses)):
            say(information, errors)
        hint_at_kernels()
        depths = len(read.depths())
        try:
            summary = _compute(case, read, text, folder, start, curves(read))
            drawn = {path.name for path in _draw(out, figures)}
        except KeyboardInterrupt:
            errors.print("Interrupted.", style="red")
            _draw_partial_results(folder, depths, figures)
            # Exit status of Ctrl-C. After another signal, `main` exits with the status of that
            # signal.
            raise typer.Exit(130) from None
        except BaseException:
            if received:
                errors.print("Interrupted.", style="red")
            _draw_partial_results(folder, depths, figures)
            raise
        names = [p.name for p in sorted(out.iterdir()) if p.name not in drawn and p.name != LOCK]
    say_written(out, [*names, *sorted(drawn)])
    say_next(command("report", out))
    return summary


def _compute(
    case: Path,
    read: Case,
    text: str,
    folder: ResultsFolder,
    start: Callable[..., dict[str, Any]],
    curves: int,
) -> dict[str, Any]:
    depths = len(read.depths())
    with naming(case), warn_once() as warn, progress_bar() as bar:
        more = 0 if read.periodic else steps(read) + measurements(read)
        task = bar.add_task("reading the surface", total=depths * curves + more)
        summary = start(
            read,
            text,
            case.parent,
            folder,
            progress=lambda words: bar.update(task, advance=1, description=words),
            warn=warn,
        )
    points = folder.curve.points
    print_numbers(
        _curve(points, wanted=read.total_error) if points else _periodic_curve(folder.periodic)
    )
    if folder.run_in:
        print_numbers(_run_in(folder.run_in))
    many = f" of {curves} curves" if curves > 1 else ""
    residual = summary["diagnostics"]["largest_residual"]
    answers.print(
        f"{depths} depths{many}, {summary['convolutions']} convolutions, "
        f"{summary['seconds']:.1f} s; largest residual {residual:.1e}",
        markup=False,
    )
    for words in (
        in_words(summary.get("sticking", {}), points),
        _elastic_error(points),
        _advice(read, points, summary),
        *_steady(summary),
    ):
        if words:
            say(words)
    return summary


def _elastic_error(points: Sequence[Point]) -> str:
    """Say why the error of the model is not 0 at depths where nothing yields; "" without any."""
    elastic = (point for point in points if point.plastic_work == 0)
    if not any(point.model_error > 0 and point.restitution == 1 for point in elastic):
        return ""
    return (
        "± model is above 0 although nothing yields: a real contact loses energy from 1.6 Y on, up "
        "to 7 % of COR, but a constant yield pressure lets it yield only at 2.8 Y."
    )


def _advice(case: Case, points: Sequence[Point], summary: dict[str, Any]) -> str:
    """The largest part of a large total error and its remedy; "" if the scan needs cleaning."""
    if case.periodic or not any(point.total_error >= _LARGE for point in points):
        return ""
    if any(f"{CLEANING} = " in warning for warning in summary["warnings"]):
        return ""
    part = largest_part(points)
    if part == "surface_scatter" and case.impacts:  # coverage.csv has the means over places
        return ""
    material = summary["diagnostics"].get("material_advice", "")
    if part == "surface_scatter":
        n = case.realisations
        remedy = (
            "a larger number of realisations in [roughness] reduces it"
            if n > 1
            else "`restitution run` with realisations = 8 in [roughness] computes the mean of 8 "
            "surfaces"
        )
    elif part == "material_error" and material:
        remedy = material
    else:
        remedy = _REMEDIES[part]
    return f"The largest part of the total error is {part}: {remedy}."


def _draw_partial_results(folder: ResultsFolder, depths: int, figures: FigureFormat) -> None:
    """Print how many depths a run computed before it ended early, and draw its figures."""
    points = folder.curve.points or folder.periodic
    if not points or folder.path is None:
        return
    of = " (means over the completed surfaces)" if isinstance(points[0], MeanPoint) else ""
    say(f"{len(points)} of {depths} depths were computed{of} and are kept in {folder.path}", errors)
    with suppress(Exception):  # a failing figure must not hide the error that ended the run
        _draw(folder.path, figures)


def _draw(out: Path, figures: FigureFormat) -> list[Path]:
    # Importing matplotlib takes a second, which a case that is refused need not wait.
    from restitution.plots.periodic import periodic_figures
    from restitution.plots.run import run_figures
    from restitution.plots.run_in import run_in_figures
    from restitution.plots.static import write_figures

    if is_periodic(out):
        return write_figures(out, periodic_figures(PeriodicResults(out).dataset), figures.value)
    run = RunResults(out)
    return write_figures(out, [*run_figures(run.dataset), *run_in_figures(run)], figures.value)


def _with_error(cor: float, error: float, wanted: bool) -> str:
    """COR with its total error; without it if the case does not ask for the total error."""
    known = "unknown" if math.isnan(error) else f"{error:.4f}"
    return f"{cor:.4f} ± {known}" if wanted or not math.isnan(error) else f"{cor:.4f}"


def _curve(points: Sequence[Point], *, wanted: bool) -> Table:
    adhesive = any(point.pull_off_force > 0 for point in points)
    lossy = loses(points)
    table = table_of_numbers(
        "depth (nm)",
        "force (N)",
        "V (m/s)",
        "COR",
        "± model",
        *(["with losses"] if lossy else []),
        *(["pull-off"] if adhesive else []),
        "nodes",
        "resolved",
    )
    for point in points:
        velocity, cor, error = point.impact_velocity, point.restitution, point.total_error
        table.add_row(
            f"{1e9 * point.indentation:.4g}",
            f"{point.force:.4g}",
            "–" if math.isnan(velocity) else f"{velocity:.4g}",
            "–" if math.isnan(cor) else _with_error(cor, error, wanted),
            "–" if math.isnan(point.model_error) else f"{point.model_error:.3f}",
            *([_number(point.restitution_with_losses)] if lossy else []),
            *([_force(point)] if adhesive else []),
            f"{point.contact_nodes:.0f}",
            "yes" if point.resolved else "no",
        )
    return table


def _number(cor: float) -> str:
    return "–" if math.isnan(cor) else f"{cor:.4f}"


def _force(point: Point) -> str:
    force, error = point.pull_off_force, point.pull_off_error
    return f"{quantity(force, 'N')} ± {error / force:.0%}" if force > 0 else "unknown"


def _run_in(points: Sequence[RunInPoint]) -> Table:
    table = table_of_numbers("V (m/s)", "coverage", "impacts", "COR", "places ±", "5 %", "95 %")
    for point in points:
        table.add_row(
            f"{point.velocity:.4g}",
            f"{point.coverage:.3g}",
            f"{point.impacts:.0f}",
            _with_error(point.restitution, point.total_error, wanted=False),
            f"{point.restitution_std:.3f}",
            f"{point.restitution_5:.3f}",
            f"{point.restitution_95:.3f}",
        )
    return table


def _steady(summary: dict[str, Any]) -> Iterator[str]:
    for sequence in summary.get("run_in", {}).get("sequences", ()):
        state = sequence["steady_state"]
        if state is None:
            continue
        where = f"after {sequence['impacts']} impacts (coverage {sequence['coverage']:.3g})"
        if state["steady"]:
            yield (
                f"COR is steady {where}, {state['restitution']:.3f} ± {state['error']:.2g} in the "
                f"last half of the impacts at {state['velocity']:.3g} m/s"
            )
        else:
            yield (
                f"COR may still change {where} at {state['velocity']:.3g} m/s: by "
                f"{state['trend']:+.2g} ± {state['trend_error']:.2g} per coverage"
            )


def _periodic_curve(points: Sequence[PeriodicPoint]) -> Table:
    table = table_of_numbers(
        "depth (nm)", "mean gap (nm)", "pressure (MPa)", "area (%)", "energy (J)", "resolved"
    )
    for point in points:
        table.add_row(
            f"{1e9 * point.indentation:.4g}",
            f"{1e9 * point.mean_gap:.4g}",
            f"{1e-6 * point.nominal_pressure:.4g}",
            f"{100 * point.corrected_relative_area:.4g}",
            f"{point.stored_energy:.4g}",
            "yes" if point.resolved else "no",
        )
    return table
