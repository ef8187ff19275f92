"""Force laws of DEM codes, fitted to a computed law.

Only points that the grid resolves are fitted. Laws are fitted to COR by least squares, except
`thornton-ning-force` (to the maximum forces); `luding` and `eepa` also to the pull-off forces. COR
does not determine the loading stiffness of springs: the model and the computation get the same
geometric mean of the maximum forces, so durations and depths agree on average.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from restitution.dem.fitting import (
    Parameters,
    fit_restitution,
    judged,
    least_squares_from,
    resolved,
    stiffness,
)
from restitution.laws.compact_fit import FEWEST, compact_fit
from restitution.laws.from_results import bare_law
from restitution.laws.law import LOSS, Array, FittedLaw, Law
from restitution.results.reader import RunResults
from restitution.theory import EEPA, JKR, MDR, Luding, ThorntonNing, WaltonBraun

NAMES = (
    "constant",
    "thornton-ning-force",
    "thornton-ning",
    "walton-braun",
    "luding",
    "eepa",
    "lammps-mdr",
)
"""The force laws, in the order in which they are fitted."""
Begin = Callable[[str, int, int], None]
"""Called before each fit: name of the force law, number of the fit (from 1), number of fits."""

# COR of mdr jumps at the velocity of first yield. In LAMMPS this velocity differs slightly from
# that of `theory.MDR`. Each point is therefore compared with COR of mdr at three velocities: that
# of the point, and those smaller and larger by this fraction.
_JUMP = 0.02
# In the fits of adhesive models, a relative difference of the pull-off force counts as much as this
# multiple of it in e: 10 % of the force as 0.01 of e.
_PULL_OFF = 0.1
_ZERO = 1e-9  # adhesive parameters below this share of their scale are 0
_AT_FORCE_ZERO = "separation, where the force is back to zero"


def fit_law(out: Path | RunResults, begin: Begin | None = None) -> Law:
    """The law of the results in the folder `out`, with its fits. Raises as `bare_law`."""
    return with_fits(bare_law(out), begin)


def with_fits(law: Law, begin: Begin | None = None) -> Law:
    return replace(law, fit=compact_fit(law), laws=fitted_laws(law, begin))


def fitted_laws(law: Law, begin: Begin | None = None) -> tuple[FittedLaw, ...]:
    """Fit all applicable force laws; none without resolved points, or if all have e = 1."""
    if resolved(law, "restitution").min(initial=1.0) > 1 - LOSS:
        return ()
    fits, fitted = _all(law), []
    for number, name in enumerate(NAMES, 1):
        if begin is not None:
            begin(name, number, len(NAMES))
        if (fit := next(fits, None)) is None:
            break
        fitted.append(fit)
    return tuple(fitted)


def too_few_points(law: Law) -> str:
    """A warning if force laws are fitted to fewer points than a compact fit needs; else ""."""
    count = resolved(law, "velocity").size
    if not law.laws or count >= FEWEST:
        return ""
    return (
        f"the force laws are fitted to {count} resolved velocities, "
        f"but a reliable fit needs {FEWEST} or more; give more velocities, or resolve more of them "
        'with grid.refine = "auto" or a smaller grid.spacing, and run the case again'
    )


def _all(law: Law) -> Iterator[FittedLaw]:
    yield _constant(law)
    if resolved(law, "restitution").max() < LOSS or resolved(law, "force").max() <= 0:
        return  # the other laws can fit neither a sticking pair nor purely tensile forces
    yield from _thornton_ning(law)
    yield _walton_braun(law)
    yield _luding(law)
    yield _eepa(law)
    if (mdr := _mdr(law)) is not None:
        yield mdr


def _constant(law: Law) -> FittedLaw:
    mean = float(resolved(law, "restitution").mean())
    return judged(
        law,
        "constant",
        lambda V: np.full_like(V, mean),
        {"restitution": mean},
        source="one coefficient of restitution for all velocities, as in most contact models",
        ends="as defined by the DEM code",
    )


def _thornton_ning(law: Law) -> Iterator[FittedLaw]:
    """Fit the yield pressure p_y in two ways: to the maximum forces, and to COR."""
    smooth = law.radius, law.contact_modulus
    V, force = resolved(law, "velocity"), resolved(law, "force")

    def forces(x: Array) -> Array:
        bodies = ThorntonNing(*smooth, math.exp(x[0]))
        F = bodies.loading_force(bodies.indentation_from_velocity(V, law.mass))
        return np.asarray(np.log(F / np.maximum(force, 1e-300)))[force > 0]

    def restitution(velocity: Array, p_y: float, V_s: float) -> Array:
        e_p = ThorntonNing(*smooth, p_y).restitution(velocity, law.mass)
        return np.asarray(np.sqrt(np.maximum(e_p**2 - (V_s / velocity) ** 2, 0.0)))

    source = "C. Thornton, Z. Ning, Powder Technology 99 (1998) 154-162"
    begin = math.log(law.yield_pressure or 0.01 * law.contact_modulus)
    V_s = law.sticks_below or law.smooth_sticking_velocity or 0.0

    p_y = math.exp(least_squares_from(forces, [begin])[0])
    yield judged(
        law,
        "thornton-ning-force",
        lambda v: restitution(v, p_y, V_s),
        {"yield_pressure_Pa": p_y, **_adhesion_of(law, V_s)},
        source=source,
        ends=_AT_FORCE_ZERO,
        fitted_to="the largest force at each velocity",
    )

    scale = law.lowest
    adhesive = V_s > 0
    x = fit_restitution(
        law,
        lambda v, x: restitution(v, math.exp(x[0]), scale * x[1] if adhesive else 0.0),
        [begin, V_s / scale][: 1 + adhesive],
        [-np.inf, 0.0][: 1 + adhesive],
    )
    fitted_V_s = scale * float(x[1]) if adhesive else 0.0
    yield judged(
        law,
        "thornton-ning",
        lambda v: restitution(v, math.exp(x[0]), fitted_V_s),
        {"yield_pressure_Pa": math.exp(x[0]), **_adhesion_of(law, fitted_V_s)},
        source=source,
        ends=_AT_FORCE_ZERO,
    )


def _adhesion_of(law: Law, V_s: float) -> Parameters:
    """V_s, and the work of adhesion of smooth elastic bodies with this V_s; empty if V_s is 0."""
    if V_s <= 0:
        return {}
    unit = JKR(law.radius, law.contact_modulus, 1.0).sticking_velocity(law.mass)
    return {
        "sticking_velocity_m_per_s": V_s,
        "work_of_adhesion_J_per_m2": float((V_s / unit) ** 1.2),
    }


def _walton_braun(law: Law) -> FittedLaw:
    k1 = stiffness(law, exponent=1.0)
    # Hardening increases the unloading stiffness with the velocity. With the hardening `scale`, the
    # increase at the highest velocity is k1.
    scale = math.sqrt(k1 / law.mass) / law.highest

    def springs(x: Array) -> Parameters:
        return {
            "loading_stiffness_N_per_m": k1,
            "unloading_stiffness_N_per_m": k1 * math.exp(x[0]),
            "hardening_per_m": scale * float(x[1]) ** 2,
        }

    return _fitted_springs(
        law,
        "walton-braun",
        WaltonBraun,
        springs,
        [0.1, 1.0],
        [0.0, 0.0],
        source="O. R. Walton, R. L. Braun, J. Rheology 30 (1986) 949-980; k2 = k_u + S F_max",
        ends=_AT_FORCE_ZERO,
    )


def _luding(law: Law) -> FittedLaw:
    k1 = stiffness(law, exponent=1.0)
    deepest = law.highest * math.sqrt(law.mass / k1)

    def springs(x: Array) -> Parameters:
        return {
            "loading_stiffness_N_per_m": k1,
            "limit_stiffness_N_per_m": k1 * math.exp(x[0]),
            "adhesive_stiffness_N_per_m": k1 * _or_zero(x[2]) if adhesive else 0.0,
            "plasticity_depth": deepest / (2 * law.radius) * math.exp(x[1]),
        }

    adhesive = [0.1] if law.work_of_adhesion > 0 else []
    stiff = -2 * math.log(max(float(resolved(law, "restitution").mean()), 0.05))
    return _fitted_springs(
        law,
        "luding",
        partial(Luding, law.radius),
        springs,
        [stiff, -2.0, *adhesive],
        [1e-9, -15.0, *(0.0 for _ in adhesive)],
        source="S. Luding, Granular Matter 10 (2008) 235-246; plasticity depth of 2 R*",
        ends="indentation zero" if adhesive else _AT_FORCE_ZERO,
    )


def _eepa(law: Law) -> FittedLaw:
    n = 1.5
    k1 = stiffness(law, exponent=n)
    known, pulls = _pull_off(law)
    force = (
        float(pulls.mean()) if known.size else float(np.abs(resolved(law, "force")).min()) or 1.0
    )

    def springs(x: Array) -> Parameters:
        return {
            "loading_stiffness_N_per_m_n": k1,
            "unloading_stiffness_N_per_m_n": k1 * math.exp(x[0]),
            "adhesive_stiffness_N_per_m_n": k1 * _or_zero(x[1]) if adhesive else 0.0,
            "constant_force_N": -force * _or_zero(x[2]) if adhesive else 0.0,
            "exponent": n,
        }

    adhesive = [0.01, 0.5 if known.size else 0.01] if law.work_of_adhesion > 0 else []
    return _fitted_springs(
        law,
        "eepa",
        EEPA,
        springs,
        [1.0, *adhesive],
        [0.0, *(0.0 for _ in adhesive)],
        source="S. C. Thakur et al., Granular Matter 16 (2014) 383-400; exponent fixed at 3/2",
        ends="indentation zero" if adhesive else _AT_FORCE_ZERO,
        note="" if adhesive else "without adhesion e is the same at every velocity",
    )


def _fitted_springs(
    law: Law,
    name: str,
    theory: Callable[..., Any],
    springs: Callable[[Array], Parameters],
    start: list[float],
    low: list[float],
    **words: str,
) -> FittedLaw:
    """Fit a spring model to COR and, if it has adhesion, to the pull-off forces of the points.

    `springs` computes the parameters of the model, in the order of the arguments of `theory`, from
    an array of unknowns, which begin at `start` and stay at or above `low`. `words` go to
    `judged`.
    """

    def model(x: Array) -> Any:
        return theory(*springs(x).values())

    def pull_off(x: Array) -> Array:
        """Fitted over computed pull-off force, minus 1."""
        fitted = model(x)
        deepest = fitted.indentation_from_velocity(known, law.mass)
        return np.asarray(fitted.pull_off_force(deepest) / pulls - 1)

    known, pulls = _pull_off(law)
    # Walton and Braun's springs know no adhesion.
    adhesive = (
        law.work_of_adhesion > 0
        and known.size > 0
        and hasattr(model(np.array(start)), "pull_off_force")
    )
    x = fit_restitution(
        law,
        lambda V, x: model(x).restitution(V, law.mass),
        start,
        low,
        others=(lambda x: _PULL_OFF * pull_off(x)) if adhesive else None,
    )
    fit = judged(law, name, lambda V: model(x).restitution(V, law.mass), springs(x), **words)
    if not adhesive:
        return fit
    worst = float(np.abs(pull_off(x)).max())
    note = f"the pull-off force is within {100 * worst:.2g} % of the computed one"
    return replace(
        fit,
        fitted_to="the coefficient of restitution and the pull-off force",
        pull_off_misfit=worst,
        note="; ".join(filter(None, (fit.note, note))),
    )


def _pull_off(law: Law) -> tuple[Array, Array]:
    V, forces = resolved(law, "velocity"), resolved(law, "pull_off_force")
    known = forces > 0
    return V[known], forces[known]


def _or_zero(share: float) -> float:
    return float(share) if share > _ZERO else 0.0


def _mdr(law: Law) -> FittedLaw | None:
    """Fit mdr of LAMMPS, a sphere on a rigid flat; None for two unlike spheres.

    Two equal spheres act like two such contacts in series.
    """
    sphere = law.second if law.first.wall else law.first  # a pair has at most one wall
    nu = max(sphere.poissons_ratio, 0.0)
    E = law.contact_modulus * (1 - nu**2)
    if law.first.wall or law.second.wall:
        share, mass = 1.0, law.mass
    elif law.first.may_equal(law.second):
        share, mass, E = 0.5, 2 * law.mass, 2 * E
    else:
        return None

    def restitution(V: Array, x: Array) -> Array:
        return MDR(sphere.radius or math.nan, E, nu, math.exp(x[0])).restitution(share * V, mass)

    def restitution_near_jump(V: Array, x: Array) -> Array:
        return restitution(np.array([[1 - _JUMP], [1.0], [1 + _JUMP]]) * V, x)

    start = math.log((law.yield_pressure or 0.03 * law.contact_modulus) / 2.8)
    x = fit_restitution(law, restitution_near_jump, [start], [start - 7], high=[start + 7])
    return judged(
        law,
        "lammps-mdr",
        lambda V: restitution(V, x),
        {"yield_strength_Pa": math.exp(x[0]), "youngs_modulus_Pa": E, "poissons_ratio": nu},
        source="W. Zunker, K. Kamrin, J. Mech. Phys. Solids 183 (2024) 105492, as in LAMMPS",
        ends=_AT_FORCE_ZERO,
        note="without the adhesion of the model" if law.work_of_adhesion > 0 else "",
    )
