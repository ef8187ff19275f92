"""`restitution fit-law`: COR against impact velocity, and the force laws fitted to it."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Column, Table

from restitution.cli.parameters import FigureFormat, Figures

if TYPE_CHECKING:
    from restitution.laws.law import FittedLaw, Law


def fit_law(
    results: Annotated[
        Path,
        typer.Argument(
            metavar="RESULTS",
            help="Results folder of a run, ensemble or convergence study.",
            show_default=False,
            readable=False,
        ),
    ],
    out: Annotated[
        Path,
        typer.Option(
            "-o", "--out", metavar="OUT", help="Folder for the law; new or empty.", readable=False
        ),
    ],
    figures: Figures = FigureFormat.png,
) -> None:
    """Write the restitution law of RESULTS to OUT: table, compact fit and fitted force laws."""
    from restitution.cli.console import answers, command, say, say_next, say_written, warn
    from restitution.cli.progress import spinner

    with spinner("reading the results") as show:
        from restitution.dem.fits import fit_law as fitted
        from restitution.dem.fits import too_few_points
        from restitution.laws.law_files import write_law
        from restitution.plots.law import law_figure
        from restitution.plots.static import write_figure

        found = fitted(results, lambda name, k, n: show(f"fitting {name} ({k} of {n})"))
        written = write_law(found, out)
        show("drawing the figure")
        written.append(write_figure(out / "law", law_figure(found), figures.value))
    for warning in filter(None, (*found.warnings, too_few_points(found))):
        warn(warning)
    say(
        f"{found.pair}: {len(found.points)} velocities, {found.lowest:.4g} to "
        f"{found.highest:.4g} m/s"
    )
    for line in _in_words(found):
        say(line)
    if found.laws:
        answers.print(_table(found.laws))
    if found.laws:
        say(
            "The columns rms and worst state how far the fitted laws differ from COR. COR itself "
            f"has an error of up to {max(point.error for point in found.points):.2g}."
        )
    say(f"The error of COR includes {found.conventions.restitution_error}.")
    say_written(out, [path.name for path in written])
    if found.sticks_everywhere:
        return
    middle = (max(found.lowest, found.sticks_below or 0.0) * found.highest) ** 0.5
    speed = f"{middle:.2g} m/s"
    say_next(command("export", out, "--to", "lammps", "--velocity", speed, "-o", "OUT"))


def _in_words(law: "Law") -> Iterator[str]:
    from restitution.laws.law import LOSS

    if law.sticks_below is not None:
        yield f"sticks below {law.sticking}"
    if law.fit is None and law.column("restitution").min() > 1 - LOSS:
        yield "COR is 1 at all of these velocities: there is nothing to fit"
    elif law.fit is None:
        yield "no compact fit: too few resolved velocities (four or more are needed)"
    else:
        yield (
            f"compact fit: {len(law.fit.coefficients)} coefficients; it differs from COR by at "
            f"most {law.fit.worst:.1g} at the velocities and {law.fit.between:.1g} between them"
        )
    if unresolved := sum(not point.resolved for point in law.points):
        yield f"{unresolved} of {len(law.points)} velocities are not resolved by the grid"


def _table(laws: "tuple[FittedLaw, ...]") -> Table:
    table = Table(
        "fitted law",
        Column("parameters", overflow="fold"),
        Column("COR: rms", justify="right"),
        Column("worst", justify="right"),
        box=None,
        header_style="bold",
    )
    for each in laws:
        parameters = ", ".join(f"{name} {value:.4g}" for name, value in each.parameters.items())
        if each.pull_off_misfit is not None:
            parameters += f"; pull-off force within {100 * each.pull_off_misfit:.2g} %"
        table.add_row(each.name, parameters, f"{each.rms:.3f}", f"{each.worst:.3f}")
    return table
