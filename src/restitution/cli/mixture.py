"""`restitution mixture`: the laws of every pair of several materials and sizes."""

from pathlib import Path
from typing import Annotated

import typer

from restitution.cli.running import FigureFormat, Figures, OutFolder


def mixture(
    file: Annotated[
        Path,
        typer.Argument(
            help="Mixture file (TOML): materials, sizes, walls and velocities.",
            metavar="MIXTURE",
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
    figures: Figures = FigureFormat.png,
) -> None:
    """Compute the restitution law of every pair in MIXTURE and write all of them to OUT."""
    import time

    from restitution.cli.console import say, warn
    from restitution.cli.many import many_cases
    from restitution.errors import CaseError
    from restitution.mixtures.mixture import run_mixture
    from restitution.mixtures.mixture_file import read_mixture
    from restitution.mixtures.mixture_folder import open_mixture_folder, write_mixture
    from restitution.plots.mixture import mixture_figure
    from restitution.plots.static import write_figure
    from restitution.sweeps.executors import cluster_workers, local_workers
    from restitution.sweeps.scheduler import Tally

    if scheduler is not None and workers is not None:
        raise CaseError("workers: belongs to this machine, and --scheduler to another; give one")
    read = read_mixture(file)
    folder = open_mixture_folder(out, read, resume=resume)
    again = f"restitution mixture {file} -o {out} --resume"
    began = time.perf_counter()
    where = cluster_workers(scheduler) if scheduler else local_workers(workers)
    with many_cases(None, out, again) as bar, folder.locked(), where as there:
        task = bar.add_task("curves", total=None)

        def show(tally: Tally) -> None:
            bar.update(task, total=tally.cases, completed=tally.done)

        pairs = run_mixture(read, file.parent.resolve(), folder, there, show)
        runs = len(folder.study.cases)
        names = write_mixture(out, read, pairs, runs, time.perf_counter() - began)
    picture = mixture_figure(read.title, [pair.law for pair in pairs])
    names.append(write_figure(out / "restitution", picture, figures.value).name)
    unresolved = sum(any(not point.resolved for point in pair.law.points) for pair in pairs)
    if unresolved:
        warn(f"{unresolved} of {len(pairs)} laws have velocities that the grid does not resolve")
    worst = max(pair.interpolation_error for pair in pairs)
    say(
        f"{len(pairs)} pairs from {runs} computed curves; interpolation between sizes adds at most "
        f"{worst:.2g} to the error of COR"
    )
    say(f"In {out}: {', '.join(sorted(names))}")
    speed = (read.velocities[0] * read.velocities[-1]) ** 0.5
    say(f'Next: restitution export {out} --to lammps --velocity "{speed:.2g} m/s" -o INPUT')
