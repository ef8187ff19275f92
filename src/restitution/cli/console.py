"""The two consoles: answers on standard output, everything about the run on standard error."""

from rich.console import Console

from restitution.errors import one_line

answers = Console(highlight=False)
errors = Console(stderr=True, highlight=False)


def warn(message: str) -> None:
    """Print one warning on standard error."""
    errors.print(f"Warning: {one_line(message)}", style="yellow", markup=False, soft_wrap=True)


def refuse(message: str) -> None:
    """Print one error on standard error."""
    errors.print(
        f"Error: {one_line(message)}", style="red", highlight=False, markup=False, soft_wrap=True
    )
