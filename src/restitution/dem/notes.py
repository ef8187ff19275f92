"""The notes of an export: origin and conventions of every pair, and warnings with their pairs."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from restitution.dem.pair import ExportedPair, pull_off_force
from restitution.display import without_numbers
from restitution.errors import DomainError, one_line
from restitution.laws.law import Law
from restitution.theory.jkr import JKR

_LEFT_OUT = (
    "the pull-off force is not modelled below, because the damping alone produces the e of this "
    "pair: an adhesive contact model would dissipate additional energy and lower e"
)
_OBSTACLES = {
    "LAMMPS": "jkr and dmt do not accept coeff_restitution",
    "LIGGGHTS": "cohesion sjkr needs an energy density instead of the work of adhesion",
    "MuJoCo": "contact forces are never attractive",
    "Kratos": "its JKR and DMT laws lose no energy by adhesion; the export to c or python has it",
    "Drake": "contact forces are never attractive",
}
_MOST = 20  # largest number of pairs that are listed after a warning


def grouped_warnings(pairs: Sequence[ExportedPair], *, holds: bool = False) -> list[str]:
    """Each warning once, with its pairs; warnings that differ only in numbers count as one.

    `holds` says that the exported model keeps bodies in contact that stick.
    """
    groups: dict[str, list[tuple[ExportedPair, str]]] = {}
    for pair in pairs:
        for text in dict.fromkeys(_warnings(pair, holds=holds)):
            groups.setdefault(without_numbers(text), []).append((pair, text))
    return [f"WARNING: {_in_words(group, len(pairs))}" for group in groups.values()]


def numbers(pairs: Sequence[ExportedPair], count: int = 0) -> str:
    """The type numbers of `pairs`: "pairs 1 1, 1 2", or "all pairs" if they are `count`."""
    if 1 < len(pairs) == count:
        return "all pairs"
    listed = [f"{pair.i} {pair.j}" for pair in pairs[:_MOST]]
    more = f" and {len(pairs) - _MOST} more" if len(pairs) > _MOST else ""
    return f"pair{'' if len(pairs) == 1 else 's'} {', '.join(listed)}{more}"


def about(pairs: Sequence[ExportedPair], code: str, *, pulls: bool = False) -> list[str]:
    """The law of each pair; lines that are the same for all pairs are written once.

    `pulls` says that the exported model has the pull-off force.
    """
    described = [_about(pair, code, pulls=pulls) for pair in pairs]
    common = [line for line in described[0] if all(line in lines for lines in described)]
    several = len(pairs) > 1
    lines = ["", "All pairs:", *common] if several and common else []
    for pair, own in zip(pairs, described, strict=True):
        lines += ["", f"Pair {pair.i} {pair.j}: {pair.first} and {pair.second}"]
        lines += [line for line in own if not several or line not in common]
    return lines


def _warnings(pair: ExportedPair, *, holds: bool) -> list[str]:
    """The warnings of a pair; `{pairs}` stands for the pairs for which a warning holds."""
    lines, V = [], f"{pair.velocity:.6g} m/s"
    if not pair.law.at(pair.velocity).resolved:
        lines.append(
            f"unresolved at {V} ({{pairs}}): the grid was too coarse there, and the error of e "
            "may be too small"
        )
    if pair.restitution == 0 and not holds:
        lines.append(f"{{pairs}} sticks at {V}, but e = 0 does not keep the bodies in contact")
    return lines + [f"{{pairs}}: {text}" for text in pair.law.warnings]


def _in_words(group: Sequence[tuple[ExportedPair, str]], count: int) -> str:
    pairs, texts = [pair for pair, _ in group], {text for _, text in group}
    differ = " (with other numbers for other pairs)" if len(texts) > 1 else ""
    text = group[0][1]
    if len(pairs) > 1:
        text = text.replace("{pairs} sticks", "{pairs} stick", 1)
    return text.replace("{pairs}", numbers(pairs, count), 1) + differ


def _about(pair: ExportedPair, code: str, *, pulls: bool) -> list[str]:
    law, velocity = pair.law, pair.velocity
    p_y = "none (elastic)" if law.yield_pressure is None else f"{law.yield_pressure:.6g} Pa"
    title = textwrap.shorten(one_line(law.title), 200, placeholder=" ...")
    source = law.model.get("yield_pressure", "given")
    return [
        *([f"  title: {title}"] if title else []),
        f"  e = {pair.restitution:.6g} +/- {law.at(velocity).error:.2g} at {velocity:.6g} m/s"
        + _elsewhere(law, velocity),
        *_covered(law, velocity),
        *_losses(law, velocity),
        f"  R* = {law.radius:.6g} m, E* = {law.contact_modulus:.6g} Pa, m* = {law.mass:.6g} kg",
        f"  yield pressure p_y: {p_y}; convention: {law.conventions.yield_pressure}",
        *_size_effect(law),
        f"  source of the yield pressure: {source}",
        f"  end of contact assumed for e: {law.conventions.end_of_contact}",
        f"  the error of e includes: {law.conventions.restitution_error}",
        f"  elastic contact time at {velocity:.6g} m/s: {pair.contact_time:.3g} s",
        f"  computed from {law.lowest:.4g} to {law.highest:.4g} m/s; nothing is extrapolated",
        *_adhesion(law, velocity, code, pulls=pulls),
    ]


def _size_effect(law: Law) -> list[str]:
    if (length := law.model.get("size_effect_m")) is None:
        return []
    return [
        f"  small contacts are harder (size effect h* = {float(length):.4g} m); p_y: smooth bodies"
    ]


def _elsewhere(law: Law, velocity: float) -> str:
    said = []
    for V in (velocity / 2, velocity * 2):
        with suppress(DomainError):
            said.append(f"{law.at(V).restitution:.4g} at {V:.6g} m/s")
    return f" (but {', '.join(said)})" if said else ""


def _covered(law: Law, velocity: float) -> list[str]:
    if law.coverage is None:
        return []
    deviation = np.interp(
        math.log(velocity), np.log(law.column("velocity")), law.column("deviation")
    )
    return [
        f"  e is that of surfaces that earlier impacts have covered {law.coverage:.3g} times; its "
        f"standard deviation over places is {deviation:.2g}"
    ]


def _losses(law: Law, velocity: float) -> list[str]:
    nearest = min(law.points, key=lambda point: abs(point.velocity - velocity))
    known = ", ".join(f"{name} {nearest.factors[name]:.4g}" for name in law.losses)
    at = f"factors at {nearest.velocity:.4g} m/s"
    return [f"  e includes losses beside yielding and adhesion, {at}: {known}"] if known else []


def _adhesion(law: Law, velocity: float, code: str, *, pulls: bool) -> list[str]:
    if law.work_of_adhesion == 0:
        return []
    force = pull_off_force(law, velocity)
    said = "not known (it needs unloading curves)" if math.isnan(force) else f"{force:.4g} N"
    jkr = JKR(law.radius, law.contact_modulus, law.work_of_adhesion)
    obstacle = f"; {_OBSTACLES[code]}" if code in _OBSTACLES else ""
    return [
        f"  adhesion {law.work_of_adhesion:.4g} J/m^2: e includes its dissipation",
        f"  pull-off force after an impact at {velocity:.6g} m/s: {said}; JKR of the smooth "
        f"bodies: {float(jkr.pull_off_force):.4g} N",
        *([] if pulls else [f"  {_LEFT_OUT}{obstacle}"]),
    ]
