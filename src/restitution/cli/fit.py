"""`restitution fit`: find the parameters of a case that explain measured restitution."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Column, Table

from restitution.cli.parameters import FigureFormat, Figures, OutFolder

if TYPE_CHECKING:
    from restitution.calibration.fit import Fit


def fit(
    measured: Annotated[
        Path,
        typer.Argument(
            metavar="MEASURED",
            help="CSV file with the columns velocity_m_per_s, restitution and, if known, "
            "restitution_std.",
            show_default=False,
            readable=False,
        ),
    ],
    case: Annotated[
        Path,
        typer.Option(
            "--case",
            metavar="CASE",
            help="Case file (TOML); its values of KEYS are the first guesses.",
            readable=False,
        ),
    ],
    free: Annotated[
        list[str],
        typer.Option(
            metavar="KEYS",
            help="Keys of CASE to be fitted, separated by commas, such as yield_strength,rms.",
        ),
    ],
    out: OutFolder,
    figures: Figures = FigureFormat.png,
) -> None:
    """Find the values of KEYS in CASE that explain the restitution in MEASURED."""
    from restitution.calibration import fit as calibration
    from restitution.calibration.findings import findings
    from restitution.calibration.fit_files import write_fit
    from restitution.calibration.measured import read_measured
    from restitution.case.case_file import naming, read_case
    from restitution.cli.console import (
        answers,
        command,
        hint_at_kernels,
        say,
        say_next,
        say_written,
        warn,
    )
    from restitution.cli.progress import spinner
    from restitution.display import counted
    from restitution.plots.fit import fit_figure
    from restitution.plots.static import write_figure
    from restitution.results.writer import make_folder

    names = [name.strip() for part in free for name in part.split(",") if name.strip()]
    table = read_measured(measured)
    _, text = read_case(case)
    new = make_folder(out)
    hint_at_kernels()
    try:
        with naming(case), spinner("fitting") as show:
            found = calibration.fit(
                text, case.parent, table, names, lambda words: show(f"fitting: {words}")
            )
    except BaseException:
        if new:
            out.rmdir()
        raise
    written = [
        *write_fit(found, text, out),
        write_figure(out / "fit", fit_figure(found), figures.value),
    ]
    answers.print(_table(found))
    rms = float((found.residuals**2).mean() ** 0.5)
    say(
        f"{counted(found.measured.velocity.size, 'point')}, rms residual of COR {rms:.2g}, "
        f"{counted(found.model.evaluations, 'curve')} computed"
    )
    for sentence in findings(found):
        warn(sentence)
    say_written(out, [path.name for path in written])
    say_next(command("run", out / "case.toml", "-o", "RESULTS"))


def _table(found: "Fit") -> Table:
    from restitution.calibration.findings import identifiable, interval_in_words
    from restitution.cli.console import table_of_numbers

    heads = ("fitted", "95 % interval", "± model", "± one place")
    table = table_of_numbers(Column("parameter", overflow="fold"), *heads)
    by = found.uncertainty
    for k, parameter in enumerate(found.parameters):
        table.add_row(
            parameter.key,
            parameter.text(found.factors[k]),
            interval_in_words(found, k) if identifiable(found, k) else "not identifiable",
            *(f"{100 * each[k]:.2g} %" for each in (by.by_model, by.by_one_place)),
        )
    return table
