"""`restitution compare-theory`: COR of smooth bodies from published closed-form theories."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator
from pathlib import Path

from rich.table import Column, Table

from restitution.case.case_file import naming, read_case
from restitution.cli.console import (
    answers,
    command,
    print_numbers,
    say,
    say_next,
    say_written,
    table_of_numbers,
)
from restitution.cli.parameters import FigureFormat
from restitution.compare import theories
from restitution.compare.area_theory import AreaTheory, area_of_case, area_of_results
from restitution.compare.theories import Theory
from restitution.display import quantity
from restitution.errors import CaseError
from restitution.laws.law_files import read_law
from restitution.plots.law import theory_figure
from restitution.plots.periodic import area_theory_figure
from restitution.plots.static import write_figure
from restitution.results.periodic import PeriodicResults
from restitution.results.tables import is_periodic


def compare_theory(case: Path, out: Path | None, law: Path | None, figures: FigureFormat) -> None:
    if case.is_dir() and is_periodic(case):
        _refuse(law)
        _compare_area(area_of_results(PeriodicResults(case)), case, out, figures)
        return
    read, _ = read_case(case)
    if read.periodic:
        _refuse(law)
        with naming(case):
            areas = area_of_case(read, case.parent)
        _compare_area(areas, case, out, figures)
        return
    points = None if law is None else read_law(law)
    with naming(case):
        if points is not None:
            theories.check_same_pair(read, points)
        velocities = theories.velocities_of(read, points)
        curves = theories.theories(read, velocities, points)
        missing = theories.left_out(read, points)
    written = []
    if out is not None:
        lines = theories.theory_lines(read, velocities, curves)
        figure = theory_figure(read.title, lines, theories.marks(read), points)
        written += [
            theories.write_theories(velocities, curves, out),
            write_figure(out / "theory", figure, figures.value),
        ]

    say('COR of the smooth bodies at impact velocities (m/s); "-": outside the range of a theory')
    for table in _tables(velocities.tolist(), curves, answers.width):
        answers.print(table)
    for curve in curves:
        say(f"{curve.name}: {curve.source}")
        say(f"  holds: {curve.holds}")
        if curve.parameters:
            values = ", ".join(f"{name} {value:.4g}" for name, value in curve.parameters.items())
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
    if law is not None:
        raise CaseError(
            "--law: a periodic contact has no restitution law; leave out --law (to compare with "
            "computed areas, give the results folder of the contact instead of a case file)"
        )


def _tables(velocities: list[float], curves: list[Theory], width: int) -> Iterator[Table]:
    heads = ["\n".join(textwrap.wrap(curve.name, 9, break_long_words=False)) for curve in curves]
    start = 0
    while start < len(curves):
        end, left = start, width - 11  # 11 characters for the column of velocities
        while end < len(curves) and (end == start or left >= _width(heads[end])):
            left -= _width(heads[end])
            end += 1
        columns = (Column(h, justify="right", no_wrap=True) for h in ("m/s", *heads[start:end]))
        table = Table(*columns, box=None, header_style="bold", pad_edge=False)
        for k, V in enumerate(velocities):
            cells = (float(curve.restitution[k]) for curve in curves[start:end])
            table.add_row(f"{V:.4g}", *("-" if math.isnan(e) else f"{e:.4f}" for e in cells))
        yield table
        start = end


def _width(head: str) -> int:
    return max(map(len, head.split("\n"))) + 2


def _compare_area(areas: AreaTheory, source: Path, out: Path | None, figures: FigureFormat) -> None:
    written = []
    if out is not None:
        written = [
            areas.write(out),
            write_figure(out / "theory", area_theory_figure(areas), figures.value),
        ]
    theory, computed = areas.theory, bool((areas.computed >= 0).any())
    slope, E_star = float(theory.rms_slope), float(theory.contact_modulus)
    say("Relative contact area of the rough surface; a periodic contact has no COR")
    print_numbers(_area_table(areas, computed))
    say(
        "persson: erf(√2 p/(E* h′)), B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; elastic, "
        "without adhesion"
    )
    say(f"  with: rms slope h′ = {slope:.4g}, E* = {quantity(E_star, 'Pa')}")
    if areas.left_out:
        say(f"  the theory leaves out the {areas.left_out} of these bodies")
    if computed:
        say(
            "kappa: computed area divided by p/(E* h′); at low pressure 1.60 in Persson's theory, "
            "2.51 in that of Bush, Gibson and Thomas (1975)"
        )
    if out is not None:
        say_written(out, [path.name for path in written])
    if not computed:
        say_next(
            f"{command('run', source, '-o', 'RESULTS')}, then "
            f"{command('compare-theory', 'RESULTS')} (adds computed areas)"
        )


def _area_table(areas: AreaTheory, computed: bool) -> Table:
    columns = ["pressure (MPa)", "persson (%)"]
    if computed:
        columns += ["computed (%)", "computed/persson", "kappa", "stiffness (MPa/nm)"]
    table = table_of_numbers(*columns)
    for p, area, computed_area, kappa, k in zip(
        areas.pressure, areas.area, areas.computed, areas.kappa, areas.stiffness, strict=True
    ):
        cells = [f"{1e-6 * p:.4g}", f"{100 * area:.4g}"]
        if computed:
            cells += [f"{100 * computed_area:.4g}", f"{computed_area / area:.3f}", f"{kappa:.3f}"]
            cells.append("-" if math.isnan(k) else f"{1e-15 * k:.4g}")
        table.add_row(*cells)
    return table
