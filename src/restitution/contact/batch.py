"""Many contacts solved in one call: realisations of a surface, or depths.

The contacts of a batch are solved together on one box, each with steps of its own. That keeps a GPU
busy where one small contact cannot; on two cores it is no faster than one by one (docs/speed.md).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import reduce

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import (
    MAX_ITERATIONS,
    RESIDUAL,
    not_converged,
    overlap,
    parted,
    reach,
    refuse_edge,
    scale_of,
    settled,
    system_of,
)
from restitution.contact.state import State
from restitution.errors import CaseError
from restitution.numerics.device import current
from restitution.numerics.items import every
from restitution.numerics.nesting import minimise_nested
from restitution.numerics.window import union


def solve_batch(
    contacts: Sequence[Contact], indentations: Sequence[float], *, residual: float = RESIDUAL
) -> list[State]:
    """Load each of `contacts` to its indentation (m), from the undeformed bodies, in one solve.

    States are those of `solve`, within the residual; their `convolutions` are those of the batch.
    The contacts are without adhesion and in the equilibrium model, of one grid and contact modulus.
    Raises `CaseError` where they are not, and as `solve`.
    """
    _refuse_unlike(contacts, indentations)
    boxes = [reach(contact, depth) for contact, depth in zip(contacts, indentations, strict=True)]
    box = reduce(union, boxes)
    if box is None:
        return [parted(*pair) for pair in zip(contacts, indentations, strict=True)]
    device = current()
    b = np.stack([overlap(*pair, box) for pair in zip(contacts, indentations, strict=True)])
    scales = np.array([scale_of(*each) for each in zip(contacts, indentations, b, strict=True)])
    limits = np.array([contact.yield_pressure for contact in contacts])
    found, convolutions = minimise_nested(
        system_of(contacts[0]),
        device.put(b),
        device.put(limits[:, None, None]),
        tolerance=device.put((residual * scales)[:, None, None]),
        max_iterations=MAX_ITERATIONS,
    )
    reached = device.get(found.residual)[:, 0, 0] / scales
    if not every(found.converged):
        worst = int(reached.argmax())
        raise not_converged(f"contact {worst + 1} of {len(contacts)}", indentations[worst],
                            reached[worst], residual, found.iterations)  # fmt: skip
    states = [
        settled(contact, depth, box, its_b, pressure, gradient, limit=contact.yield_pressure,
                history=None, residual=float(its_residual), convolutions=convolutions)
        for contact, depth, its_b, pressure, gradient, its_residual in zip(
            contacts, indentations, b, device.get(found.point), device.get(found.gradient), reached,
            strict=True,
        )
    ]  # fmt: skip
    for state in states:
        refuse_edge(state)
    return states


def _refuse_unlike(contacts: Sequence[Contact], indentations: Sequence[float]) -> None:
    if len(contacts) != len(indentations) or not contacts:
        raise CaseError(
            f"{len(contacts)} contacts and {len(indentations)} indentations: a batch has as many "
            "of one as of the other, and one at least"
        )
    first = contacts[0]
    for contact, depth in zip(contacts, indentations, strict=True):
        if not 0 < depth < math.inf:
            raise CaseError(f"indentation: {depth} m is not a positive depth")
        if contact.adhesive or contact.plasticity != "equilibrium":
            raise CaseError("a batch holds contacts without adhesion in the equilibrium model only")
        if (contact.grid, contact.pair.contact_modulus) != (first.grid, first.pair.contact_modulus):
            raise CaseError("the contacts of a batch have one grid and one contact modulus")
