"""The grid of each depth for `grid.refine = "auto"`: the coarsest that resolves its contact."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from restitution.case.case import Case
from restitution.case.schema import FACTORS
from restitution.contact.checks.resolution import NODES_PER_PATCH, median_patch
from restitution.contact.contact import Contact
from restitution.errors import DomainError, NotConvergedError
from restitution.runs.loading import load_to
from restitution.runs.log import Say, ignore

# Nodes of the finest grid that "auto" tries: a few minutes and about 2 GiB.
MOST_NODES = 2**24
# Times the nodes that a patch needs: other surfaces of an ensemble may have smaller patches.
_MARGIN = 1.5


def settled(case: Case, folder: Path, warn: Say = ignore) -> Case:
    """`case` with a number for each depth in place of `grid.refine = "auto"`.

    Each depth gets the coarsest grid on which half of its contact lies in patches of 1.5 times
    `NODES_PER_PATCH` nodes, on the first surface of an ensemble. Deeper contacts have larger
    patches, so bisection finds the shallowest depth that a grid resolves. Depths that no grid of up
    to `MOST_NODES` nodes resolves get the finest one, and `warn` is told. Raises as `solve`.
    """
    if case.grid is None or case.grid.refine != "auto":
        return case
    depths = case.depths()
    factors: list[int] = []  # of the deepest depths, in order
    finest, why, nodes = 1, "", (1, 1)
    for factor in FACTORS:
        if factor > 1 and factor**2 * nodes[0] * nodes[1] > MOST_NODES:
            why = f"the next grid would have {factor * nodes[0]} x {factor * nodes[1]} nodes"
            break
        finer = case.refined(factor)
        contact = finer.realisation(0).contact(folder)
        if factor == 1:
            nodes = contact.grid.nodes
        left = depths[: len(depths) - len(factors)]
        first = _first_resolved(finer, contact, left)
        factors = [factor] * (len(left) - first) + factors
        finest, why = factor, f"{factor} is the largest refine"
        if first == 0:
            break
    if unresolved := len(depths) - len(factors):
        unit, scale = ("nm", 1e9) if case.indentation else ("N", 1) if case.load else ("m/s", 1)
        below = f" up to {scale * depths[unresolved - 1]:.4g} {unit}" if unresolved > 1 else ""
        warn(
            f'grid.refine = "auto" ends at {finest} ({why}), and the contact at '
            f"{scale * depths[0]:.4g} {unit}{below} is not resolved: half of it is in patches of "
            f"fewer than {_MARGIN * NODES_PER_PATCH:.0f} nodes; begin deeper, or leave out short "
            "waves (roughness.shortest)"
        )
    found = [finest] * unresolved + factors
    refine = found[0] if len(set(found)) == 1 else tuple(found)
    return case.model_copy(update={"grid": case.grid.model_copy(update={"refine": refine})})


def later_touches(case: Case, folder: Path, factors: Iterable[int]) -> dict[int, float]:
    """How much later (m) each grid touches first than the finest of `factors`.

    The highest point of a surface lies between the nodes of a coarse grid.
    """
    R, touch = case.pair().radius, {}
    for factor in factors:
        surface = case.refined(factor).surface(folder)
        x, y = surface.grid.x[:, None], surface.grid.y[None, :]
        touch[factor] = float(((x * x + y * y) / (2 * R) - surface.height).min())
    return {factor: touch[factor] - touch[max(touch)] for factor in touch}


def _first_resolved(case: Case, contact: Contact, depths: list[float]) -> int:
    """The index of the shallowest of `depths` that the grid resolves; their number for none."""
    low, high = 0, len(depths)
    while low < high:
        middle = (low + high) // 2
        try:
            patch = median_patch(load_to(case, contact, depths[middle]).patch_sizes())
        except DomainError:  # beyond the edge, which the run will report
            high = middle
            continue
        except NotConvergedError:  # the work jumps: too few nodes
            low = middle + 1
            continue
        if patch >= _MARGIN * NODES_PER_PATCH:
            high = middle
        else:
            low = middle + 1
    return low
