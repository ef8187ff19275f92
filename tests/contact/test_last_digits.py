"""Contacts whose numbers do not move by a digit.

Those with adhesion have the criterion of the paper, `pohrt-popov`. Those without adhesion are
elastic, have a constant pressure bound or are truncated; their stored numbers were computed by the
last version before `expanding-cavity`, commit 222fb89.

`python tests/contact/test_last_digits.py` writes them anew, which is only right after a change
that is meant to move the figures of the paper or the numbers of these models.
"""

import json
import math
from pathlib import Path

import pytest

from restitution import Body, Contact, Grid, Pair, collide, generate_surface, smooth, solve, step
from restitution.case.models import adhesion_of, plasticity_of
from restitution.contact.jkr.separation import separate
from restitution.numerics.kernels import instruction_set
from tolerance import approx

FILE = Path(__file__).with_name("last_digits.json")
STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850.0)
DEPTH = 20e-9
GRIDS = {
    "coarse": Grid((48, 44), (0.16e-6, 0.18e-6)),
    # The region of overlap has over 120 × 120 nodes, so the solve starts on a coarser grid.
    "fine": Grid((160, 150), (0.046e-6, 0.05e-6)),
}
ADHESIVE = {
    f"{approach} {surface} {model}": (approach, surface, *values)
    for approach in ("equilibrium", "hertzian", "pull-increments")
    for surface in ("smooth", "gaussian")
    for model, values in {
        "elastic": (math.inf, None, 4e-9),
        "yields": (0.75e9, None, DEPTH),
        "truncated": (0.75e9, "truncated", DEPTH),
    }.items()
}
NONADHESIVE = {
    f"without adhesion, {grid} {surface} {model}": (GRIDS[grid], surface, *values)
    for grid, surface in (
        ("coarse", "smooth"),
        ("coarse", "gaussian"),
        ("coarse", "exponential"),
        ("fine", "gaussian"),
    )
    for model, values in {
        "elastic": (math.inf, "equilibrium"),
        "yields": (0.3e9, "equilibrium"),
        "fully plastic": (0.03e9, "equilibrium"),
        "truncated": (0.3e9, "truncated"),
    }.items()
}


def surface_of(kind, grid):
    if kind == "smooth":
        return smooth(grid)
    return generate_surface(grid, kind=kind, rms=3e-9, correlation_length=1.5e-6, seed=5)


def loaded(state):
    """The numbers of a loaded contact."""
    return {
        "force": state.force,
        "area": state.contact_area,
        "stored_energy": state.stored_energy,
        "loading_work": state.loading_work,
        "loading_work_error": state.work_error,
    }


def compute_adhesive(approach, surface, yield_pressure, plasticity, depth):
    """The numbers of one cycle."""
    contact = Contact(
        Pair(STEEL, STEEL),
        surface_of(surface, GRIDS["coarse"]),
        plasticity=plasticity_of(plasticity, yield_pressure),
        adhesion=adhesion_of(work_of_adhesion=0.05, approach=approach, detachment="pohrt-popov"),
    )
    state = solve(contact, depth)
    path = list(separate(state))
    collision = collide(state, path)
    return loaded(state) | {
        "unloading_work": collision.unloading_work,
        "unloading_work_error": collision.unloading_work_error,
        "pull_off_force": collision.pull_off_force,
        "separation": collision.separation_indentation,
        "adhesive_loss": collision.adhesive_loss,
        "steps": len(path),
        "convolutions": state.convolutions + collision.convolutions,
    }


def compute_nonadhesive(grid, surface, yield_pressure, plasticity):
    """The numbers of one cycle, and of one step of unloading."""
    contact = Contact(
        Pair(STEEL, STEEL),
        surface_of(surface, grid),
        plasticity=plasticity_of(plasticity, yield_pressure),
    )
    state = solve(contact, DEPTH)
    collision = collide(state)
    return loaded(state) | {
        "unloading_work": collision.unloading_work,
        "restitution": collision.restitution,
        "separation": collision.separation_indentation,
        "plastic_volume": state.plastic_volume,
        "unloaded_force": step(state, 0.9 * DEPTH).force,
        "convolutions": state.convolutions,
    }


def require_stored(found, name, keys, rel):
    """Equal on the processor on which they were stored; others round differently."""
    stored = json.loads(FILE.read_text())
    if stored["instruction_set"] == instruction_set:
        assert found == stored[name]
    else:
        for key in keys:
            assert found[key] == approx(stored[name][key], rel=rel), key


@pytest.mark.parametrize("name", ADHESIVE)
def test_the_paper_keeps_its_numbers(name):
    keys = ("force", "loading_work", "unloading_work", "pull_off_force")
    require_stored(compute_adhesive(*ADHESIVE[name]), name, keys, rel=1e-3)


@pytest.mark.parametrize("name", NONADHESIVE)
def test_contacts_without_adhesion_keep_their_numbers(name):
    keys = ("force", "area", "loading_work", "unloading_work", "restitution", "unloaded_force")
    require_stored(compute_nonadhesive(*NONADHESIVE[name]), name, keys, rel=1e-5)


if __name__ == "__main__":
    numbers = {name: compute_adhesive(*case) for name, case in ADHESIVE.items()}
    numbers |= {name: compute_nonadhesive(*case) for name, case in NONADHESIVE.items()}
    text = json.dumps({"instruction_set": instruction_set, **numbers}, indent=1)
    FILE.write_text(text + "\n")
