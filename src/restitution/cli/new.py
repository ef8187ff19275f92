"""`restitution new`: a commented case or study file to start from."""

from pathlib import Path
from typing import Annotated

import typer


def new(
    dem: Annotated[
        bool,
        typer.Option(
            "--dem", help="Write a case for a DEM code, with COR against impact velocity."
        ),
    ] = False,
    scan: Annotated[
        bool, typer.Option("--scan", help="Write a case with a measured surface.")
    ] = False,
    study: Annotated[
        bool, typer.Option("--study", help="Write a study, which is a case with a table \\[sweep].")
    ] = False,
    powder: Annotated[
        bool,
        typer.Option(
            "--powder",
            help="Write a case for a fine adhesive powder, on a grid that resolves its adhesion.",
        ),
    ] = False,
    values: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="With --powder: material, radius, rms, correlation_length or work_of_adhesion, "
            'for example radius="2 um"; may be repeated.',
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            metavar="FILE",
            help="File to write; an existing file is never overwritten.",
            show_default="case.toml, or study.toml",
            readable=False,
        ),
    ] = None,
) -> None:
    """Write a commented case file or study file to start from."""
    from importlib.resources import files

    from restitution.cli.console import command, say_next, say_written
    from restitution.errors import CaseError
    from restitution.results.writer import require_new_file, writing

    kinds = {"dem": dem, "scan": scan, "study": study, "powder": powder}
    chosen = [kind for kind, wanted in kinds.items() if wanted]
    if len(chosen) > 1:
        raise CaseError(f"--{', --'.join(chosen)}: choose one of them")
    kind = chosen[0] if chosen else "case"
    file = out or Path("study.toml" if study else "case.toml")
    require_new_file(file)
    text = (files("restitution.cli") / "templates" / f"{kind}.toml").read_text("utf-8")
    if values and not powder:
        raise CaseError("--set: belongs to --powder; edit the written file instead")
    if powder:
        text = _powder(text, values or [])
    with writing(file.parent):
        file.write_text(text, encoding="utf-8")
    say_written(file)
    say_next(command("check", file))


# The values of a powder that `--set` replaces.
_POWDER = {
    "material": "silica",
    "radius": "5 um",
    "rms": "10 nm",
    "correlation_length": "0.3 um",
    "work_of_adhesion": "0.05 J/m^2",
}


def _powder(template: str, given: list[str]) -> str:
    """Fill in the template of a powder."""
    from string import Template

    from restitution.cli.console import errors
    from restitution.errors import CaseError
    from restitution.runs.powder import powder_grid

    values = dict(_POWDER)
    for item in given:
        key, equals, value = (part.strip() for part in item.partition("="))
        if key not in values or not equals or not value:
            raise CaseError(
                f'--set: "{item}" should be KEY=VALUE with one of {", ".join(_POWDER)}, for '
                'example radius="2 um"'
            )
        values[key] = value
    values["title"] = f"{values['material']}, {values['radius']}, Rq {values['rms']}"
    with errors.status("choosing a grid that resolves the adhesion"):
        return Template(template).substitute(values, **powder_grid(template, values))
