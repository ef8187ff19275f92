"""`restitution study`: all cases of a sweep."""

from pathlib import Path
from typing import Annotated

import typer

from restitution.cli.running import OutFolder


def study(
    file: Annotated[
        Path,
        typer.Argument(
            help="Study file (TOML): a case and a table \\[sweep].",
            metavar="STUDY",
            show_default=False,
            readable=False,
        ),
    ],
    out: OutFolder,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Processes on this machine.", show_default="all cores"),
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler, tcp://…, to compute on.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Finish what is missing in OUT.")
    ] = False,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="With --resume: failed cases again, too.")
    ] = False,
) -> None:
    """Run every case of STUDY and write a table of all of them to OUT."""

    from restitution.case.case_file import parse_case
    from restitution.cli.console import say, warn
    from restitution.cli.many import many_cases
    from restitution.errors import CaseError
    from restitution.sweeps.executors import cluster_workers, local_workers
    from restitution.sweeps.scheduler import Tally, run_study
    from restitution.sweeps.study_folder import StudyFolder
    from restitution.sweeps.sweep import read_study

    if scheduler is not None and workers is not None:
        raise CaseError("workers: belongs to this machine, and --scheduler to another; give one")
    read = read_study(file)
    folder = StudyFolder(out, read, resume=resume)
    again = f"restitution study {file} -o {out} --resume"
    first = parse_case(read.cases[0].text)
    depths = len(first.depths()) * first.realisations
    where = cluster_workers(scheduler) if scheduler else local_workers(workers)
    with many_cases(len(read.cases), out, again) as bar, folder.locked(), where as there:
        task = bar.add_task("cases", total=len(read.cases))

        def show(tally: Tally) -> None:
            within = sum(min(d / depths, 1.0) for d in tally.in_flight.values())
            words = ", ".join(
                f"case {number}: {done} of {depths}"
                for number, done in list(tally.in_flight.items())[:3]
            )
            bar.update(task, completed=round(tally.done + within, 2), description=words or "cases")

        tally = run_study(
            read, file.parent.resolve(), folder, there, show, retry_failed=retry_failed
        )
    if tally.failed:
        warn(
            f"{tally.failed} of {tally.cases} cases failed; their reasons are in the column reason "
            "of table.csv"
        )
    say(f"{tally.done} of {tally.cases} cases. In {out}: cases, study.nc, study.toml, table.csv")
    if tally.failed == tally.cases:
        raise typer.Exit(1)
