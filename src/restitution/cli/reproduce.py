"""`restitution reproduce`: the figures and claims of the paper of Ghanbarzadeh et al. (2019)."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Column, Table

from restitution.cli.parameters import OutFolder, Resume, Workers


def reproduce(
    out: OutFolder,
    quick: Annotated[
        bool,
        typer.Option(
            "--quick", help="Use smaller grids and fewer cases, which takes about three minutes."
        ),
    ] = False,
    refined: Annotated[
        bool, typer.Option("--refined", help="Halve the grid spacing of rough contacts.")
    ] = False,
    workers: Workers = None,
    resume: Resume = False,
) -> None:
    """Compute Figures 5 to 14 of Ghanbarzadeh et al. (2019) and check the claims of the paper."""
    from restitution.cli.console import answers, command, say_written
    from restitution.cli.progress import cases_progress
    from restitution.errors import CaseError
    from restitution.reproduce.report import write_reproduction
    from restitution.reproduce.studies import NAMES, Size, bundled
    from restitution.results.writer import make_folder
    from restitution.sweeps.executors import local_workers
    from restitution.sweeps.scheduler import Tally, run_study
    from restitution.sweeps.study_folder import StudyFolder

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
    with cases_progress(total, out, again) as bar, local_workers(workers) as there:
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
