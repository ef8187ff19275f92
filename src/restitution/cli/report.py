"""`restitution report`: an HTML page of stored results."""

from pathlib import Path
from typing import Annotated

import typer


def report(
    results: Annotated[
        Path,
        typer.Argument(
            metavar="RESULTS",
            help="Results folder of a run, periodic contact, study, mixture or surface.",
            show_default=False,
            readable=False,
        ),
    ],
) -> None:
    """Write a self-contained HTML page of the results into the folder RESULTS."""
    from restitution.cli.console import say_written
    from restitution.pages.report import write_report

    say_written(write_report(results))
