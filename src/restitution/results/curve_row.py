"""The row of `curve.csv` for one impact."""

from __future__ import annotations

import math

from restitution.collision import Collision
from restitution.contact.checks.model_error import model_error, pull_off_error
from restitution.contact.checks.resolution import (
    adhesive_spacing,
    median_patch,
    resolves_adhesion,
    resolves_contact,
)
from restitution.contact.state import State
from restitution.results.schema import COLUMNS


def curve_row(
    state: State, collision: Collision, refine: int = 1, touch: float = 0.0
) -> dict[str, float]:
    """Make the row of `curve.csv` for one state of loading, with NaN for undefined values.

    `refine` is the refinement factor of the grid. `touch` (m) is the approach at first touch on
    this grid minus that on the finest grid. It is added to the indentations.
    """
    patches = state.patch_sizes()
    median = median_patch(patches)
    # Without positive work of loading, no impact has its deepest point here.
    impact = collision.loading_work > 0
    cor = collision.restitution if impact else math.nan
    values = (
        state.indentation + touch,
        state.force,
        state.contact_area,
        state.stored_energy,
        state.plastic_work,
        collision.loading_work,
        collision.unloading_work,
        cor,
        math.nan if collision.impact_velocity is None else collision.impact_velocity,
        state.contact_nodes,
        patches.size,
        int(patches[0]) if patches.size else 0,
        state.residual,
        state.convolutions + collision.convolutions,
        collision.pull_off_force,
        pull_off_error(state, collision.pull_off_force),
        collision.separation_indentation + touch,
        min(collision.restitution_error, max(cor, 1 - cor)) if impact else math.nan,
        collision.sticks and impact,
        resolves_adhesion(state),
        adhesive_spacing(state) if state.contact.adhesive else math.nan,
        median,
        resolves_contact(state),
        *(math.nan,) * 4,  # filled in by `runs.error_budget`
        model_error(state, cor) if impact else math.nan,
        refine,
    )
    return dict(zip(COLUMNS, values, strict=True))
