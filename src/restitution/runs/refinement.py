"""The grid of `grid.refine = "auto"`: the coarsest that resolves the shallowest contact."""

from __future__ import annotations

from pathlib import Path

from restitution.case.case import Case
from restitution.contact.checks.resolution import NODES_PER_PATCH, median_patch, resolves
from restitution.runs.loading import load_to
from restitution.runs.log import Say, ignore

FACTORS = (1, 2, 4, 8, 16)
# Nodes of the finest grid that "auto" tries: a few minutes and about 2 GiB.
MOST_NODES = 2**24


def settled(case: Case, folder: Path, warn: Say = ignore) -> Case:
    """`case` with a number for `grid.refine = "auto"`; `warn` is called if it may be too small.

    The surface (the first of an ensemble) is refined until half of its contact at the shallowest
    depth lies in patches of `NODES_PER_PATCH` nodes or more. Only the shallowest depth is solved,
    because deeper contacts have larger patches. If no grid is fine enough, the finest of up to
    `MOST_NODES` nodes is used. Raises as `solve`.
    """
    if case.grid is None or case.grid.refine != "auto":
        return case
    shallowest, patch = case.depths()[0], 0
    finest, why, nodes = case.refined(1), "", (1, 1)
    for factor in FACTORS:
        finer = case.refined(factor)
        if factor > 1 and factor**2 * nodes[0] * nodes[1] > MOST_NODES:
            why = f"the next grid would have {factor * nodes[0]} x {factor * nodes[1]} nodes"
            break
        contact = finer.realisation(0).contact(folder)
        finest = finer
        if factor == 1:
            nodes = contact.grid.nodes
        state = load_to(finer, contact, shallowest)
        patch = median_patch(state.patch_sizes())
        if resolves(patch):
            return finer
        why = f"{factor} is the largest refine"
    unit, scale = ("nm", 1e9) if case.indentation else ("N", 1) if case.load else ("m/s", 1)
    depth = f"{scale * shallowest:.4g} {unit}"
    warn(
        f'grid.refine = "auto" ends at {finest.grid.factor if finest.grid else 1} ({why}), and the '
        f"contact at {depth} is not resolved: half of it is in patches of at most {patch} nodes, "
        f"and {NODES_PER_PATCH} are needed; begin deeper, or leave out short waves "
        "(roughness.shortest)"
    )
    return finest
