"""Write the page of a results folder of any kind."""

from __future__ import annotations

from pathlib import Path

from restitution.errors import OutputError, RestitutionError, one_line
from restitution.pages.many import write_mixture_page, write_study_page
from restitution.pages.periodic import write_periodic_page
from restitution.pages.run import write_run_page
from restitution.pages.surface import write_surface_page
from restitution.results.schema import PERIODIC_FILE

# For each kind of results, a file that identifies it and the function that writes its page.
_PAGES = {
    "mixture.toml": write_mixture_page,
    "study.toml": write_study_page,
    PERIODIC_FILE: write_periodic_page,  # before results.nc, which such a folder also holds
    "results.nc": write_run_page,
    "surface.nc": write_surface_page,
}


def write_report(out: Path) -> Path:
    for name, write in _PAGES.items():
        if (out / name).is_file():
            try:
                return write(out)
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
