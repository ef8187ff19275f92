"""`restitution fit`: find the parameters of a case that explain measured restitution."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from restitution.cli.parameters import FigureFormat, Figures, OutFolder

if TYPE_CHECKING:
    from restitution.fit.fit import Fit


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
    from restitution.case.case_file import naming, read_case
    from restitution.cli.console import (
        command,
        hint_at_kernels,
        say,
        say_next,
        say_written,
        warn,
    )
    from restitution.cli.progress import spinner
    from restitution.display import counted
    from restitution.fit.findings import findings
    from restitution.fit.fit import fit as fitted
    from restitution.fit.fit_files import write_fit
    from restitution.fit.measured import read_measured
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
            found = fitted(text, case.parent, table, names, lambda words: show(f"fitting: {words}"))
    except BaseException:
        if new:
            out.rmdir()
        raise
    written = [
        *write_fit(found, text, out),
        write_figure(out / "fit", fit_figure(found), figures.value),
    ]
    for k in range(found.x.size):
        say(_parameter(found, k))
    rms = float((found.residuals**2).mean() ** 0.5)
    say(
        f"{counted(found.measured.velocity.size, 'point')}, rms residual of COR {rms:.2g}, "
        f"{counted(found.model.evaluations, 'curve')} computed"
    )
    if table.deviation is None:
        noise = (float((found.residuals**2).sum()) / found.freedom) ** 0.5
        say(
            "MEASURED has no column restitution_std: every point is assumed to have the standard "
            f"deviation {noise:.2g}, estimated from the residuals"
        )
    if above := int((table.restitution > 1).sum()):
        say(f"{above} of the measured COR are above 1; they are not cut, which would bias the fit")
    for sentence in findings(found):
        warn(sentence)
    say_written(out, [path.name for path in written])
    say_next(command("run", out / "case.toml", "-o", "RESULTS"))


def _parameter(found: "Fit", k: int) -> str:
    """The value of a parameter with its intervals: with the model first, then of the data alone."""
    from restitution.fit.findings import identifiable, interval_in_words

    parameter, uncertainty = found.parameters[k], found.uncertainty
    value = f"{parameter.key} = {parameter.text(found.factors[k])}"
    if not identifiable(found, k):
        return f"{value}, not identifiable"
    place = f"{100 * uncertainty.by_one_place[k]:.2g} %"
    lines = [
        f"{value}, 95 % interval {interval_in_words(found, k, model=True)} (data and model)",
        f"  of the data alone: {interval_in_words(found, k)}",
    ]
    if uncertainty.by_one_place[k] > 0:
        lines.append(f"  if all impacts hit one place: ± {place}, one standard deviation")
    return "\n".join(lines)
