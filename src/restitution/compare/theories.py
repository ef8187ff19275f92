"""COR of a case from closed forms, and from theories fitted to a computed law."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restitution.case.case import Case
from restitution.compare.closed_forms import FORMS, SOURCES, Bodies, speed, within
from restitution.display import quantity
from restitution.errors import CaseError
from restitution.laws.law import LOSS, Array, FittedLaw, Law
from restitution.results.writer import make_folder, write_table
from restitution.theory import Brilliantov

STEPS = 25
"""Number of velocities in a table, from the lowest to the highest velocity of a case."""
COMPUTED = "computed"
"""Name of the computed points in a list of theories."""

_FINE = 600  # number of velocities at which a line in a figure is computed
_SAME = 1e-6  # values of R*, E* or m* with at most this relative difference count as equal
_FITTED = ("constant", "walton-braun", "luding", "eepa")  # theories with fitted parameters


@dataclass(frozen=True)
class Theory:
    """COR of one theory at some velocities; NaN outside the range that `holds` describes.

    The keys of `parameters` end with the units.
    """

    name: str
    source: str
    holds: str
    parameters: Mapping[str, float]
    restitution: Array


def velocities_of(case: Case, law: Law | None = None) -> Array:
    """Velocities (m/s) of `law`, or from the first to the last depth of `case`.

    Indentations and loads are converted for smooth bodies (Thornton and Ning, or Hertz). Raises
    `CaseError`.
    """
    if law is not None:
        return law.column("velocity")
    bodies, depths = Bodies.of(case), case.depths()
    ends = np.array([depths[0], depths[-1]])
    if case.impact is None:
        ends = bodies.velocity(bodies.depth_under(ends) if case.load is not None else ends)
    return np.geomspace(ends[0], ends[1], STEPS) if ends[0] < ends[1] else ends[:1]


def theories(case: Case, velocities: Array, law: Law | None = None) -> list[Theory]:
    """Every theory that applies to `case`, and the fits to `law`, at `velocities` (m/s).

    The computed COR and the fits have values only at the velocities of the law, and fits only in
    `law.fitted_range`. Raises `CaseError` if a density is missing, or if the law is of another
    pair.
    """
    V = np.asarray(velocities, dtype=float)
    evaluated = [answer for answer in _answers(case, V) if isinstance(answer, Theory)]
    if law is not None:
        check_same_pair(case, law)
        evaluated += _of_law(Bodies.of(case), law, V)
    return evaluated


def theory_lines(
    case: Case, velocities: Array, evaluated: list[Theory]
) -> list[tuple[str, bool, Array, Array]]:
    """A line of a figure for each theory: name, whether it is a fit, velocities (m/s) and COR.

    Closed forms are evaluated at many velocities, fits at `velocities`; the computed COR gets no
    line.
    """
    V = velocities
    if velocities.size > 1:
        V = np.geomspace(velocities[0], velocities[-1], _FINE)
    closed = {theory.name: (V, theory.restitution) for theory in theories(case, V)}
    return [
        (
            theory.name,
            theory.name not in FORMS,
            *closed.get(theory.name, (velocities, theory.restitution)),
        )
        for theory in evaluated
        if theory.name != COMPUTED
    ]


def write_theories(velocities: Array, evaluated: list[Theory], out: Path) -> Path:
    """Write COR of each theory at `velocities` (m/s) as `theory.csv` into `out`, new or empty.

    Raises `OutputError`.
    """
    make_folder(out)
    rows = [
        {
            "velocity_m_per_s": float(V),
            **{theory.name: float(theory.restitution[k]) for theory in evaluated},
        }
        for k, V in enumerate(velocities)
    ]
    write_table(out / "theory.csv", rows)
    return out / "theory.csv"


def left_out(case: Case, law: Law | None = None) -> dict[str, str]:
    """Names of the theories that do not apply to `case`, with the reasons."""
    reasons = dict(
        answer for answer in _answers(case, np.ones(1)) if not isinstance(answer, Theory)
    )
    if law is not None and (why := _cannot_fit(law)):
        reasons |= dict.fromkeys((*_FITTED[0 if not law.laws else 1 :], "brilliantov"), why)
    return reasons


def marks(case: Case) -> dict[str, float]:
    """V_y and V_s (m/s) of the smooth bodies, without V_y if elastic and V_s without adhesion."""
    bodies = Bodies.of(case)
    velocities = {"V_y": bodies.yield_velocity, "V_s": bodies.sticking_velocity}
    return {name: value for name, value in velocities.items() if 0 < value < math.inf}


def check_same_pair(case: Case, law: Law) -> None:
    """Raise `CaseError` if `case` and `law` differ in R*, E* or m* by a fraction above 1e-6."""
    bodies = Bodies.of(case)
    quantities = {
        "R*": (law.radius, bodies.R, "m"),
        "E*": (law.contact_modulus, bodies.E, "Pa"),
        "m*": (law.mass, bodies.m, "kg"),
    }
    differing = [
        f"{name} is {of_law:.7g} {unit} ({of_case:.7g} {unit} in the case)"
        for name, (of_law, of_case, unit) in quantities.items()
        if not abs(of_law / of_case - 1) <= _SAME
    ]
    if differing:
        raise CaseError(
            f"the law of {law.pair} belongs to another pair: its {', its '.join(differing)}; "
            "give the case from which the law was computed, or another law"
        )


def _answers(case: Case, V: Array) -> Iterator[Theory | tuple[str, str]]:
    bodies = Bodies.of(case)
    for name, form in FORMS.items():
        answer = form(bodies, V)
        if isinstance(answer, str):
            yield name, answer
            continue
        holds, parameters = answer.holds, answer.parameters
        if answer.takes_strength:
            holds += f"; {bodies.convention}"
            parameters = {"yield_strength_Pa": bodies.strength, **parameters}
        if bodies.w > 0 and not answer.with_adhesion:
            holds += "; without the adhesion of this pair"
        yield Theory(name, SOURCES[name], holds, parameters, answer.restitution)


def _of_law(bodies: Bodies, law: Law, V: Array) -> Iterator[Theory]:
    own = law.column("velocity")
    equal = np.isclose(V[:, np.newaxis], own, rtol=1e-9, atol=0.0)
    at, here = equal.argmax(axis=1), np.asarray(equal.any(axis=1))

    def values(of_points: Array) -> Array:
        return within(here, of_points[at])

    def fitted(of_points: Array) -> Array:
        return values(within(law.fits_hold_at(own), of_points))

    own_interface = {
        "yield_pressure_Pa": law.yield_pressure,
        "work_of_adhesion_J_per_m2": law.work_of_adhesion,
    }
    yield Theory(
        COMPUTED,
        f"this program, {law.title or law.pair}",
        f"at its {own.size} velocities{_unresolved(law)}{_other_interface(bodies, law)}",
        {name: value for name, value in own_interface.items() if value},
        values(law.column("restitution")),
    )
    low, high = law.fitted_range or (math.nan, math.nan)
    span = f"fitted to the computed e from {low:.3g} to {speed(high)}, and empty outside"
    for fit in law.laws:
        if fit.name in _FITTED:
            yield Theory(
                fit.name,
                fit.source,
                f"{span}, {_judged(fit)}",
                fit.parameters,
                fitted(np.array(fit.restitution, dtype=float)),  # None becomes NaN
            )
    if not _cannot_fit(law):
        beta = _dissipation(law)
        e = Brilliantov(beta).restitution(own)
        miss = (e - law.column("restitution"))[law.column("resolved").astype(bool)]
        yield Theory(
            "brilliantov",
            SOURCES["brilliantov"],
            f"{span}, rms {np.sqrt(np.mean(miss**2)):.2g}, worst {np.abs(miss).max():.2g}; ends "
            "where the force returns to zero; for bodies that neither yield nor adhere, a << R*",
            {"dissipation_s_per_m_power_1_5": beta},
            fitted(e),
        )


def _unresolved(law: Law) -> str:
    count = sum(not point.resolved for point in law.points)
    return f", {count} of them not resolved by the grid" if count else ""


def _other_interface(bodies: Bodies, law: Law) -> str:
    differing = []
    p_y = math.inf if law.yield_pressure is None else law.yield_pressure
    if not math.isclose(p_y, bodies.p_y, rel_tol=_SAME):
        differing.append("elastic" if math.isinf(p_y) else f"p_y = {quantity(p_y, 'Pa')}")
    if not math.isclose(law.work_of_adhesion, bodies.w, rel_tol=_SAME):
        differing.append(f"w = {law.work_of_adhesion:.4g} J/m^2")
    return f"; computed for an interface that differs from the case: {', '.join(differing)}" * bool(
        differing
    )


def _judged(fit: FittedLaw) -> str:
    note = f"; {fit.note}" if fit.note else ""
    return f"rms {fit.rms:.2g}, worst {fit.worst:.2g}; ends: {fit.ends}{note}"


def _cannot_fit(law: Law) -> str:
    """The reason why nothing can be fitted to `law`; empty if fits are possible."""
    e = law.column("restitution", resolved=True)
    if not e.size:
        return "the grid resolves no velocity of the law, so there is nothing to fit"
    if e.min() > 1 - LOSS:
        return "e = 1 at every velocity of the law, so there is nothing to fit"
    return (
        "e = 0 at every velocity of the law, so there is nothing to fit" if e.max() < LOSS else ""
    )


def _dissipation(law: Law) -> float:
    from scipy.optimize import minimize_scalar

    V, e = (law.column(name, resolved=True) for name in ("velocity", "restitution"))

    def misfit(log_beta: float) -> float:
        return float(np.sum((Brilliantov(math.exp(log_beta)).restitution(V) - e) ** 2))

    # Range of ln β in the search. At every velocity, e is nearly 1 at its lower end and nearly 0 at
    # its upper end.
    first, last = math.log(1e-6 / law.highest**0.2), math.log(1e6 / law.lowest**0.2)
    steps = np.linspace(first, last, 200)
    best = int(np.argmin([misfit(step) for step in steps]))
    near = steps[max(best - 1, 0)], steps[min(best + 1, steps.size - 1)]
    return math.exp(minimize_scalar(misfit, bounds=near, options={"xatol": 1e-10}).x)
