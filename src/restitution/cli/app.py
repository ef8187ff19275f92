"""The verbs and options of the command line."""

from __future__ import annotations

from typing import Annotated

import typer

from restitution.cli import (
    check,
    compare,
    compare_theory,
    converge,
    export,
    fit,
    fit_law,
    report,
    reproduce,
    run,
    simulate,
    study,
    surface,
)

app = typer.Typer(
    name="restitution",
    help="Coefficient of restitution of rough elastic-plastic particles from their surface.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command()(run.run)
app.command()(converge.converge)
app.command()(study.study)
app.command()(report.report)
app.command()(compare.compare)
app.command()(reproduce.reproduce)
app.command()(fit_law.fit_law)
app.command()(fit.fit)
app.command()(export.export)
app.command()(compare_theory.compare_theory)
app.command()(simulate.simulate)
app.command()(check.check)
app.command()(surface.surface)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        from restitution.numerics.kernels import instruction_set, missing

        typer.echo(f"restitution {version('restitution')}")
        typer.echo(f"compiled kernels: {instruction_set}")
        if why := missing():
            typer.echo(f"Hint: {why}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_print_version,
            is_eager=True,
            help="Print the version, and which compiled kernels run.",
        ),
    ] = False,
) -> None:
    pass
