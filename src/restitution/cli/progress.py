"""Progress displays on the standard error of a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from restitution.cli.console import errors, hint_at_kernels, say


def progress_bar(*counts: ProgressColumn) -> Progress:
    """Make a progress bar with a description, the columns `counts`, and times."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        *counts,
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=errors,
        transient=True,
    )


@contextmanager
def spinner(words: str) -> Iterator[Callable[[str], None]]:
    """Show a spinner, `words` and the elapsed time; yield a function that replaces the words."""
    columns = SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn()
    with Progress(*columns, console=errors, transient=True) as bar:
        task = bar.add_task(words)
        yield lambda others: bar.update(task, description=others, refresh=True)


@contextmanager
def cases_progress(cases: int | None, out: object, resume: str) -> Iterator[Progress]:
    """Show the progress of a computation of several cases.

    `cases` is the number of cases (None if it is unknown), `out` is the folder of the results, and
    `resume` is the command that continues the computation. All three are printed at the start.
    After an interruption, `resume` is printed again, and the process exits with the status that
    shells expect.
    """
    number = "" if cases is None else f"{cases} cases. "
    say(f"{number}Results go to {out}; to resume: {resume}", errors)
    hint_at_kernels()
    try:
        with progress_bar(MofNCompleteColumn()) as bar:
            yield bar
    except KeyboardInterrupt:
        errors.print("Interrupted.", style="red")
        say(f"Completed cases are kept; to resume: {resume}", errors)
        # Exit status of Ctrl-C. After another signal, `main` exits with the status of that signal.
        raise typer.Exit(130) from None
