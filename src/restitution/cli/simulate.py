"""`restitution simulate`: collisions integrated in time with the stored force curves."""

from pathlib import Path
from typing import Annotated

import typer


def simulate(
    results: Annotated[
        Path,
        typer.Argument(
            metavar="RESULTS", help="Results folder of a run.", show_default=False, readable=False
        ),
    ],
    velocity: Annotated[
        list[str] | None,
        typer.Option(
            metavar="VELOCITY",
            help='Impact velocity, such as "0.5 m/s"; may be repeated.',
            show_default="those of the unloading curves",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            metavar="FILE",
            help="New CSV file for indentation, velocity and force over time.",
            readable=False,
        ),
    ] = None,
) -> None:
    """Integrate collisions in time with the stored forces of RESULTS; compare COR with energies."""
    from restitution.cli.console import answers, say_written, table_of_numbers
    from restitution.laws.from_results import bare_law
    from restitution.laws.law import velocity_of
    from restitution.laws.time_integration import collide_in_time, course, stored_force
    from restitution.results.writer import require_new_file, write_table

    require_new_file(out)
    law, force = bare_law(results), stored_force(results)
    velocities = [velocity_of(text) for text in velocity or []]
    unloaded = force.unloading_from
    velocities = velocities or [
        point.velocity
        for point in law.points
        if (abs(unloaded / point.indentation - 1) < 1e-6).any()
    ]
    table = table_of_numbers(
        "V (m/s)",
        "COR",
        "error",
        "by energies",
        "difference",
        "time (s)",
        "force (N)",
        "depth (nm)",
    )
    courses, blended = [], False
    for each in velocities:
        found, energies = collide_in_time(force, each), law.at(each)
        # The force curves are as accurate as their work agrees with the stored energies.
        error = max(abs(found.restitution - energies.restitution), energies.error)
        courses += course(found)
        table.add_row(
            f"{each:.4g}",
            f"{found.restitution:.5f}",
            f"± {error:.5f}",
            f"{energies.restitution:.5f}",
            f"{found.restitution - energies.restitution:+.5f}",
            f"{found.duration:.4g}",
            f"{found.largest_force:.4g}",
            f"{1e9 * found.largest_indentation:.4g}",
        )
        blended |= found.blended
    if out is not None:
        write_table(out, courses)
    answers.print(table)
    if blended:
        answers.print(
            "Some collisions reverse between two stored unloading curves; forces are interpolated. "
            "More curves (unloading.curves) bring COR in time closer to COR by energies."
        )
    if out is not None:
        say_written(out)
