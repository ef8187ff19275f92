"""Errors that the user can fix.

Each message is one sentence. It names the key, file or quantity at fault, and then the remedy. The
command line prints the message in red on one line and exits with status 1.
"""


class RestitutionError(Exception):
    """A problem with the input or the computation; the message says what to change."""


class CaseError(RestitutionError, ValueError):
    """Invalid values in a case file or in the arguments of a function."""


class SurfaceError(RestitutionError, ValueError):
    """A surface or a topography file is not suitable for the requested operation."""


class NotConvergedError(RestitutionError):
    """A solve did not reach its tolerance, or loading or unloading did not reach its end.

    There is no result.
    """


class DomainError(RestitutionError):
    """The contact reaches the edge of the grid, or a value lies outside the computed range.

    Contact at the edge is an error because material beyond the edge would support part of the load
    but is not modelled. Results are not extrapolated beyond the computed range.
    """


class OutputError(RestitutionError):
    """A results folder or file is missing, damaged, not writable, or must not be overwritten."""


def one_line(text: str) -> str:
    """Escape line breaks and other control characters in `text`, so that it stays on one line."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def shown(value: object, limit: int = 60) -> str:
    """Format a user's value for use in a message, on one line of at most `limit` characters.

    Strings are put in quotes, which are not counted.
    """
    if isinstance(value, bool):
        return str(value).lower()  # TOML writes true and false in lower case
    try:
        text = one_line(value if isinstance(value, str) else repr(value))
    except ValueError:  # Python refuses to print an integer of more than 4300 digits
        return "a number of thousands of digits"
    text = text if len(text) <= limit else f"{text[: limit - 1]}…"
    return f'"{text}"' if isinstance(value, str) else text
