"""Choose the coarsest grid that resolves the contact at each depth, for `grid.refine = "auto"`."""

from __future__ import annotations

from bisect import bisect_left
from functools import partial
from pathlib import Path

from restitution.case.case import Case
from restitution.case.schema import FACTORS
from restitution.contact.checks.resolution import NODES_PER_PATCH, median_patch
from restitution.contact.cohesive import resolves_range
from restitution.contact.contact import Contact
from restitution.errors import DomainError, NotConvergedError
from restitution.runs.depths import load_to
from restitution.runs.log import Say, ignore
from restitution.runs.messages import no_range

# Largest number of nodes of a grid that "auto" tries. Such a grid takes a few minutes and about
# 2 GiB.
MOST_NODES = 2**24
# Safety factor on the number of nodes that a patch needs, because other surfaces of an ensemble
# may have smaller patches.
_MARGIN = 1.5


def settled(case: Case, folder: Path, warn: Say = ignore) -> Case:
    """Replace `grid.refine = "auto"` in `case` by a factor for each depth.

    Each depth gets the coarsest grid on which half of the contact nodes lie in patches of at least
    1.5 times `NODES_PER_PATCH` nodes. In an ensemble, the first surface decides. Deeper contacts
    have larger patches, so bisection finds the shallowest depth that a grid resolves. If no grid of
    up to `MOST_NODES` nodes resolves a depth, the depth gets the finest grid, and `warn` is called.
    Raises the errors of `solve`.
    """
    if case.grid.refine != "auto":
        return case
    depths = case.depths()
    factors: list[int] = []  # the factors found so far belong to the largest depths
    finest, why, nodes = 1, "", (1, 1)
    for factor in FACTORS:
        if factor > 1 and factor**2 * nodes[0] * nodes[1] > MOST_NODES:
            why = f"the next grid would have {factor * nodes[0]} x {factor * nodes[1]} nodes"
            break
        finer = case.refined(factor)
        contact = finer.realisation(0).contact(folder)
        if factor == 1:
            nodes = contact.grid.nodes
        finest, why = factor, f"{factor} is the largest refine"
        if contact.cohesive and not resolves_range(contact):
            continue
        left = depths[: len(depths) - len(factors)]
        first = bisect_left(left, True, key=partial(_resolves, finer, contact))
        factors = [factor] * (len(left) - first) + factors
        if first == 0:
            break
    if unresolved := len(depths) - len(factors):
        if case.indentation:
            quantity, unit, scale = "indentation", "nm", 1e9
        else:
            quantity, unit, scale = ("load", "N", 1.0) if case.load else ("velocity", "m/s", 1.0)
        first_depth, last_depth = (f"{scale * depths[k]:.4g}" for k in (0, unresolved - 1))
        where = f"at {first_depth}" if unresolved == 1 else f"from {first_depth} to {last_depth}"
        warn(
            f'grid.refine = "auto" stopped at {finest} ({why}). This grid does not resolve the '
            f"contact {where} {unit}: half of the contact is in patches of fewer than "
            f"{_MARGIN * NODES_PER_PATCH:.0f} nodes; begin with a larger {quantity}, or leave out "
            "short waves (roughness.shortest)"
        )
    found = [finest] * unresolved + factors
    return case.refined(found[0] if len(set(found)) == 1 else tuple(found))


def with_chosen_adhesion(case: Case, contact: Contact, warn: Say = ignore) -> Case:
    """Return `case` with the model of adhesion of `contact`, so that all its grids use this model.

    A case that states its model is returned unchanged. If the grid of `contact` is too coarse for
    the range of the attraction, `warn` is called.
    """
    if not contact.adhesive or case.interface.adhesion is not None:
        return case
    for line in no_range(contact):
        warn(line)
    interface = case.interface.model_copy(update={"adhesion": contact.adhesion})
    return case.model_copy(update={"interface": interface})


def _resolves(case: Case, contact: Contact, depth: float) -> bool:
    """Whether the grid of `contact` resolves the contact at a depth of `case`."""
    try:
        patches = load_to(case, contact, depth).patch_sizes()
    except DomainError:  # the contact reaches the edge; the run will report this
        return True
    except NotConvergedError:  # with too few contact nodes, force or work may jump
        return False
    return median_patch(patches) >= _MARGIN * NODES_PER_PATCH
