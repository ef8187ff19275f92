"""The fitted `mdr` law as comments in the export to LAMMPS: where it can be used, and where not.

What LAMMPS 22Jul2025 does (tried, `tests/dem/test_lammps_mdr.py`): pair_style granular takes one
mdr model, with the same values for every pair of types, and refuses any other normal model beside
it. A wall with mdr crashes it unless pair_style has mdr, too; fix wall/gran then takes values of
its own (or another model), fix wall/gran/region only those of pair_style.
"""

from __future__ import annotations

import math

from restitution.dem.export_common import FRICTION, Pair, number, plain
from restitution.laws.law import FittedLaw

NAME = "lammps-mdr"
_FAR = 0.1  # of e: a fitted law that is further off is not offered


def mdr_lines(pairs: list[Pair], velocity: float) -> list[str]:
    """Comment lines for every pair: its mdr line, or why there is none."""
    lines = []
    for pair in pairs:
        fit = _fit_of(pair)
        reason = _obstacle(pairs, pair, velocity)
        if reason or fit is None:
            lines.append(f"# No mdr line for pair {pair.i} {pair.j}: {reason}.")
        else:
            lines += _offer(pair, fit)
    return lines


def _fit_of(pair: Pair) -> FittedLaw | None:
    return next((fit for fit in pair.law.laws if fit.name == NAME), None)


def _obstacle(pairs: list[Pair], pair: Pair, velocity: float) -> str:
    """Why `pair` gets no mdr line; empty if it gets one."""
    spheres = [other for other in pairs if not other.wall]
    if not pair.wall and len(spheres) > 1:
        return (
            "LAMMPS takes one mdr model in a pair_style, with the same values for all\n"
            "#   pairs of types, and no other normal model beside it; here are several types"
        )
    if pair.wall and spheres and any(_obstacle(spheres, other, velocity) for other in spheres):
        return (
            "LAMMPS takes mdr at a wall only where pair_style granular has mdr, too,\n"
            "#   and the pairs of spheres above have none"
        )
    return _unfit(pair, velocity)


def _unfit(pair: Pair, velocity: float) -> str:
    """Why the fit of `pair` itself is not offered."""
    fit = _fit_of(pair)
    if fit is None and not pair.law.laws:
        return "no law was fitted to it"
    if fit is None:
        return "mdr is fitted to one sphere on a wall and to two equal spheres only"
    if fit.worst > _FAR:
        return f"the fitted mdr is off by up to {fit.worst:.2g} in e"
    if not pair.law.fits_hold_at(velocity):
        low, high = _range(pair)
        return f"it is fitted from {low:.4g} to {high:.4g} m/s, which leaves out {velocity:.4g} m/s"
    return ""


def _range(pair: Pair) -> tuple[float, float]:
    return pair.law.fitted_range or (math.nan, math.nan)


def _offer(pair: Pair, fit: FittedLaw) -> list[str]:
    """The fitted elastic-plastic law as comments: one sphere on a rigid flat has its E and nu."""
    names = "youngs_modulus_Pa", "poissons_ratio", "yield_strength_Pa"
    E, nu, Y = (number(fit.parameters[name]) for name in names)
    model = (
        f"mdr {E} {nu} {Y} 0.0 0.5 0.0 tangential linear_history 1e6 1.0 {FRICTION} damping mdr 1"
    )
    use = f"pair_coeff {pair.i} {pair.j} {model}"
    needs = [
        "#   Needs atom_style sphere 1 and newton off. Walls by fix wall/gran keep their own line,",
        "#   by fix wall/gran/region they need mdr with the same values.",
    ]
    if pair.wall:
        use = f"variable wall_{pair.i}_{pair.j} string 'granular {model}'"
        needs = [
            "#   Needs atom_style sphere 1, newton off and mdr in pair_style granular (without it",
            "#   LAMMPS 22Jul2025 crashes), and fix wall/gran: fix wall/gran/region refuses other",
            "#   values than those of pair_style.",
        ]
    low, high = _range(pair)
    return [
        f"# Instead, for pair {pair.i} {pair.j}: an elastic-plastic force law fitted to "
        f"{plain(fit.fitted_to)}, whose e depends on the velocity.",
        f"#   Its worst difference in e is {fit.worst:.2g}, from {low:.4g} to {high:.4g} m/s; "
        "do not use it beyond.",
        f"#   It ends where: {plain(fit.ends)}. {plain(fit.note)}".rstrip(),
        *needs,
        f"# {use}",
    ]
