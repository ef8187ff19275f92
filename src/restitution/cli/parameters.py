"""The program, and the arguments and options that several verbs share.

In the help, OUT stands for a folder that a verb writes, and FILE for a single file. Most inputs
have a placeholder that says what they contain, such as CASE or RESULTS.
"""

from collections.abc import Callable
from enum import StrEnum
from functools import wraps
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from restitution.errors import not_one_of

program = typer.Typer(
    name="restitution",
    help="Compute the coefficient of restitution (COR) of rough elastic-plastic particles.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
)


def verb(panel: str, module: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add a verb that calls the function of the same name in `module` of this package.

    The module is imported when the verb runs, because NumPy, xarray and matplotlib would delay help
    texts and completion by up to two seconds. (A lazy group of click imports them for the help and
    the completion of its verb.)
    """

    def add(signature: Callable[..., None]) -> Callable[..., None]:
        @wraps(signature)
        def call(**values: Any) -> None:
            getattr(import_module(f"restitution.cli.{module}"), signature.__name__)(**values)

        return program.command(rich_help_panel=panel)(call)

    return add


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        from restitution.numerics.kernels import instruction_set, missing

        typer.echo(f"restitution {version('restitution')}")
        typer.echo(f"compiled kernels: {instruction_set}")
        if why := missing():
            typer.echo(f"Hint: {why}")
        raise typer.Exit


@program.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_print_version,
            is_eager=True,
            help="Print the version and the compiled kernels in use.",
        ),
    ] = False,
) -> None:
    pass


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
    return typer.Argument(metavar=metavar, help=help_text, show_default=False, readable=False)


def output(metavar: str, help_text: str, **more: Any) -> Any:
    return typer.Option("-o", "--out", metavar=metavar, help=help_text, readable=False, **more)


def option(metavar: str, help_text: str, *names: str, **more: Any) -> Any:
    """Make an option with a value; `more` contains further arguments of `typer.Option`."""
    return typer.Option(*names, metavar=metavar, help=help_text, **more)


def flag(name: str, help_text: str) -> Any:
    return typer.Option(name, help=help_text)


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
    "ExportFormat",
    "lammps liggghts yade mercurydpm edem kratos mujoco drake lammps-adhesive liggghts-adhesive "
    "yade-adhesive c python csv",
)

UnitSystem = StrEnum("UnitSystem", "si cgs micro")

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
    option("ADDRESS", "Compute on the Dask cluster with this scheduler (tcp://…)."),
]
WorkerCount = Annotated[
    int | None,
    option(
        "N",
        "Number of processes on this machine.",
        "--workers",
        min=1,
        show_default="one for each core",
    ),
]
Resume = Annotated[bool, flag("--resume", "Compute only the cases that are not yet in OUT.")]
