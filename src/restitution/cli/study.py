"""`restitution study`: all cases of a sweep."""

from pathlib import Path
from typing import Annotated

import typer

from restitution.cli.parameters import OutFolder, Resume, Scheduler, Workers


def study(
    study: Annotated[
        Path,
        typer.Argument(
            help="Study file (TOML): a case and a table \\[sweep].",
            metavar="STUDY",
            show_default=False,
            readable=False,
        ),
    ],
    out: OutFolder,
    workers: Workers = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="With --resume: compute failed cases again, too.")
    ] = False,
) -> None:
    """Run all cases of STUDY; write the results of each case and a table of all to OUT."""
    from restitution.case.case_file import parse_case
    from restitution.cli.console import command, say, say_next, say_written, warn
    from restitution.cli.progress import cases_progress
    from restitution.sweeps.executors import chosen_workers
    from restitution.sweeps.scheduler import Tally, run_study
    from restitution.sweeps.study_folder import StudyFolder
    from restitution.sweeps.sweep import read_study

    where = chosen_workers(workers, scheduler)
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
