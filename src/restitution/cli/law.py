"""`restitution fit-law` and `restitution export`: restitution laws."""

from collections.abc import Iterator
from pathlib import Path

from rich.table import Column, Table

from restitution.cli.console import (
    answers,
    command,
    say,
    say_next,
    say_written,
    spinner,
    warn,
    warn_once,
)
from restitution.cli.parameters import ExportFormat, FigureFormat, UnitSystem
from restitution.dem.export import export as exported
from restitution.dem.export import limit, unset, write_export
from restitution.dem.fits import fit_law as law_of
from restitution.dem.fits import too_few_points, with_fits
from restitution.laws.coverage import at_coverage, coverage_of
from restitution.laws.law import LOSS, FittedLaw, Law, velocity_of
from restitution.laws.law_files import read_laws, write_law
from restitution.plots.law import law_figure
from restitution.plots.static import write_figure


def fit_law(results: Path, out: Path, figures: FigureFormat) -> None:
    with spinner("reading the results") as show:
        law = law_of(results, lambda name, k, n: show(f"fitting {name} ({k} of {n})"))
        written = write_law(law, out)
        show("drawing the figure")
        written.append(write_figure(out / "law", law_figure(law), figures.value))
    for warning in filter(None, (*law.warnings, too_few_points(law))):
        warn(warning)
    say(f"{law.pair}: {len(law.points)} velocities, {law.lowest:.4g} to {law.highest:.4g} m/s")
    for line in _in_words(law):
        say(line)
    if law.laws:
        answers.print(_table(law.laws))
        say(
            "The columns rms and worst state how far the fitted laws differ from COR. COR itself "
            f"has an error of up to {max(point.error for point in law.points):.2g}."
        )
    say(f"The error of COR includes {law.conventions.restitution_error}.")
    say_written(out, [path.name for path in written])
    if law.sticks_everywhere:
        return
    middle = (max(law.lowest, law.sticks_below or 0.0) * law.highest) ** 0.5
    speed = f"{middle:.2g} m/s"
    say_next(command("export", out, "--to", "lammps", "--velocity", speed, "-o", "OUT"))


def _in_words(law: "Law") -> Iterator[str]:
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
    for fit in laws:
        parameters = ", ".join(f"{name} {value:.4g}" for name, value in fit.parameters.items())
        if fit.pull_off_misfit is not None:
            parameters += f"; pull-off force within {100 * fit.pull_off_misfit:.2g} %"
        table.add_row(fit.name, parameters, f"{fit.rms:.3f}", f"{fit.worst:.3f}")
    return table


def export(
    laws: list[Path],
    to: ExportFormat,
    out: Path,
    velocity: str | None,
    coverage: str | None,
    size: float,
    units: UnitSystem,
) -> None:
    read = read_laws(laws)
    if coverage is not None:
        read = [with_fits(at_coverage(law, coverage_of(coverage))) for law in read]
    at = None if velocity is None else velocity_of(velocity)
    texts = exported(read, to.value, at, size=size, units=units.value)
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
            point = law.at(at)
            say(f"{law.pair}: COR {point.restitution:.4f} ± {point.error:.2g} at {at:g} m/s")
    for note in filter(None, (*unset(read, to.value), limit(to.value))):
        say(note)
    say_written(out, [path.name for path in written])
