"""What can go wrong for a reason the user can mend.

Every message is one sentence that names the key, file or quantity at fault, followed by the
remedy. The command line prints it as its one red line and exits with status 1.
"""


class RestitutionError(Exception):
    """A problem with the input or the computation whose message says what to change."""


class CaseError(RestitutionError, ValueError):
    """A case (file or arguments) that does not describe a contact."""


class SurfaceError(RestitutionError, ValueError):
    """A surface or a topography file that cannot be used as asked."""


class NotConvergedError(RestitutionError):
    """A solve whose residual stayed above its tolerance; the numbers are withheld."""


class DomainError(RestitutionError):
    """The contact reaches the edge of the grid, so material outside it would carry load."""


class OutputError(RestitutionError):
    """A results folder that cannot be written, or that must not be overwritten."""


def one_line(text: str) -> str:
    """`text` with line breaks and other control characters escaped, so that it stays one line."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def shown(value: object, limit: int = 60) -> str:
    """A value of the user's as a message repeats it: text in quotes, short, and on one line."""
    if isinstance(value, bool):
        return str(value).lower()  # as TOML writes it
    try:
        text = one_line(value if isinstance(value, str) else repr(value))
    except ValueError:  # Python refuses to print an integer of more than 4300 digits
        return "a number of thousands of digits"
    text = text if len(text) <= limit else f"{text[: limit - 1]}…"
    return f'"{text}"' if isinstance(value, str) else text
