"""Arguments and options that several verbs share.

In the help, OUT stands for a folder that a verb writes, and FILE for a single file. Most inputs
have a placeholder that says what they contain, such as CASE or RESULTS.
"""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from restitution.errors import not_one_of


def one_of(words: type[StrEnum], *names: str, **more: Any) -> Any:
    """Make an option whose value is one of `words`; the error suggests the most similar word.

    `more` contains further arguments of `typer.Option`.
    """

    def parse(text: str) -> StrEnum:
        try:
            return words(text)
        except ValueError:
            raise typer.BadParameter(not_one_of(text, words)) from None

    def complete(incomplete: str) -> list[str]:
        return [word for word in words if word.startswith(incomplete)]

    more = {"metavar": f"<{'|'.join(words)}>", **more}
    return typer.Option(*names, parser=parse, autocompletion=complete, **more)


def given(metavar: str, help_text: str) -> Any:
    """Make an argument for a path without a default."""
    return typer.Argument(metavar=metavar, help=help_text, show_default=False, readable=False)


def output(metavar: str, help_text: str, **more: Any) -> Any:
    """Make the option for a file or folder that a verb writes."""
    return typer.Option("-o", "--out", metavar=metavar, help=help_text, readable=False, **more)


class DeviceName(StrEnum):
    """Devices that solves can run on."""

    cpu = "cpu"
    gpu = "gpu"
    auto = "auto"


class FigureFormat(StrEnum):
    """File formats of figures."""

    png = "png"
    svg = "svg"
    pdf = "pdf"


# DEM codes and formats to which laws can be exported.
ExportFormat = StrEnum(
    "ExportFormat", ["lammps", "liggghts", "yade", "mercurydpm", "edem", "mujoco", "drake", "csv"]
)

CaseFile = Annotated[Path, given("CASE", "Case file (TOML).")]
OutFolder = Annotated[Path, output("OUT", "Folder for the results; new or empty.")]
OnDevice = Annotated[
    DeviceName,
    one_of(
        DeviceName,
        "--device",
        help="Device for the solves; auto uses a GPU if one is available. A GPU needs CuPy.",
    ),
]
Figures = Annotated[FigureFormat, one_of(FigureFormat, "--figures", help="Format of the figures.")]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS", help="Compute on the Dask cluster with this scheduler (tcp://…)."
    ),
]
WorkerCount = Annotated[
    int | None,
    typer.Option(
        "--workers",
        min=1,
        metavar="N",
        help="Number of processes on this machine.",
        show_default="one for each core",
    ),
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Compute only the cases that are not yet in OUT.")
]
