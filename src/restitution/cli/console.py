"""The two consoles: standard output for answers, standard error for progress and warnings."""

import shlex
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from rich.cells import cell_len
from rich.console import Console
from rich.table import Column, Table

from restitution.errors import one_line

answers = Console(highlight=False)
errors = Console(stderr=True, highlight=False)


def say(text: str, console: Console = answers, style: str | None = None) -> None:
    """Print `text` verbatim as one line, without markup and without wrapping."""
    console.print(text, style=style, markup=False, soft_wrap=True)


def table_of_numbers(*columns: str | Column) -> Table:
    """Make an empty table. A column whose header is given as a plain text is right-aligned."""
    each = (
        column if isinstance(column, Column) else Column(column, justify="right", no_wrap=True)
        for column in columns
    )
    return Table(*each, box=None, header_style="bold")


def print_numbers(table: Table) -> None:
    """Print a table of numbers without cutting its cells, even if it is wider than the terminal."""
    for column in table.columns:
        cells = column.header, *column.cells
        lines = (line for cell in cells for line in str(cell).split("\n"))
        column.min_width = max(map(cell_len, lines))
    answers.print(table, crop=False)


def warn(message: str) -> None:
    """Print one warning on standard error."""
    say(f"Warning: {one_line(message)}", errors, "yellow")


def print_error(message: str) -> None:
    """Print one error on standard error."""
    say(f"Error: {one_line(message)}", errors, "red")


@cache
def hint_at_kernels() -> None:
    """Print a hint on standard error if solves are slow because compiled kernels are missing."""
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
    """Print the command that usually comes next."""
    say(f"Next: {line}")
