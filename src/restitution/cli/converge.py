"""`restitution converge`: compute a case on successively finer grids."""

from functools import partial
from typing import Annotated

import typer

from restitution.cli.parameters import (
    CaseFile,
    Device,
    FigureFormat,
    Figures,
    OnDevice,
    OutFolder,
)
from restitution.cli.running import run_with_progress


def converge(
    context: typer.Context,
    case: CaseFile,
    out: OutFolder,
    grids: Annotated[
        int,
        typer.Option(
            min=2,
            max=5,
            metavar="N",
            help="Number of grids, each with half the spacing of the previous one.",
        ),
    ] = 3,
    device: OnDevice = Device.cpu,
    figures: Figures = FigureFormat.png,
) -> None:
    """Run CASE on its grid and on finer grids; write COR and its discretisation error to OUT."""
    from restitution.cli.console import answers
    from restitution.runs.convergence import run_convergence

    summary = run_with_progress(
        context, case, out, device, lambda _: grids, partial(run_convergence, grids=grids), figures
    )
    order = summary["observed_order"]
    answers.print(
        "observed order "
        + ("not defined: too few resolved depths" if order is None else f"{order:.2g}")
        + f" on refine = {', '.join(map(str, summary['grids']))}"
    )
