"""Progress display for verbs that compute many cases, with advice on how to resume."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress


@contextmanager
def cases_progress(cases: int | None, out: object, resume: str) -> Iterator[Progress]:
    """Announce `cases` cases (None: number unknown) with results in `out`, and show their progress.

    The command `resume` continues the computation. After an interruption, this command is printed,
    and the process exits with the status that shells expect.
    """
    import typer
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    from restitution.cli.console import errors, hint_at_kernels, say
    from restitution.cli.signals import Stopped

    number = "" if cases is None else f"{cases} cases. "
    say(f"{number}Results go to {out}; to resume: {resume}", errors)
    hint_at_kernels()
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    try:
        with Progress(*columns, console=errors, transient=True) as bar:
            yield bar
    except KeyboardInterrupt as stop:
        errors.print("Interrupted.", style="red")
        say(f"Completed cases are kept; to resume: {resume}", errors)
        raise typer.Exit(stop.status if isinstance(stop, Stopped) else 130) from None
