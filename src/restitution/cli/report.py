"""`restitution report`: a page of what a folder holds."""

from pathlib import Path
from typing import Annotated

import typer


def report(
    out: Annotated[
        Path,
        typer.Argument(
            help="Results folder of a run, study or surface.", show_default=False, readable=False
        ),
    ],
) -> None:
    """Write a self-contained HTML page of the results in OUT."""
    from restitution.cli.console import say
    from restitution.pages.report import write_report

    page = write_report(out)
    say(f"Written: {page}")
