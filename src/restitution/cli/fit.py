"""`restitution fit`: find the parameters of a case that explain measured restitution."""

from pathlib import Path

from restitution.case.case_file import naming, read_case
from restitution.cli.console import (
    command,
    hint_at_kernels,
    say,
    say_next,
    say_written,
    spinner,
    warn,
)
from restitution.cli.parameters import FigureFormat
from restitution.display import counted, quantity
from restitution.errors import CaseError
from restitution.fit.findings import findings, identifiable, interval_in_words
from restitution.fit.fit import Fit
from restitution.fit.fit import fit as fitted
from restitution.fit.fit_files import keys_of, write_fit, write_size_effect
from restitution.fit.indents import fit_size_effect, is_table_of_indents, read_indents
from restitution.fit.measured import read_measured
from restitution.plots.law import fit_figure
from restitution.plots.static import write_figure
from restitution.results.writer import make_folder


def fit(
    measured: Path,
    out: Path,
    case: Path | None,
    free: list[str] | None,
    figures: FigureFormat,
) -> None:
    if is_table_of_indents(measured):
        _fit_indents(measured, out, case, free)
        return
    if case is None or free is None:
        name = "--free" if case else "--case"
        raise CaseError(f"{name}: is missing; restitution is fitted by keys of a case")
    names = [name.strip() for part in free for name in part.split(",") if name.strip()]
    table = read_measured(measured)
    _, text = read_case(case)
    new = make_folder(out)
    hint_at_kernels()
    try:
        with naming(case), spinner("fitting") as show:
            result = fitted(
                text, case.parent, table, names, lambda words: show(f"fitting: {words}")
            )
    except BaseException:
        if new:
            out.rmdir()
        raise
    written = [
        *write_fit(result, text, out),
        write_figure(out / "fit", fit_figure(result), figures.value),
    ]
    for k in range(result.x.size):
        say(_parameter(result, k))
    rms = float((result.residuals**2).mean() ** 0.5)
    say(
        f"{counted(result.measured.velocity.size, 'point')}, rms residual of COR {rms:.2g}, "
        f"{counted(result.model.evaluations, 'curve')} computed"
    )
    if table.deviation is None:
        noise = (float((result.residuals**2).sum()) / result.freedom) ** 0.5
        say(
            "MEASURED has no column restitution_std: every point is assumed to have the standard "
            f"deviation {noise:.2g}, estimated from the residuals"
        )
    if above := int((table.restitution > 1).sum()):
        say(f"{above} of the measured COR are above 1; they are not cut, which would bias the fit")
    for sentence in findings(result):
        warn(sentence)
    say_written(out, [path.name for path in written])
    say_next(command("run", out / "case.toml", "-o", "RESULTS"))


def _fit_indents(measured: Path, out: Path, case: Path | None, free: list[str] | None) -> None:
    if free:
        raise CaseError(f"--free: {measured} has the hardness of indents; leave --free out")
    if case is not None:
        read_case(case)
    result = fit_size_effect(read_indents(measured))
    make_folder(out)
    written = write_size_effect(result, out, case)
    for label, name, unit in (("H0", "hardness", "Pa"), ("h*", "length", "m")):
        low, high = (quantity(end, unit) for end in result.interval(name))
        value = quantity(getattr(result, name), unit)
        say(f"{label} = {value}, 95 % interval {low} to {high}")
    rms = float((result.residuals**2).mean() ** 0.5)
    say(f"{counted(result.indents.depth.size, 'indent')}, rms residual of hardness {rms:.2g}")
    for sentence in result.findings():
        warn(sentence)
    say("In [interface] of a case: " + ", ".join(keys_of(result)))
    say_written(out, [path.name for path in written])
    if case is not None:
        say_next(command("run", out / "case.toml", "-o", "RESULTS"))


def _parameter(result: "Fit", k: int) -> str:
    parameter, uncertainty = result.parameters[k], result.uncertainty
    value = f"{parameter.key} = {parameter.text(result.factors[k])}"
    if not identifiable(result, k):
        return f"{value}, not identifiable"
    place = f"{100 * uncertainty.by_one_place[k]:.2g} %"
    lines = [
        f"{value}, 95 % interval {interval_in_words(result, k, model=True)} (data and model)",
        f"  of the data alone: {interval_in_words(result, k)}",
    ]
    if uncertainty.by_one_place[k] > 0:
        lines.append(f"  if all impacts hit one place: ± {place}, one standard deviation")
    return "\n".join(lines)
