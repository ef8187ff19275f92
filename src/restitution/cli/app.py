"""The command line: its verbs (subcommands) in groups, and the option `--version`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from restitution.cli import (
    check,
    compare,
    compare_theory,
    converge,
    export,
    fit,
    fit_law,
    live,
    materials,
    mixture,
    new,
    report,
    reproduce,
    run,
    simulate,
    study,
    surface,
)

app = typer.Typer(
    name="restitution",
    help="Compute the coefficient of restitution (COR) of rough elastic-plastic particles.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
)
_VERBS: dict[str, tuple[Callable[..., None], ...]] = {
    "Prepare": (new.new, materials.materials, check.check, surface.surface),
    "Compute": (
        live.app,
        run.run,
        converge.converge,
        study.study,
        mixture.mixture,
        fit.fit,
        reproduce.reproduce,
    ),
    "Use results": (
        report.report,
        compare.compare,
        compare_theory.compare_theory,
        simulate.simulate,
        fit_law.fit_law,
        export.export,
    ),
}
for panel, verbs in _VERBS.items():
    for verb in verbs:
        app.command(rich_help_panel=panel)(verb)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        from restitution.numerics.kernels import instruction_set, missing

        typer.echo(f"restitution {version('restitution')}")
        typer.echo(f"compiled kernels: {instruction_set}")
        if why := missing():
            typer.echo(f"Hint: {why}")
        raise typer.Exit


@app.callback()
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
