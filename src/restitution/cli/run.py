"""`restitution run`: compute one case and draw its figures."""

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


def run(
    context: typer.Context,
    case: CaseFile,
    out: OutFolder,
    device: OnDevice = Device.cpu,
    figures: Figures = FigureFormat.png,
) -> None:
    """Load and unload the contact of CASE; write curves, restitution and figures to OUT."""
    from restitution.runs.ensemble import run_realisations

    run_with_progress(
        context, case, out, device, lambda read: read.realisations, run_realisations, figures
    )
