"""`restitution simulate`: two particles run through the stored force law, in time."""

from pathlib import Path
from typing import Annotated

import typer


def simulate(
    results: Annotated[
        Path,
        typer.Argument(
            metavar="OUT", help="Results folder of a run.", show_default=False, readable=False
        ),
    ],
    velocity: Annotated[
        list[str] | None,
        typer.Option(
            help='Impact velocity, such as "0.5 m/s"; may be repeated.',
            show_default="those of the unloading curves",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="CSV file for the courses in time; new.", readable=False),
    ] = None,
) -> None:
    """Integrate collisions through the forces in OUT and compare with the energies' COR."""
    from restitution.cli.console import answers, say, table_of_numbers
    from restitution.laws.from_results import bare_law
    from restitution.laws.law import velocity_of
    from restitution.laws.time_integration import collide_in_time, course, stored_force
    from restitution.results.writer import require_new_file, write_table

    require_new_file(out)
    law, force = bare_law(results), stored_force(results)
    asked = [velocity_of(text) for text in velocity or []]
    unloaded = force.unloading_from
    asked = asked or [
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
    for each in asked:
        found, energies = collide_in_time(force, each), law.at(each)
        # The stored curves are as exact as their work is that of the energies.
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
            "Some turn between two unloading curves, which are blended; with more of them "
            "(unloading.curves) COR in time comes nearer to that by energies."
        )
    if out is not None:
        say(f"Written: {out}")
