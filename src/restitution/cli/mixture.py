"""`restitution mixture`: restitution laws of all pairs of particles in a mixture."""

from pathlib import Path
from typing import Annotated

import typer

from restitution.cli.parameters import FigureFormat, Figures, OutFolder, Resume, Scheduler, Workers


def mixture(
    mixture: Annotated[
        Path,
        typer.Argument(
            help="Mixture file (TOML): materials, sizes, walls and velocities.",
            metavar="MIXTURE",
            show_default=False,
            readable=False,
        ),
    ],
    out: OutFolder,
    workers: Workers = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    figures: Figures = FigureFormat.png,
) -> None:
    """Compute the restitution laws of all pairs in MIXTURE, and write them to OUT."""
    import time

    from restitution.cli.console import command, say, say_next, say_written, warn
    from restitution.cli.progress import cases_progress
    from restitution.mixtures.mixture import (
        condensed_warnings,
        open_mixture_folder,
        run_mixture,
        write_mixture,
    )
    from restitution.mixtures.mixture_file import read_mixture
    from restitution.plots.mixture import mixture_figure
    from restitution.plots.static import write_figure
    from restitution.sweeps.executors import chosen_workers
    from restitution.sweeps.scheduler import Tally

    where = chosen_workers(workers, scheduler)
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
