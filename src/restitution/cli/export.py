"""`restitution export`: laws as the input of a DEM code."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Code(StrEnum):
    """What laws can be exported to."""

    lammps = "lammps"
    liggghts = "liggghts"
    yade = "yade"
    mercurydpm = "mercurydpm"
    edem = "edem"
    mujoco = "mujoco"
    drake = "drake"
    csv = "csv"


def export(
    laws: Annotated[
        list[Path],
        typer.Argument(
            metavar="LAW...",
            help="Folders of `restitution fit-law`, one for every pair of particles.",
            show_default=False,
            readable=False,
        ),
    ],
    to: Annotated[Code, typer.Option(help="DEM code.", show_default=False)],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the files.", readable=False)],
    velocity: Annotated[
        str | None,
        typer.Option(help='Impact velocity, such as "1 m/s"; not needed for csv.'),
    ] = None,
) -> None:
    """Write input for a DEM code: the restitution of every pair, with what it holds for."""
    from restitution.cli.console import say, warn
    from restitution.dem.export import export as exported
    from restitution.dem.export import limit, write_export
    from restitution.laws.law import velocity_of
    from restitution.laws.law_files import read_law

    read = [read_law(law) for law in laws]
    at = None if velocity is None else velocity_of(velocity)
    texts = exported(read, to.value, at)
    for law in read:
        for warning in law.warnings:
            warn(f"{law.pair}: {warning}")
        if at is not None and not law.at(at).resolved:
            warn(f"{law.pair}: not resolved by the grid at {at:g} m/s; the files say so, too")
    written = write_export(texts, out)
    if at is not None:
        for law in read:
            found = law.at(at)
            say(f"{law.pair}: COR {found.restitution:.4f} ± {found.error:.2g} at {at:g} m/s")
    if note := limit(to.value):
        say(note)
    names = ", ".join(path.name for path in written)
    say(f"In {out}: {names}")
