"""How close the laws e(V) that a DEM code has come to a computed law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from restitution.dem.damping import viscoelastic_damping, viscoelastic_restitution_at
from restitution.dem.pair import ExportedPair
from restitution.laws.law import Array


@dataclass(frozen=True, eq=False)
class OwnLaw:
    """A law of a code, with its e at the points of the computed law; NaN where it has none."""

    name: str
    restitution: Array

    def misfit(self, pair: ExportedPair) -> float:
        """The largest difference of e at the resolved points; NaN if there are none."""
        resolved = pair.law.column("resolved").astype(bool)
        off = np.abs(self.restitution - pair.law.column("restitution"))[resolved]
        return float(off.max()) if off.size else float("nan")


OwnLaws = Callable[[ExportedPair], Sequence[OwnLaw]]
"""The laws that a code has for a pair; the first is that of the files."""


def constant(pair: ExportedPair) -> list[OwnLaw]:
    """The e of the export at every velocity."""
    return [OwnLaw("one e", np.full(len(pair.law.points), pair.restitution))]


def fitted(pair: ExportedPair, name: str, words: str) -> list[OwnLaw]:
    """The law `name` fitted to that of the pair, called `words`, if its e(V) is known."""
    fit = pair.fitted(name)
    if fit is None or not fit.restitution:
        return []
    return [OwnLaw(words, np.array(fit.restitution, dtype=float))]


@dataclass(frozen=True)
class Viscoelastic:
    """A Hertz contact with damping proportional to the contact radius, fitted to e(V) of a pair.

    `coefficient` (1/(m s)) times contact radius and reduced mass is the damping.
    """

    coefficient: float
    law: OwnLaw


def viscoelastic(pair: ExportedPair) -> Viscoelastic:
    """The fit to the resolved points; e falls as 1 − e ∝ V^⅕ (Brilliantov et al. 1996)."""
    eta = viscoelastic_damping(pair.law)
    V = pair.law.column("velocity")
    e = viscoelastic_restitution_at(pair.law, eta, V)
    return Viscoelastic(eta, OwnLaw("restitution_viscoelastic.lmp", e))


def closest(pair: ExportedPair, code: str, own: OwnLaws) -> str:
    """Which law of `code` is closest to e(V), and how far it and that of the files are off."""
    laws = own(pair)
    misfits = [law.misfit(pair) for law in laws]
    if np.isnan(misfits).all():
        return ""
    best = int(np.nanargmin(misfits))
    low, high = pair.law.lowest, pair.law.highest
    said = (
        f"From {low:.4g} to {high:.4g} m/s, e of these files ({laws[0].name}) is off by up to "
        f"{misfits[0]:.2g}"
    )
    if best:
        return f"{said}. Closest of the laws of {code}: {laws[best].name}, {misfits[best]:.2g}"
    return f"{said}; no other law of {code} that was tried is closer" if laws[1:] else said
