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

    kinds = {"dem": dem, "scan": scan, "study": study}
    chosen = [kind for kind, wanted in kinds.items() if wanted]
    if len(chosen) > 1:
        raise CaseError(f"--{', --'.join(chosen)}: choose one of them")
    kind = chosen[0] if chosen else "case"
    file = out or Path("study.toml" if study else "case.toml")
    require_new_file(file)
    text = (files("restitution.cli") / "templates" / f"{kind}.toml").read_text("utf-8")
    with writing(file.parent):
        file.write_text(text, encoding="utf-8")
    say_written(file)
    say_next(command("check", file))
