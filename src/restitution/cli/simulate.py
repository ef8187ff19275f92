"""`restitution simulate`: collisions integrated in time with the stored force curves."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from restitution.results.reader import RunResults


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
            show_default="the velocities of the unloading curves",
        ),
    ] = None,
    friction: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            metavar="MU",
            help="Coefficient of friction, for oblique impacts.",
            show_default="the coefficient in the case",
        ),
    ] = None,
    angle: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ANGLE",
            help='Angle of impact from the normal, such as "30 deg"; may be repeated.',
            show_default="the angles in the case, or head-on",
        ),
    ] = None,
    spin: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SPIN",
            help='Spin of the first body before the impact, such as "100 rad/s"; a second --spin '
            "is for the second body.",
            show_default="the spins in the case, or none",
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
    """Integrate collisions in time with the stored forces of RESULTS; compare with stored COR.

    The impacts are oblique if an option gives an angle, a spin or a coefficient of friction, or if
    the case gives an angle or a spin. VELOCITY is then the relative velocity of the centres, and
    the table contains the tangential restitution, the angle of rebound and the spins.
    """
    from restitution.cli.console import answers, print_numbers, say_written, table_of_numbers
    from restitution.impacts.time_integration import collide_in_time, course, stored_force
    from restitution.laws.from_results import bare_law
    from restitution.laws.law import velocity_of
    from restitution.results.reader import read_run
    from restitution.results.writer import require_new_file, write_table

    require_new_file(out)
    law, run = bare_law(results), read_run(results)
    impact = run.case.impact
    if angle or spin or friction is not None or (impact is not None and impact.oblique):
        _oblique(run, velocity or [], angle or [], spin or [], friction, out)
        return
    force = stored_force(results)
    velocities = [velocity_of(text) for text in velocity or []] or [
        point.velocity
        for point in law.points
        if (abs(force.unloading_from / point.indentation - 1) < 1e-6).any()
    ]
    table = table_of_numbers(
        "V (m/s)", "COR", "error", "by energies", "time (s)", "force (N)", "depth (nm)"
    )
    courses, blended = [], False
    for each in velocities:
        found, energies = collide_in_time(force, each), law.at(each)
        # Errors of the force curves change the simulated COR, but not the COR from the stored
        # energies. The difference between these two COR estimates the effect of such errors. The
        # printed error is at least the error of the COR from the stored energies.
        error = max(abs(found.restitution - energies.restitution), energies.error)
        courses += course(found)
        table.add_row(
            f"{each:.4g}",
            f"{found.restitution:.5f}",
            f"± {error:.5f}",
            f"{energies.restitution:.5f}",
            f"{found.duration:.4g}",
            f"{found.largest_force:.4g}",
            f"{1e9 * found.largest_indentation:.4g}",
        )
        blended |= found.blended
    if out is not None:
        write_table(out, courses)
    print_numbers(table)
    if blended:
        answers.print(
            "Some collisions reverse at a depth between two stored unloading curves, so their "
            "forces are interpolated. More curves (unloading.curves) reduce the difference."
        )
    if out is not None:
        say_written(out)


def _oblique(
    run: "RunResults",
    velocities: list[str],
    angles: list[str],
    spins: list[str],
    friction: float | None,
    out: Path | None,
) -> None:
    """Compute oblique impacts at every velocity and angle, and print them as a table."""
    from restitution.case.quantities import read_impact_angle, read_quantity
    from restitution.cli.console import print_numbers, say, say_written, table_of_numbers
    from restitution.errors import CaseError
    from restitution.impacts.oblique import collide_obliquely, course, oblique_force
    from restitution.laws.law import velocity_of
    from restitution.results.writer import write_table

    impact = run.case.impact
    if friction is None:
        friction = run.case.interface.friction
    if friction is None:
        raise CaseError("--friction: not given; an oblique impact needs a coefficient of friction")
    try:
        at = [read_impact_angle(text) for text in angles]
    except ValueError as error:
        raise CaseError(f"--angle: {error}") from None
    try:
        turning = [read_quantity(text, "rad/s") for text in spins]
    except ValueError as error:
        raise CaseError(f"--spin: {error}") from None
    if len(turning) > 2:
        raise CaseError(f"--spin: {len(turning)} values for two bodies; give one or two")
    fast = [velocity_of(text) for text in velocities]
    if impact is not None and impact.oblique:
        at, fast = at or impact.angles(), fast or impact.velocities()
        turning = turning or list(impact.spins())
    at = at or ([0.0] if turning else [])
    if not at or not fast:
        raise CaseError(
            "--angle, --velocity: an oblique impact needs an angle and a velocity; give both"
        )
    first, second = [*turning, 0.0, 0.0][:2]
    force = oblique_force(run, "--angle")
    table = table_of_numbers(
        "V\n(m/s)",
        "angle\n(°)",
        "e_n",
        "e_t",
        "rebound\n(°)",
        "spins\n(rad/s)",
        "loss\n(J)",
        "slip",
    )
    courses = []
    for speed in fast:
        for each in at:
            found = collide_obliquely(force, speed, each, friction, (first, second))
            courses += course(found)
            table.add_row(
                f"{found.velocity:.4g}",
                f"{math.degrees(each):.4g}",
                f"{found.normal_restitution:.4f}",
                f"{found.tangential_restitution:.3f} ± {found.tangential_restitution_error:.3f}",
                f"{math.degrees(found.rebound_angle):.2f}",
                ", ".join(f"{spin:.5g}" for spin in found.spins),
                f"{found.friction_loss:.4g}",
                "full" if found.sliding else "part",
            )
    print_numbers(table)
    say(
        "loss: energy lost to friction. ±: error due to the tangential law alone, without the "
        "errors of the normal forces and of the grid."
    )
    if out is not None:
        write_table(out, courses)
        say_written(out)
