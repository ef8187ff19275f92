"""The command line: one verb a file, heavy imports inside the verb."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from restitution.cli import check, run, surface
from restitution.errors import RestitutionError

app = typer.Typer(
    name="restitution",
    help="Coefficient of restitution of rough elastic-plastic particles from their surface.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command()(run.run)
app.command()(check.check)
app.command()(surface.surface)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"restitution {version('restitution')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    pass


def main() -> None:
    """Run the command line; a user's error is one red line and status 1."""
    from restitution.cli.console import errors

    try:
        app()
    except RestitutionError as error:
        errors.print(f"Error: {error}", style="red", highlight=False, markup=False, soft_wrap=True)
        sys.exit(1)
