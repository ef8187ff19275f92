"""`restitution run`: a case from start to figures."""

import typer

from restitution.cli.running import (
    CaseFile,
    Device,
    FigureFormat,
    Figures,
    OnDevice,
    OutFolder,
    carry_out,
)


def run(
    context: typer.Context,
    case: CaseFile,
    out: OutFolder,
    device: OnDevice = Device.cpu,
    figures: Figures = FigureFormat.png,
) -> None:
    """Load and unload the contact of CASE and write its curves, restitution and figures to OUT."""
    from restitution.runs.ensemble import run_realisations

    carry_out(context, case, out, device, lambda read: read.realisations, run_realisations, figures)
