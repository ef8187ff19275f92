"""What the verbs that solve have in common: progress, warnings, results, and a polite end."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.table import Table

    from restitution.case.case import Case
    from restitution.results.writer import ResultsFolder


class Device(StrEnum):
    """What solves may run on."""

    cpu = "cpu"
    gpu = "gpu"
    auto = "auto"


class FigureFormat(StrEnum):
    """What figures may be written as."""

    png = "png"
    svg = "svg"
    pdf = "pdf"


CaseFile = Annotated[
    Path, typer.Argument(help="Case file (TOML).", show_default=False, readable=False)
]
OutFolder = Annotated[
    Path, typer.Option("-o", "--out", help="Folder for the results; new or empty.", readable=False)
]
OnDevice = Annotated[
    Device, typer.Option(help="Where to solve; auto uses a GPU if available (needs CuPy).")
]

Figures = Annotated[FigureFormat, typer.Option("--figures", help="Format of the figures.")]


def carry_out(
    context: typer.Context,
    case: Path,
    out: Path,
    device: Device,
    runs: Callable[[Case], int],
    start: Callable[..., dict[str, Any]],
    figures: FigureFormat,
) -> dict[str, Any]:
    """Read the file `case`, let `start` compute into `out`, and say what came of it.

    `runs(case)` is how many curves will be computed; `start` is called as `run_realisations`, and
    its summary is returned. However it ends, what was computed is kept and drawn.
    """
    from rich.progress import (
        BarColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    from restitution.case.case_file import naming, read_case
    from restitution.cli.console import answers, errors, hint_at_kernels, say, warn
    from restitution.cli.signals import Stopped, received
    from restitution.numerics.convolution.device import on_device
    from restitution.results.locking import locked
    from restitution.results.schema import LOCK
    from restitution.results.writer import ResultsFolder
    from restitution.runs.error_budget import steps

    read, text = read_case(case)
    context.with_resource(on_device(device.value))
    context.with_resource(locked(out))
    folder = ResultsFolder(out)
    say(f"Results go to {out}", errors)
    hint_at_kernels()
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    depths = len(read.depths())
    try:
        with naming(case), Progress(*columns, console=errors, transient=True) as bar:
            task = bar.add_task("reading the surface", total=depths * runs(read) + steps(read))
            summary = start(
                read,
                text,
                case.parent,
                folder,
                progress=lambda words: bar.update(task, advance=1, description=words),
                warn=warn,
            )
        answers.print(_curve(folder.rows))
        many = f" of {runs(read)} curves" if runs(read) > 1 else ""
        residual = summary["diagnostics"]["largest_residual"]
        answers.print(
            f"{depths} depths{many}, {summary['convolutions']} convolutions, "
            f"{summary['seconds']:.1f} s; largest residual {residual:.1e}",
            markup=False,
        )
        drawn = {path.name for path in _draw(out, figures)}
    except KeyboardInterrupt as stop:
        errors.print("Interrupted.", style="red")
        _keep(folder, depths, figures)
        raise typer.Exit(stop.status if isinstance(stop, Stopped) else 130) from None
    except BaseException:
        if received:
            errors.print("Interrupted.", style="red")
        _keep(folder, depths, figures)
        raise
    names = [p.name for p in sorted(out.iterdir()) if p.name not in drawn and p.name != LOCK]
    say(f"In {out}: {', '.join([*names, *sorted(drawn)])}")
    return summary


def _keep(folder: ResultsFolder, depths: int, figures: FigureFormat) -> None:
    """Say what a run that ended early leaves, and draw it."""
    from contextlib import suppress

    from restitution.cli.console import errors, say

    if not folder.rows:
        return
    of = " (means of the surfaces done)" if "realisations" in folder.rows[0] else ""
    say(
        f"{len(folder.rows)} of {depths} depths were computed{of} and are kept in {folder.path}",
        errors,
    )
    with suppress(Exception):  # what ended the run is to be said, not that its figures fail, too
        _draw(folder.path, figures)


def _draw(out: Path, figures: FigureFormat) -> list[Path]:
    """Draw every figure that the results in `out` support; return the files written."""
    from restitution.plots.run import run_figures
    from restitution.plots.static import write_figures
    from restitution.results.reader import RunResults

    return write_figures(out, run_figures(RunResults(out).dataset), figures.value)


def _curve(rows: list[dict[str, float]]) -> Table:
    from restitution.cli.console import table_of_numbers

    table = table_of_numbers(
        "depth (nm)", "force (N)", "V (m/s)", "COR", "± model", "nodes", "resolved"
    )
    for row in rows:
        velocity = row["impact_velocity_m_per_s"]
        table.add_row(
            f"{1e9 * row['max_indentation_m']:.4g}",
            f"{row['force_N']:.4g}",
            "-" if velocity != velocity else f"{velocity:.4g}",
            f"{row['restitution']:.4f}{_uncertainty(row)}",
            f"{row['model_error']:.3f}",
            f"{row['contact_nodes']:.0f}",
            "yes" if row["resolved"] and row["adhesion_resolved"] else "no",
        )
    return table


def _uncertainty(row: dict[str, float]) -> str:
    """The total error, where it is known."""
    error = row["total_error"]
    return "" if error != error else f" ± {error:.4f}"
