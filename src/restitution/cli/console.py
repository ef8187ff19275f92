"""The two consoles: answers on standard output, everything about the run on standard error."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Timer

from rich.console import Console

from restitution.errors import one_line

_PATIENCE = 2.0  # s without a sign of life

answers = Console(highlight=False)
errors = Console(stderr=True, highlight=False)


def warn(message: str) -> None:
    """Print one warning on standard error."""
    errors.print(f"Warning: {one_line(message)}", style="yellow", markup=False, soft_wrap=True)


def print_error(message: str) -> None:
    """Print one error on standard error."""
    errors.print(
        f"Error: {one_line(message)}", style="red", highlight=False, markup=False, soft_wrap=True
    )


@cache
def hint_at_kernels() -> None:
    """Say on standard error, once, where solves are slow for want of compiled kernels."""
    from restitution.numerics.convolution.device import CPU, current
    from restitution.numerics.kernels import missing

    if current() is CPU and (why := missing()):
        errors.print(f"Hint: {why}", markup=False, soft_wrap=True)


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
