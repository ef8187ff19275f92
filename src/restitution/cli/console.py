"""The two consoles: answers on standard output, everything about the run on standard error."""

from rich.console import Console

answers = Console(highlight=False)
errors = Console(stderr=True, highlight=False)


def warn(message: str) -> None:
    """Print one warning on standard error."""
    errors.print(f"Warning: {message}", style="yellow", markup=False, soft_wrap=True)
