"""What the verbs that compute many cases have in common: a bar over them, and how to go on."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress


@contextmanager
def many_cases(cases: int | None, out: object, again: str) -> Iterator[Progress]:
    """Say where the results of so many `cases` go and that `again` resumes them; show progress.

    `cases` is None where their number is not known before the first are done.

    Interruption ends the program as a shell expects it, with the same advice.
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
    say(f"{number}Results go to {out}; to resume: {again}", errors)
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
        say(f"What is done is kept; go on with: {again}", errors)
        raise typer.Exit(stop.status if isinstance(stop, Stopped) else 130) from None
