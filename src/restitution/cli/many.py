"""`restitution study`, `mixture` and `reproduce`: many cases at once."""

import time
from pathlib import Path

import typer
from rich.table import Column, Table

from restitution.case.case_file import parse_case
from restitution.cli.console import (
    answers,
    cases_progress,
    command,
    say,
    say_next,
    say_written,
    warn,
)
from restitution.cli.parameters import FigureFormat
from restitution.errors import CaseError
from restitution.mixtures.mixture import (
    condensed_warnings,
    open_mixture_folder,
    run_mixture,
    write_mixture,
)
from restitution.mixtures.mixture_file import read_mixture
from restitution.plots.law import mixture_figure
from restitution.plots.static import write_figure
from restitution.reproduce.report import write_reproduction
from restitution.reproduce.studies import NAMES, Size, bundled
from restitution.results.writer import make_folder
from restitution.sweeps import executors
from restitution.sweeps.scheduler import Tally, run_study
from restitution.sweeps.study_folder import StudyFolder
from restitution.sweeps.sweep import read_study


def study(
    study: Path,
    out: Path,
    *,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    retry_failed: bool,
) -> None:
    where = executors.chosen_workers(workers, scheduler)
    read = read_study(study)
    folder = StudyFolder(out, read, resume=resume)
    again = command("study", study, "-o", out, "--resume")
    first = parse_case(read.cases[0].text)
    depths = len(first.depths()) * first.realisations
    with cases_progress(len(read.cases), out, again) as bar, folder.locked(), where as there:
        task = bar.add_task("cases", total=len(read.cases))

        def show(tally: Tally) -> None:
            within = sum(min(d / depths, 1.0) for d in tally.in_flight.values())
            words = ", ".join(
                f"case {number}: {done} of {depths}"
                for number, done in list(tally.in_flight.items())[:3]
            )
            bar.update(task, completed=round(tally.done + within, 2), description=words or "cases")

        tally = run_study(
            read, study.parent.resolve(), folder, there, show, retry_failed=retry_failed
        )
    if tally.failed:
        warn(f'{tally.failed} of {tally.cases} cases failed; see the column "reason" of table.csv')
    say(f"{tally.done} of {tally.cases} cases complete")
    say_written(out, ["cases", "study.nc", "study.toml", "table.csv"])
    if tally.failed == tally.cases:
        raise typer.Exit(1)
    say_next(command("report", out))


def mixture(
    mixture: Path,
    out: Path,
    *,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    figures: FigureFormat,
) -> None:
    where = executors.chosen_workers(workers, scheduler)
    read = read_mixture(mixture)
    folder = open_mixture_folder(out, read, resume=resume)
    again = command("mixture", mixture, "-o", out, "--resume")
    began = time.perf_counter()
    with cases_progress(None, out, again) as bar, folder.locked(), where as there:
        task = bar.add_task("curves", total=None)

        def show(tally: Tally) -> None:
            bar.update(task, total=tally.cases, completed=tally.done)

        pairs = run_mixture(read, mixture.parent.resolve(), folder, there, show)
        runs = len(folder.study.cases)
        names = write_mixture(out, read, pairs, runs, time.perf_counter() - began)
    picture = mixture_figure(read.title, [pair.law for pair in pairs])
    names.append(write_figure(out / "restitution", picture, figures.value).name)
    for warning in condensed_warnings(pairs):
        warn(warning)
    if unresolved := sum(not all(point.resolved for point in pair.law.points) for pair in pairs):
        warn(
            f"{unresolved} of {len(pairs)} laws contain velocities at which the grid does not "
            "resolve the contact"
        )
    worst = max(pair.interpolation_error for pair in pairs)
    say(
        f"{len(pairs)} pairs from {runs} computed curves; interpolation between sizes adds at most "
        f"{worst:.2g} to the error of COR"
    )
    say_written(out, sorted(names))
    speed = f"{(read.velocities[0] * read.velocities[-1]) ** 0.5:.2g} m/s"
    say_next(command("export", out, "--to", "lammps", "--velocity", speed, "-o", "INPUT"))


def reproduce(out: Path, *, quick: bool, refined: bool, workers: int | None, resume: bool) -> None:
    if quick and refined:
        raise CaseError("--quick, --refined: give only one of them")
    size: Size = "quick" if quick else "refined" if refined else "paper"
    if not resume:
        make_folder(out, "continue with --resume")
    option = [] if size == "paper" else [f"--{size}"]
    again = command("reproduce", "-o", out, *option, "--resume")
    studies = {name: bundled(name, size) for name in NAMES}
    total = sum(len(study.cases) for study in studies.values())
    done = 0
    with cases_progress(total, out, again) as bar, executors.local_workers(workers) as there:
        task = bar.add_task("starting", total=total)
        for name, study in studies.items():

            def show(tally: Tally, name: str = name, before: int = done) -> None:
                bar.update(task, completed=before + tally.done, description=name)

            begun = (out / name / "study.toml").is_file()
            folder = StudyFolder(out / name, study, resume=begun)
            with folder.locked():
                run_study(study, Path(), folder, there, show)
            done += len(study.cases)
    page, findings = write_reproduction(out, size)
    heads = (Column(name, overflow="fold") for name in ("figure", "claim", "verdict"))
    table = Table(*heads, box=None, header_style="bold")
    for finding in findings:
        table.add_row(finding.figure, finding.claim, finding.verdict)
    answers.print(table)
    say_written(page)
