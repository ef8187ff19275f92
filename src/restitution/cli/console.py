"""The two consoles: answers on standard output, progress and warnings on standard error."""

import shlex
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from restitution.errors import one_line

if TYPE_CHECKING:
    from rich.status import Status
    from rich.table import Table

answers = Console(highlight=False)
errors = Console(stderr=True, highlight=False)


def say(text: str, console: Console = answers, style: str | None = None) -> None:
    """Print one line verbatim: without markup, and not wrapped."""
    console.print(text, style=style, markup=False, soft_wrap=True)


def table_of_numbers(*columns: str) -> "Table":
    """An empty table with right-aligned columns."""
    from rich.table import Table

    table = Table(box=None, header_style="bold")
    for name in columns:
        table.add_column(name, justify="right", no_wrap=True)
    return table


def warn(message: str) -> None:
    """Print one warning on standard error."""
    say(f"Warning: {one_line(message)}", errors, "yellow")


def print_error(message: str) -> None:
    """Print one error on standard error."""
    say(f"Error: {one_line(message)}", errors, "red")


@cache
def hint_at_kernels() -> None:
    """Say on standard error, once, if solves are slow because compiled kernels are missing."""
    from restitution.numerics.convolution.device import CPU, current
    from restitution.numerics.kernels import missing

    if current() is CPU and (why := missing()):
        say(f"Hint: {why}", errors)


def waiting(words: str) -> "Status":
    """A context manager that shows a spinner with `words` on the standard error of a terminal."""
    return errors.status(words)


def command(verb: str, *arguments: object) -> str:
    """A command line that calls `verb`, quoted for a shell."""
    return shlex.join(["restitution", verb, *map(str, arguments)])


def say_written(path: Path, names: Iterable[str] = ()) -> None:
    """Name the file that a verb has written, or list the `names` of files in a folder."""
    inside = ", ".join(names)
    say(f"In {path}: {inside}" if inside else f"Written: {path}")


def say_next(line: str) -> None:
    """Name the command that usually follows."""
    say(f"Next: {line}")
