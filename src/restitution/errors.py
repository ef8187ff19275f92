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
