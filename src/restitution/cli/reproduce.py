"""`restitution reproduce`: the figures of the paper the program grew from."""

from pathlib import Path
from typing import Annotated

import typer


def reproduce(
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Folder for studies and report.", readable=False)
    ],
    quick: Annotated[bool, typer.Option("--quick", help="Smaller: about three minutes.")] = False,
    refined: Annotated[
        bool, typer.Option("--refined", help="Rough contacts on a grid twice as fine.")
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Processes on this machine.", show_default="all cores"),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Finish what is missing.")] = False,
) -> None:
    """Compute Figures 5 to 14 of Ghanbarzadeh et al. (2019) and judge its claims."""
    from rich.table import Table

    from restitution.cli.console import answers, say
    from restitution.cli.many import many_cases
    from restitution.errors import CaseError
    from restitution.reproduce.report import write_reproduction
    from restitution.reproduce.studies import NAMES, Size, bundled
    from restitution.results.writer import make_folder
    from restitution.sweeps.executors import local_workers
    from restitution.sweeps.scheduler import Tally, run_study
    from restitution.sweeps.study_folder import StudyFolder

    if quick and refined:
        raise CaseError("--quick and --refined: are two sizes; give one")
    size: Size = "quick" if quick else "refined" if refined else "paper"
    if not resume:
        make_folder(out, "go on with --resume")
    again = f"restitution reproduce -o {out}{' --' + size if size != 'paper' else ''} --resume"
    studies = {name: bundled(name, size) for name in NAMES}
    total = sum(len(study.cases) for study in studies.values())
    done = 0
    with many_cases(total, out, again) as bar, local_workers(workers) as there:
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
    table = Table(box=None, header_style="bold")
    for column in ("figure", "claim", "verdict"):
        table.add_column(column, overflow="fold")
    for finding in findings:
        table.add_row(finding.figure, finding.claim, finding.verdict)
    answers.print(table)
    say(f"Written: {page}")
