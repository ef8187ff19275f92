"""What people see: answers on standard output, progress and warnings on standard error."""

import shlex
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Protocol

import typer
from rich.cells import cell_len
from rich.console import Console
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
from rich.table import Column, Table

from restitution.display import counted, some_of, without_numbers
from restitution.errors import one_line

answers = Console(highlight=False)
errors = Console(stderr=True, highlight=False)
# The message about repetitions quotes at most this number of characters of the repeated warning.
_QUOTED = 60


def say(text: str, console: Console = answers, style: str | None = None) -> None:
    """Print `text` verbatim as one line, without markup and without wrapping."""
    console.print(text, style=style, markup=False, soft_wrap=True)


def table_of_numbers(*columns: str | Column) -> Table:
    """Make an empty table. A column whose header is given as a plain text is right-aligned."""
    aligned = (
        column if isinstance(column, Column) else Column(column, justify="right", no_wrap=True)
        for column in columns
    )
    return Table(*aligned, box=None, header_style="bold")


def print_numbers(table: Table) -> None:
    """Print a table of numbers without cutting its cells, even if it is wider than the terminal."""
    for column in table.columns:
        cells = column.header, *column.cells
        lines = (line for cell in cells for line in str(cell).split("\n"))
        column.min_width = max(map(cell_len, lines))
    answers.print(table, crop=False)


def warn(message: str) -> None:
    say(f"Warning: {one_line(message)}", errors, "yellow")


class Warn(Protocol):
    """A function that issues a warning, optionally about a subject such as a case or a law."""

    def __call__(self, message: str, subject: str = "") -> None:
        """Print `message` with its `subject`, or count it if it was printed before."""


@contextmanager
def warn_once() -> Iterator[Warn]:
    """Print each warning once; at the end, print how often and for which subjects it was repeated.

    A warning that differs from an earlier one only in its numbers counts as a repetition.
    """
    first: dict[str, str] = {}
    repeated: dict[str, list[tuple[str, str]]] = {}  # pairs (message, subject) by kind

    def warn_or_count(message: str, subject: str = "") -> None:
        kind = without_numbers(message)
        if kind in first:
            repeated.setdefault(kind, []).append((message, subject))
        else:
            first[kind] = message
            warn(f"{subject}: {message}" if subject else message)

    try:
        yield warn_or_count
    finally:
        for kind, others in repeated.items():
            whole = first[kind]
            start = whole if len(whole) <= _QUOTED else f"{whole[:_QUOTED].rstrip()}…"
            differ = any(message != whole for message, _ in others)
            numbers = " with other numbers" if differ else ""
            named = some_of(subject for _, subject in others)
            which = f" ({named})" if named else ""
            times = counted(len(others), "time")
            warn(f'this warning was repeated {times}{numbers}{which}: "{start}"')


def print_error(message: str) -> None:
    say(f"Error: {one_line(message)}", errors, "red")


@cache
def hint_at_kernels() -> None:
    # Kernels that do not exist are an error of this import, which this module prints.
    from restitution.numerics.convolution.device import CPU, current
    from restitution.numerics.kernels import missing

    if current() is CPU and (why := missing()):
        say(f"Hint: {why}", errors)


def command(verb: str, *arguments: object) -> str:
    """Format a command line that calls `verb`, quoted for a shell."""
    return shlex.join(["restitution", verb, *map(str, arguments)])


def say_written(path: Path, names: Iterable[str] = ()) -> None:
    """Print that the file `path` was written, or the files `names` in the folder `path`."""
    inside = ", ".join(names)
    say(f"In {path}: {inside}" if inside else f"Written: {path}")


def say_next(line: str) -> None:
    say(f"Next: {line}")


def progress_bar(*counts: ProgressColumn) -> Progress:
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
    """Show the progress of several `cases` (None if their number is unknown) with results in `out`.

    `resume` is the command that continues the computation. After an interruption it is printed
    again, and the process exits with the status that shells expect.
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
