"""Offer the fitted `mdr` law as an alternative in the comments of the export to LAMMPS.

`mdr` is an elastic-plastic normal force law in LAMMPS (Zunker & Kamrin 2024). Only pairs that can
use the law get such a comment.

LAMMPS 22Jul2025 behaves as follows (`tests/dem/test_lammps_mdr.py`). If pair_style granular uses
mdr, all pairs of types must use mdr with the same values. If a wall uses mdr but pair_style does
not, LAMMPS crashes. If pair_style uses mdr, fix wall/gran accepts other values or another model,
but fix wall/gran/region accepts only the values of pair_style.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.dem.notes import numbers
from restitution.dem.pair import ExportedPair
from restitution.dem.text import commented, wrapped
from restitution.laws.law import FittedLaw

NAME = "lammps-mdr"
# A fitted law is offered if its e differs by at most this value from the computed e.
_FAR = 0.1


@dataclass(frozen=True)
class MdrOffers:
    """Pairs with their fitted mdr laws, and comments with the reasons why other pairs have none."""

    offers: list[tuple[ExportedPair, FittedLaw]]
    reasons: list[str]


def mdr_offers(pairs: list[ExportedPair]) -> MdrOffers:
    """The pairs for which the fitted mdr law can be offered."""
    offers: list[tuple[ExportedPair, FittedLaw]] = []
    refused: dict[str, list[ExportedPair]] = {}
    for pair in pairs:
        obstacle, fit = _obstacle(pairs, pair), pair.fitted(NAME)
        if obstacle or fit is None:
            refused.setdefault(obstacle, []).append(pair)
        else:
            offers.append((pair, fit))
    reasons = (f"No mdr line for {numbers(of)}: {reason}." for reason, of in refused.items())
    return MdrOffers(offers, [commented(wrapped([text]), "#") for text in reasons])


def _obstacle(pairs: list[ExportedPair], pair: ExportedPair) -> str:
    """The reason why `pair` gets no mdr line; empty if it gets one."""
    spheres = [other for other in pairs if not other.wall]
    if not pair.wall and len(spheres) > 1:
        return (
            "LAMMPS accepts one mdr model in a pair_style, with the same values for all "
            "pairs of types, and no other normal model; this export has several types"
        )
    if pair.wall and spheres and any(_obstacle(spheres, other) for other in spheres):
        return (
            "LAMMPS accepts mdr at a wall only if pair_style granular has mdr, too, "
            "but no mdr line is offered for the pairs of spheres above"
        )
    return _unfit(pair)


def _unfit(pair: ExportedPair) -> str:
    fit = pair.fitted(NAME)
    if fit is None and not pair.law.laws:
        return "no law was fitted to it"
    if fit is None:
        return "mdr is fitted only to a sphere on a wall and to two equal spheres"
    if fit.worst > _FAR:
        return f"the fitted mdr is off by up to {fit.worst:.2g} in e"
    if not pair.law.fits_hold_at(pair.velocity):
        low, high = pair.law.fitted_range or (math.nan, math.nan)
        return (
            f"it is fitted from {low:.4g} to {high:.4g} m/s, and {pair.velocity:.4g} m/s is outside"
        )
    return ""
