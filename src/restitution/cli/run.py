"""`restitution run`: a case from start to figures."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Device(StrEnum):
    """What solves may run on."""

    cpu = "cpu"
    gpu = "gpu"
    auto = "auto"


def run(
    context: typer.Context,
    case: Annotated[Path, typer.Argument(help="Case file (TOML).", show_default=False)],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the results; new or empty.")],
    device: Annotated[
        Device,
        typer.Option(help="Where to solve; auto is the GPU where one answers (needs CuPy)."),
    ] = Device.cpu,
) -> None:
    """Load and unload the contact of CASE and write its curves, restitution and figures to OUT."""
    from rich.progress import (
        BarColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    from restitution.cli.console import answers, errors, warn
    from restitution.cli.signals import Stopped, received
    from restitution.numerics.device import on_device
    from restitution.reports.figures import write_figures
    from restitution.studies.case import naming, read_case
    from restitution.studies.results import ResultsFolder
    from restitution.studies.run import run_case

    read, text = read_case(case)
    context.with_resource(on_device(device.value))
    folder = ResultsFolder(out)
    errors.print(f"Results go to {out}", markup=False, soft_wrap=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    depths = len(read.depths())
    try:
        with naming(case), Progress(*columns, console=errors, transient=True) as bar:
            task = bar.add_task("reading the surface", total=depths)
            summary = run_case(
                read, text, case.parent, folder,
                progress=lambda words: bar.update(task, advance=1, description=words),
                warn=warn,
            )  # fmt: skip
        _print_curve(answers, folder.rows)
        answers.print(
            f"{depths} depths, {summary['convolutions']} convolutions, {summary['seconds']:.1f} s; "
            f"largest residual {summary['trust']['largest_residual']:.1e}",
            markup=False,
        )
        figures = write_figures(out)
    except KeyboardInterrupt as stop:
        errors.print("Interrupted.", style="red")
        _keep(folder, depths)
        raise typer.Exit(stop.status if isinstance(stop, Stopped) else 130) from None
    except BaseException:
        if received:
            errors.print("Interrupted.", style="red")
        _keep(folder, depths)
        raise
    names = ["curve.csv", "unloading.csv", "summary.json", "results.nc"]
    answers.print(f"In {out}: {', '.join(names + [f.name for f in figures])}", markup=False,
                  soft_wrap=True)  # fmt: skip


def _keep(folder, depths) -> None:  # type: ignore[no-untyped-def]
    """Say what a run that ended early leaves, and draw it."""
    from contextlib import suppress

    from restitution.cli.console import errors
    from restitution.reports.figures import write_figures

    if not folder.rows:
        return
    errors.print(
        f"{len(folder.rows)} of {depths} depths were computed and are kept in {folder.path}",
        markup=False, soft_wrap=True,
    )  # fmt: skip
    with suppress(Exception):  # what ended the run is to be said, not that its figures fail, too
        write_figures(folder.path)


def _print_curve(console, rows) -> None:  # type: ignore[no-untyped-def]
    from rich.table import Table

    table = Table(box=None, header_style="bold")
    for name in ("indentation (nm)", "force (N)", "velocity (m/s)", "COR", "nodes in contact"):
        table.add_column(name, justify="right")
    for row in rows:
        velocity = row["impact_velocity_m_per_s"]
        table.add_row(
            f"{1e9 * row['indentation_m']:.4g}",
            f"{row['force_N']:.4g}",
            "-" if velocity != velocity else f"{velocity:.4g}",
            f"{row['restitution']:.4f}",
            f"{row['contact_nodes']:.0f}",
        )
    console.print(table)
