"""`restitution simulate`: collisions integrated in time with the stored force curves."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from restitution.laws.time_integration import StoredForce


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
    friction: Annotated[
        float | None,
        typer.Option(min=0.0, metavar="MU", help="Coefficient of friction, for oblique impacts."),
    ] = None,
    angle: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ANGLE",
            help='Angle of impact from the normal, such as "30 deg"; may be repeated.',
            show_default="head-on",
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
    """Integrate collisions in time with the stored forces of RESULTS; compare COR with energies.

    With --friction and --angle the impacts are oblique: VELOCITY is that of the centres, and the
    table has the tangential restitution, the angle of rebound and the spin.
    """
    from restitution.cli.console import answers, say_written, table_of_numbers
    from restitution.laws.from_results import bare_law
    from restitution.laws.law import velocity_of
    from restitution.laws.time_integration import collide_in_time, course, stored_force
    from restitution.results.writer import require_new_file, write_table

    require_new_file(out)
    law, force = bare_law(results), stored_force(results)
    if angle or friction is not None:
        _oblique(force, law.work_of_adhesion, velocity or [], angle or [], friction, out)
        return
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


def _oblique(
    force: "StoredForce",
    work_of_adhesion: float,
    velocities: list[str],
    angles: list[str],
    friction: float | None,
    out: Path | None,
) -> None:
    """Oblique impacts at every velocity and angle, as a table."""
    from restitution.case.quantities import read_quantity
    from restitution.cli.console import answers, say, say_written, table_of_numbers
    from restitution.errors import CaseError
    from restitution.laws.law import velocity_of
    from restitution.laws.oblique import collide_obliquely, course
    from restitution.results.writer import write_table

    if friction is None:
        raise CaseError("--friction: is missing; an oblique impact needs a coefficient of friction")
    if not angles or not velocities:
        raise CaseError("--angle, --velocity: an oblique impact needs both; give them")
    if work_of_adhesion > 0:
        raise CaseError("--angle: oblique impacts are computed for pairs without adhesion only")
    try:
        wanted = [read_quantity(text, "rad") for text in angles]
    except ValueError as error:
        raise CaseError(f"--angle: {error}") from None
    table = table_of_numbers(
        "V (m/s)",
        "angle (°)",
        "e_n",
        "e_t",
        "rebound (°)",
        "spins (rad/s)",
        "loss (J)",
        "",
    )
    courses = []
    for text in velocities:
        for each in wanted:
            found = collide_obliquely(force, velocity_of(text), each, friction)
            courses += course(found)
            table.add_row(
                f"{found.velocity:.4g}",
                f"{math.degrees(each):.4g}",
                f"{found.normal_restitution:.4f}",
                f"{found.tangential_restitution:.3f} ± {found.tangential_restitution_error:.3f}",
                f"{math.degrees(found.rebound_angle):.2f}",
                ", ".join(f"{spin:.4g}" for spin in found.spins),
                f"{found.friction_loss:.4g}",
                "slides" if found.sliding else "sticks in part",
            )
    answers.print(table)
    say(
        "loss: energy lost to friction. ±: error of the tangential law, without the errors of the "
        "normal forces and of the grid."
    )
    if out is not None:
        write_table(out, courses)
        say_written(out)
