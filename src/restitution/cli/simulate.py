"""`restitution simulate`: collisions integrated in time with the stored force curves."""

import math
from pathlib import Path

from restitution.case.quantities import read_impact_angle, read_quantity
from restitution.cli.console import answers, print_numbers, say, say_written, table_of_numbers
from restitution.display import counted
from restitution.errors import CaseError, DomainError
from restitution.impacts import oblique
from restitution.impacts.stored_force import stored_force
from restitution.impacts.time_integration import collide_in_time, course
from restitution.laws.from_results import bare_law
from restitution.laws.law import velocity_of
from restitution.results.reader import RunResults, read_run
from restitution.results.writer import require_new_file, write_table


def simulate(
    results: Path,
    *,
    velocity: list[str] | None,
    friction: float | None,
    angle: list[str] | None,
    spin: list[str] | None,
    out: Path | None,
) -> None:
    require_new_file(out)
    law, run = bare_law(results), read_run(results)
    impact = run.case.impact
    if angle or spin or friction is not None or (impact is not None and impact.oblique):
        _oblique(run, velocity or [], angle or [], spin or [], friction, out)
        return
    force = stored_force(results)
    given = [velocity_of(text) for text in velocity or []]
    velocities = given or [
        point.velocity
        for point in law.points
        if (abs(force.unloading_from / point.indentation - 1) < 1e-6).any()
    ]
    table = table_of_numbers(
        "V (m/s)",
        "COR",
        "error",
        "product" if force.losses.present else "by energies",
        "time (s)",
        "force (N)",
        "depth (nm)",
    )
    courses, blended = [], False
    shallow: list[DomainError] = []
    for speed in velocities:
        try:
            collision, energies = collide_in_time(force, speed), law.at(speed)
        except DomainError as above:
            # With losses, an impact reverses above the depth that the stored energies give.
            if given or not force.losses.present:
                raise
            shallow.append(above)
            continue
        # Errors of the force curves change the simulated COR, but not the COR from the stored
        # energies. The difference between these two COR estimates the effect of such errors. The
        # printed error is at least the error of the COR from the stored energies.
        error = max(abs(collision.restitution - energies.restitution), energies.error)
        courses += course(collision)
        table.add_row(
            f"{speed:.4g}",
            f"{collision.restitution:.5f}",
            f"± {error:.5f}",
            f"{energies.restitution:.5f}",
            f"{collision.duration:.4g}",
            f"{collision.largest_force:.4g}",
            f"{1e9 * collision.largest_indentation:.4g}",
        )
        blended |= collision.blended
    if len(shallow) == len(velocities):
        raise shallow[0]
    if out is not None:
        write_table(out, courses)
    print_numbers(table)
    if shallow:
        answers.print(
            f"Left out: {counted(len(shallow), 'impact')} at which the losses keep the impact "
            "above all stored unloading curves; give more unloading.curves."
        )
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
    force = oblique.oblique_force(run, "--angle")
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
        for slope in at:
            collision = oblique.collide_obliquely(force, speed, slope, friction, (first, second))
            courses += oblique.course(collision)
            e_t, bar = collision.tangential_restitution, collision.tangential_restitution_error
            table.add_row(
                f"{collision.velocity:.4g}",
                f"{math.degrees(slope):.4g}",
                f"{collision.normal_restitution:.4f}",
                f"{e_t:.3f} ± {bar:.3f}",
                f"{math.degrees(collision.rebound_angle):.2f}",
                ", ".join(f"{spin:.5g}" for spin in collision.spins),
                f"{collision.friction_loss:.4g}",
                "full" if collision.sliding else "part",
            )
    print_numbers(table)
    say(
        "loss: energy lost to friction. ±: error due to the tangential law alone, without the "
        "errors of the normal forces and of the grid."
    )
    if out is not None:
        write_table(out, courses)
        say_written(out)
