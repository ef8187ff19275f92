"""`restitution export`: write laws as the input of a DEM code."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from restitution.cli.parameters import one_of

# DEM codes and formats to which laws can be exported.
Code = StrEnum(
    "Code", ["lammps", "liggghts", "yade", "mercurydpm", "edem", "mujoco", "drake", "csv"]
)


def export(
    laws: Annotated[
        list[Path],
        typer.Argument(
            metavar="LAW",
            help="Folders that `restitution fit-law` wrote, one for each pair of particles, or "
            "the folder that `restitution mixture` wrote.",
            show_default=False,
            readable=False,
        ),
    ],
    to: Annotated[
        Code,
        one_of(Code, metavar="CODE", help=f"DEM code: {', '.join(Code)}.", show_default=False),
    ],
    out: Annotated[
        Path,
        typer.Option("-o", "--out", metavar="OUT", help="Folder for the files.", readable=False),
    ],
    velocity: Annotated[
        str | None,
        typer.Option(
            metavar="VELOCITY", help='Impact velocity, such as "1 m/s"; not needed for csv.'
        ),
    ] = None,
) -> None:
    """Write the input of a DEM code to OUT, with the COR of every pair at VELOCITY."""
    from restitution.cli.console import say, say_written
    from restitution.cli.warn_once import warn_once
    from restitution.dem.export import export as exported
    from restitution.dem.export import limit, unset, write_export
    from restitution.laws.law import velocity_of
    from restitution.laws.law_files import read_laws

    read = read_laws(laws)
    at = None if velocity is None else velocity_of(velocity)
    texts = exported(read, to.value, at)
    with warn_once() as warn:
        for law in read:
            for warning in law.warnings:
                warn(warning, law.pair)
            if at is not None and not law.at(at).resolved:
                warn(
                    f"the grid does not resolve the contact at {at:g} m/s; the files note this",
                    law.pair,
                )
    written = write_export(texts, out)
    if at is not None:
        for law in read:
            found = law.at(at)
            say(f"{law.pair}: COR {found.restitution:.4f} ± {found.error:.2g} at {at:g} m/s")
    for note in filter(None, (*unset(read, to.value), limit(to.value))):
        say(note)
    say_written(out, [path.name for path in written])
