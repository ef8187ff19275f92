"""Contacts with the criterion of the paper, `pohrt-popov`: their numbers do not move by a digit.

`python tests/contact/test_paper_numbers.py` writes them anew, which is only right after a change
that is meant to move the figures of the paper.
"""

import json
import math
from pathlib import Path

import pytest

from restitution import Body, Contact, Grid, Pair, collide, generate_surface, smooth, solve
from restitution.contact.separation import separate
from restitution.numerics.kernels import instruction_set
from tolerance import approx

FILE = Path(__file__).with_name("paper_numbers.json")
STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850.0)
CASES = {
    f"{approach} {surface} {model}": (approach, surface, *values)
    for approach in ("equilibrium", "hertzian", "pull-increments")
    for surface in ("smooth", "rough")
    for model, values in {
        "elastic": (math.inf, None, 4e-9),
        "yields": (0.75e9, None, 20e-9),
        "truncated": (0.75e9, "truncated", 20e-9),
    }.items()
}


def compute(approach, surface, yield_pressure, plasticity, depth):
    """The numbers of one cycle."""
    grid = Grid((48, 44), (0.16e-6, 0.18e-6))
    shape = {"kind": "gaussian", "rms": 3e-9, "correlation_length": 1.5e-6, "seed": 5}
    of = smooth(grid) if surface == "smooth" else generate_surface(grid, **shape)
    contact = Contact(
        Pair(STEEL, STEEL),
        of,
        yield_pressure,
        plasticity,
        work_of_adhesion=0.05,
        approach=approach,
        detachment="pohrt-popov",
    )
    state = solve(contact, depth)
    path = list(separate(state))
    collision = collide(state, path)
    return {
        "force": state.force,
        "area": state.contact_area,
        "stored_energy": state.stored_energy,
        "loading_work": state.loading_work,
        "loading_work_error": state.work_error,
        "unloading_work": collision.unloading_work,
        "unloading_work_error": collision.unloading_work_error,
        "pull_off_force": collision.pull_off_force,
        "separation": collision.separation_indentation,
        "adhesive_loss": collision.adhesive_loss,
        "steps": len(path),
        "convolutions": state.convolutions + collision.convolutions,
    }


@pytest.mark.parametrize("name", CASES)
def test_the_paper_keeps_its_numbers(name):
    """Equal on the processor on which they were stored; others round differently."""
    stored = json.loads(FILE.read_text())
    found = compute(*CASES[name])
    if stored["instruction_set"] == instruction_set:
        assert found == stored[name]
    else:
        for key in ("force", "loading_work", "unloading_work", "pull_off_force"):
            assert found[key] == approx(stored[name][key], rel=1e-3), key


if __name__ == "__main__":
    numbers = {name: compute(*case) for name, case in CASES.items()}
    text = json.dumps({"instruction_set": instruction_set, **numbers}, indent=1)
    FILE.write_text(text + "\n")
