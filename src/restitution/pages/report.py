"""Write the page of a results folder of any kind."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from restitution.errors import CaseError, OutputError, RestitutionError, one_line
from restitution.pages.many import write_mixture_page, write_study_page
from restitution.pages.periodic import write_periodic_page
from restitution.pages.run import write_run_page
from restitution.pages.surface import write_surface_page
from restitution.results.schema import PERIODIC_FILE

# For each kind of results, a file that identifies it and the function that writes its page.
_PAGES: dict[str, Callable[..., Path]] = {
    "mixture.toml": write_mixture_page,
    "study.toml": write_study_page,
    PERIODIC_FILE: write_periodic_page,  # before results.nc, which such a folder also holds
    "results.nc": write_run_page,
    "surface.nc": write_surface_page,
}
_AT_VELOCITY = ("mixture.toml", "results.nc")  # pages that show COR at one velocity


def write_report(out: Path, velocity: float | None = None) -> Path:
    """Write the page of `out`, with COR at `velocity` (m/s). Raises `RestitutionError`."""
    for name, write in _PAGES.items():
        if (out / name).is_file():
            if velocity is not None and name not in _AT_VELOCITY:
                raise CaseError(
                    f"--velocity: only runs and mixtures have COR at one velocity, and {out} is "
                    "neither; leave it out"
                )
            try:
                return write(out) if velocity is None else write(out, velocity)
            except RestitutionError:
                raise
            except (OSError, LookupError, ValueError, TypeError, AttributeError) as error:
                raise OutputError(
                    f"{out}: its results cannot be read ({type(error).__name__}: "
                    f"{one_line(str(error))}); compute them again"
                ) from error
    raise OutputError(
        f"{out}: holds no results; give a folder that a command wrote with -o (it contains one of "
        f"the files {', '.join(_PAGES)})"
    )
