"""Plastic work under a pressure bound that grows with deformation."""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.state import Array, State
from restitution.numerics.box import Box

# In each step, the pressure bound of a node grows. The error of the plastic work is a fraction of
# this growth times the plastic displacement of the step. The fraction is _RULE_ERROR for nodes that
# had yielded before the step, and _NEW_ERROR for nodes that begin to yield in the step. Both
# fractions come from a comparison with steps that are 11 times finer. At nodes that begin to yield,
# the mean of the bound during yielding is the bound before the step plus _NEW times the growth.
_RULE_ERROR, _NEW, _NEW_ERROR = 0.1, 0.8, 0.25


def plastic_work(before: State | None, after: State) -> tuple[float, float]:
    """Plastic work (J) between two states of loading, and its error (J).

    If `before` is None, loading begins from the undeformed bodies. Otherwise, `after` is at most
    1.42 times as deep as `before`. Between the indentations δ₁ and δ₂, each node yields by the
    displacement Δu while its pressure bound grows from b₁ to b₂.

    At nodes that had yielded before, the plastic displacement is assumed linear in δ and the bound
    linear in ln δ. The work per area is then
    Δu [b₁ + (b₂ − b₁) (δ₂/(δ₂ − δ₁) − 1/ln(δ₂/δ₁))],
    and its error is `_RULE_ERROR` Δu (b₂ − b₁).

    At nodes that begin to yield in this step, the mean of the bound during yielding is nearer to b₂
    than to b₁. The work per area is then Δu [b₁ + `_NEW` (b₂ − b₁)], and its error is
    `_NEW_ERROR` Δu (b₂ − b₁).
    """
    contact, box = after.contact, after.box
    given, begun = after.plastic_displacement[box], np.asarray(contact.first_yield_pressure)
    old, ratio = np.zeros(1, dtype=bool), math.inf
    if before is not None:
        begun = _on(before.bound, box)
        old = before.plastic_displacement[box] > 0
        given = given - before.plastic_displacement[box]
        if before.indentation > 0:
            ratio = after.indentation / before.indentation
    share = ratio / (ratio - 1) - 1 / math.log(ratio) if 1 < ratio < math.inf else 0.5
    area = contact.grid.cell_area
    whole = float(np.sum(given * begun)) * area
    growth = given * (_on(after.bound, box) - begun)
    on, new = (float(np.sum(growth, where=nodes)) * area for nodes in (old, ~old))
    return whole + share * on + _NEW * new, _RULE_ERROR * abs(on) + _NEW_ERROR * abs(new)


def _on(bound: Array | float, box: Box) -> Array:
    """Return the part of `bound` on `box`, or `bound` itself if it is a number."""
    return np.asarray(bound) if np.ndim(bound) == 0 else np.asarray(bound)[box]
