"""The two consoles: answers on standard output, everything about the run on standard error."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Timer
from typing import TYPE_CHECKING

from rich.console import Console

from restitution.errors import one_line

if TYPE_CHECKING:
    from rich.table import Table

_PATIENCE = 2.0  # s without a sign of life

answers = Console(highlight=False)
errors = Console(stderr=True, highlight=False)


def say(text: str, console: Console = answers, style: str | None = None) -> None:
    """Print one line as it is, without markup and not wrapped."""
    console.print(text, style=style, markup=False, soft_wrap=True)


def table_of_numbers(*columns: str) -> "Table":
    """An empty table with columns of those names."""
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
    """Say on standard error, once, where solves are slow for want of compiled kernels."""
    from restitution.numerics.convolution.device import CPU, current
    from restitution.numerics.kernels import missing

    if current() is CPU and (why := missing()):
        say(f"Hint: {why}", errors)


@contextmanager
def waiting(words: str) -> Iterator[None]:
    """Show a spinner with `words` on standard error where the block takes more than two seconds."""
    status = errors.status(words)
    later = Timer(_PATIENCE, status.start)
    later.daemon = True
    later.start()
    try:
        yield
    finally:
        later.cancel()
        later.join()  # it may be starting the spinner right now
        status.stop()
