"""`restitution compare-theory`: COR of smooth bodies from published closed-form theories."""

import math
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Column, Table

from restitution.cli.parameters import FigureFormat, Figures
from restitution.errors import CaseError

if TYPE_CHECKING:
    from restitution.compare.theories import Theory


def compare_theory(
    case: Annotated[
        Path,
        typer.Argument(
            metavar="CASE",
            help="Case file (TOML), or the results folder of a periodic contact.",
            show_default=False,
            readable=False,
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            metavar="OUT",
            help="Folder for theory.csv and the figure theory.png; new or empty.",
            readable=False,
        ),
    ] = None,
    law: Annotated[
        Path | None,
        typer.Option(
            "--law",
            metavar="LAW",
            help="Folder that `restitution fit-law` wrote for the same pair; adds the computed "
            "points of this law.",
            readable=False,
        ),
    ] = None,
    figures: Figures = FigureFormat.png,
) -> None:
    """Print COR against velocity for the smooth bodies of CASE, from closed-form theories.

    For a periodic contact, print its contact area against nominal pressure, from Persson's theory.
    """
    from restitution.case.case_file import naming, read_case
    from restitution.cli.area_theory import compare_area
    from restitution.cli.console import answers, command, say, say_next, say_written
    from restitution.compare import theories
    from restitution.compare.area_theory import area_of_case, area_of_results
    from restitution.laws.law_files import read_law
    from restitution.plots.static import write_figure
    from restitution.plots.theories import theory_figure
    from restitution.results.periodic import PeriodicResults
    from restitution.results.tables import is_periodic

    if case.is_dir() and is_periodic(case):
        _refuse(law)
        compare_area(area_of_results(PeriodicResults(case)), case, out, figures)
        return
    read, _ = read_case(case)
    if read.periodic:
        _refuse(law)
        with naming(case):
            areas = area_of_case(read, case.parent)
        compare_area(areas, case, out, figures)
        return
    points = None if law is None else read_law(law)
    with naming(case):
        if points is not None:
            theories.check_same_pair(read, points)
        velocities = theories.velocities_of(read, points)
        found = theories.theories(read, velocities, points)
        missing = theories.left_out(read, points)
    written = []
    if out is not None:
        lines = theories.theory_lines(read, velocities, found)
        figure = theory_figure(read.title, lines, theories.marks(read), points)
        written += [
            theories.write_theories(velocities, found, out),
            write_figure(out / "theory", figure, figures.value),
        ]

    say('COR of the smooth bodies at impact velocities (m/s); "-": outside the range of a theory')
    for table in _tables(velocities.tolist(), found, answers.width):
        answers.print(table)
    for each in found:
        say(f"{each.name}: {each.source}")
        say(f"  holds: {each.holds}")
        if each.parameters:
            values = ", ".join(f"{name} {value:.4g}" for name, value in each.parameters.items())
            say(f"  with: {values}")
    for reason in dict.fromkeys(missing.values()):
        names = ", ".join(name for name, why in missing.items() if why == reason)
        say(f"left out: {names} ({reason})")
    if {"sticking", "thornton-ning"} <= missing.keys():
        say("The bodies are elastic and do not adhere: only Hertz theory applies, and COR is 1.")
    if out is not None:
        say_written(out, [path.name for path in written])
    if law is None:
        say_next(command("compare-theory", case, "--law", "LAW") + " (adds computed points)")


def _refuse(law: Path | None) -> None:
    """Raise `CaseError` if a law is given for a periodic contact."""
    if law is not None:
        raise CaseError(
            "--law: a periodic contact has no restitution law; leave out --law (to compare with "
            "computed areas, give the results folder of the contact instead of a case file)"
        )


def _tables(velocities: list[float], found: "list[Theory]", width: int) -> Iterator[Table]:
    """Make tables of COR that fit into `width` characters. Each theory is a column of a table."""
    heads = ["\n".join(textwrap.wrap(each.name, 9, break_long_words=False)) for each in found]
    start = 0
    while start < len(found):
        end, left = start, width - 11  # 11 characters for the column of velocities
        while end < len(found) and (end == start or left >= _width(heads[end])):
            left -= _width(heads[end])
            end += 1
        columns = (Column(h, justify="right", no_wrap=True) for h in ("m/s", *heads[start:end]))
        table = Table(*columns, box=None, header_style="bold", pad_edge=False)
        for k, V in enumerate(velocities):
            cells = (float(each.restitution[k]) for each in found[start:end])
            table.add_row(f"{V:.4g}", *("-" if math.isnan(e) else f"{e:.4f}" for e in cells))
        yield table
        start = end


def _width(head: str) -> int:
    return max(map(len, head.split("\n"))) + 2
