"""Attraction of finite range: the numbers and figures in docs/adhesion.md.

The names `grids`, `sticking`, `joined`, `rough` and `balance` compute and write a table
`cohesive_NAME.csv`; all five take about twenty minutes. `figure` draws the results of `sticking`.
"""

from __future__ import annotations

import csv
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from evidence.shared import write_image, write_table
from restitution import (
    Body,
    Cohesive,
    Contact,
    Grid,
    Pair,
    Surface,
    collide,
    generate_surface,
    smooth,
    solve,
)
from restitution.case.models import plasticity_of
from restitution.contact.checks.model_error import model_error
from restitution.contact.jkr.limit import JKRLimit, hysteresis_ratio
from restitution.contact.models import COMPANION
from restitution.contact.path import unloading_path
from restitution.contact.plasticity.bound import ConstantBound
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.errors import RestitutionError
from restitution.numerics.quadrature import integrate_curve
from restitution.plots.figure import DASHED, GREY, ORANGE, Axis, Chart, Figure, Line, Points
from restitution.theory import JKR, LennardJones, MaugisDugdale

W, Z0, E_STAR = 0.05, 0.3e-9, 1e11
REFERENCE = Path(__file__).with_name("cohesive_reference.csv")


def pair_of(tabor):
    """Two equal spheres with a Tabor parameter."""
    radius = tabor**3 * E_STAR**2 * Z0**3 / W**2
    body = Body(2 * radius, 2 * E_STAR * (1 - 0.3**2), 0.3, 2500.0)
    return Pair(body, body)


def sphere(tabor, depth, cells=0.3, offset=(0.31, 0.17), **options):
    """A contact on a grid for loading to `depth` (in z0).

    `cells` is the spacing over the smaller of the length of the cohesive zone and sqrt(R* z0).
    """
    pair = pair_of(tabor)
    h = cells * min(E_STAR * Z0**2 / W, math.sqrt(pair.radius * Z0))
    n = 2 * int(math.sqrt(2 * pair.radius * Z0 * (9 + tabor + max(depth, 0.0))) / h + 2)
    grid = Grid(n, h)
    x, y = grid.x[:, None], grid.y[None, :]
    shifted = (x - offset[0] * h) ** 2 + (y - offset[1] * h) ** 2
    height = (x * x + y * y - shifted) / (2 * pair.radius)
    surface = Surface(height, grid, {"source": "shifted apex", COMPANION: 1.0})  # coarse, too
    return Contact(pair, surface, **{"adhesion": Cohesive(W, Z0), **options})


def cycle(contact, indentation):
    """Energy lost in a cycle, and pull-off force; both over their values by JKR."""
    state = solve(contact, indentation)
    path = list(unloading_path(state))
    jkr = JKR(contact.pair.radius, contact.pair.contact_modulus, contact.adhesion.work_of_adhesion)
    if isinstance(contact.adhesion, Cohesive):
        lost = path[-1].adhesive_loss
    else:
        lost = state.loading_work - contact.adhesion.separation_of(path).unloading_work
    pull_off = contact.adhesion.separation_of(path).pull_off_force
    return lost / float(jkr.hysteresis_loss), pull_off / float(jkr.pull_off_force)


def reference():
    """The rows of the axisymmetric reference on its finest mesh, by Tabor parameter."""
    with open(REFERENCE) as file:
        return {float(row["tabor_parameter"]): row for row in csv.DictReader(file)}


def grids():
    """Hysteresis and pull-off against the spacing, for three positions of the apex."""
    rows = []
    for tabor in (0.1, 0.5, 1.0, 2.0):
        exact = reference()[tabor]
        for cells in (0.8, 0.6, 0.4, 0.35, 0.3):
            offsets = ((0, 0), (0.5, 0.5), (0.31, 0.17))
            depth = max(2 * tabor, 1.0)
            found = [cycle(sphere(tabor, depth, cells, at), depth * Z0) for at in offsets]
            lost, pull_off = np.array(found).T
            rows.append(
                {
                    "tabor_parameter": tabor,
                    "spacing_over_smallest_length": cells,
                    "positions": len(offsets),
                    **_ends("hysteresis_over_jkr", lost),
                    "reference": exact["hysteresis_over_jkr"],
                    **_ends(
                        "pull_off_over_reference", pull_off / float(exact["pull_off_over_jkr"])
                    ),
                }
            )
            print(rows[-1], flush=True)
    write_table("cohesive/cohesive_grids.csv", rows)


def _ends(name, values):
    return {
        f"{name}_least": round(float(values.min()), 4),
        f"{name}_most": round(float(values.max()), 4),
    }


def sticking():
    """Sticking velocity and pull-off of smooth elastic spheres against the Tabor parameter."""
    rows = []
    for tabor in (0.1, 0.3, 0.5, 0.7, 0.85, 1.0, 1.3, 1.6, 2.0):
        lost, pull_off = cycle(sphere(tabor, 2 * tabor), 2 * tabor * Z0)
        law = LennardJones(W, Z0)
        R = pair_of(tabor).radius
        maugis = MaugisDugdale(R, E_STAR, W, law.dugdale_traction)
        rows.append(
            {
                "tabor_parameter": tabor,
                "hysteresis_over_jkr": round(lost, 5),
                "sticking_velocity_over_jkr": round(math.sqrt(lost), 4),
                "pull_off_over_jkr": round(pull_off, 4),
                "pull_off_maugis_over_jkr": round(
                    float(maugis.pull_off_force) / (1.5 * math.pi * W * R), 4
                ),
            }
        )
        print(rows[-1], flush=True)
    # JKR by boundary elements, with 8 nodes over the pull-off radius, is the same at any Tabor
    # parameter.
    pair = pair_of(2.0)
    jkr = JKR(pair.radius, E_STAR, W)
    h = float(jkr.pull_off_radius) / 8
    contact = Contact(pair, smooth(Grid(64, h)), adhesion=JKRLimit(W))
    lost, pull_off = cycle(contact, -3 * float(jkr.break_indentation))
    rows.append(
        {
            "tabor_parameter": "jkr",
            "hysteresis_over_jkr": round(lost, 5),
            "sticking_velocity_over_jkr": round(math.sqrt(lost), 4),
            "pull_off_over_jkr": round(pull_off, 4),
            "pull_off_maugis_over_jkr": "",
        }
    )
    write_table("cohesive/cohesive_sticking.csv", rows)


def figure():
    """Draw the sticking velocity against the Tabor parameter."""
    with open(Path(__file__).with_name("cohesive_sticking.csv")) as file:
        rows = list(csv.DictReader(file))
    tabor = [float(row["tabor_parameter"]) for row in rows[:-1]]
    found = [float(row["sticking_velocity_over_jkr"]) for row in rows[:-1]]
    jkr = float(rows[-1]["sticking_velocity_over_jkr"])
    exact = {mu: math.sqrt(float(row["hysteresis_over_jkr"])) for mu, row in reference().items()}
    ends = [0.1, 10.0]
    fine = np.geomspace(*ends, 200)
    model = np.array([math.sqrt(hysteresis_ratio(float(mu))) for mu in fine])
    write_image(
        "cohesive-sticking",
        Figure(
            "Sticking velocity of smooth elastic spheres",
            (
                Chart(
                    Axis("Tabor parameter µ", scale="log"),
                    Axis("sticking velocity / JKR", low=0.0, high=1.1),
                    (
                        Line(np.array(ends), np.array([jkr, jkr]), "adhesion = jkr", color=ORANGE),
                        Points(
                            np.array(list(exact)),
                            np.array(list(exact.values())),
                            "axisymmetric reference",
                            color=GREY,
                            symbol="square",
                        ),
                        Points(np.array(tabor), np.array(found), "adhesion = cohesive"),
                        Line(fine, model, "used for model_error", color=GREY, dash=DASHED),
                    ),
                ),
            ),
        ),
    )


def joined():
    """COR at equal velocities with the models "cohesive" and "jkr", and the error of "jkr"."""
    rows = []
    for tabor in (1.0, 2.0):
        pair = pair_of(tabor)
        jkr = JKR(pair.radius, E_STAR, W)
        V_s, length = float(jkr.sticking_velocity(pair.mass)), float(jkr.adhesive_length)
        h = float(jkr.pull_off_radius) / 5
        for times in (4.5, 7.0):
            depth = times * length
            n = 2 * int(math.sqrt(3 * depth * pair.radius) / h + 4)
            contact = Contact(
                pair, smooth(Grid(n, h)), adhesion=JKRLimit(W, equilibrium_separation=Z0)
            )
            state = solve(contact, depth)
            collision = collide(state)
            V = collision.impact_velocity
            if V is None:  # adhesion did more work than the approach
                continue
            fine = sphere(tabor, depth / Z0 + 2)
            cohesive = collide(solve_at_velocity(fine, V))
            rows.append(
                {
                    "tabor_parameter": tabor,
                    "velocity_over_sticking_velocity": round(V / V_s, 4),
                    "cohesive": round(cohesive.restitution, 4),
                    "cohesive_error": round(cohesive.restitution_error, 4),
                    "jkr": round(collision.restitution, 4),
                    "jkr_error": round(collision.restitution_error, 4),
                    "jkr_model_error": round(model_error(state, collision.restitution), 4),
                }
            )
            print(rows[-1], flush=True)
    write_table("cohesive/cohesive_joined.csv", rows)


MATERIALS = {
    "steel": (Body(50e-6, 210e9, 0.25, 7850.0), 1.5e9),
    "glass": (Body(50e-6, 70e9, 0.2, 2500.0), math.inf),
}


def rough():
    """Compare the models "cohesive" and "jkr" on three surfaces of two materials."""
    rows = []
    grid = Grid(64, 26e-9)
    for material, (body, p_y) in MATERIALS.items():
        for rms in (0.2e-9, 0.6e-9, 2e-9):
            surface = generate_surface(
                grid, kind="gaussian", rms=rms, correlation_length=0.25e-6, seed=7
            )
            # The cells are 0.4 times the cohesive zone of glass; a case permits 0.3.
            surface = Surface(surface.height, grid, {**surface.provenance, COMPANION: 1.0})
            base = Contact(
                Pair(body, body), surface, plasticity=ConstantBound(p_y), adhesion=JKRLimit(W)
            )
            for depth in (2e-9, 6e-9):
                row = {"material": material, "rms_nm": 1e9 * rms, "indentation_nm": 1e9 * depth}
                for mode, adhesion in (("cohesive", Cohesive(W)), ("jkr", JKRLimit(W))):
                    contact = replace(base, adhesion=adhesion)
                    try:
                        state = solve(contact, depth)
                        collision = collide(state)
                    except RestitutionError as error:
                        print(mode, error, flush=True)
                        continue
                    row |= {
                        f"{mode}_restitution": round(collision.restitution, 4),
                        f"{mode}_error": round(collision.restitution_error, 4),
                        f"{mode}_pull_off_uN": round(1e6 * collision.pull_off_force, 4),
                        f"{mode}_loading_work_fJ": round(1e15 * collision.loading_work, 4),
                        f"{mode}_unloading_work_fJ": round(1e15 * collision.unloading_work, 4),
                    }
                    if mode == "jkr":
                        error = model_error(state, collision.restitution)
                        row["jkr_model_error"] = round(error, 4)
                rows.append(row)
                print(row, flush=True)
    write_table("cohesive/cohesive_rough.csv", rows)


def balance():
    """Compare the work of the force with the change of the energies, in 200 random contacts."""
    rng = np.random.default_rng(11)
    rows = []
    for number in range(200):
        tabor, depth = float(rng.uniform(0.2, 1.1)), float(rng.uniform(0.5, 3.0))
        bound = plasticity_of(yield_pressure=float(rng.choice([np.inf, 1e9, 2e8])))
        contact = sphere(tabor, depth, plasticity=bound)
        grid = contact.grid
        height = np.zeros(grid.nodes)
        for _ in range(8):
            q = 2 * np.pi * rng.integers(-4, 5, 2) / grid.size[0]
            wave = q[0] * grid.x[:, None] + q[1] * grid.y + rng.uniform(0, 6.3)
            height += np.cos(wave)
        rms = float(rng.choice([0.0, 0.1, 0.3, 1.0])) * Z0
        surface = Surface(rms * height / height.std() + contact.surface.height, grid)
        contact = replace(contact, surface=surface)
        state = solve(contact, depth * Z0)
        path = list(unloading_path(state))
        found = contact.adhesion.separation_of(path)
        depths, forces = ([getattr(s, key) for s in path] for key in ("indentation", "force"))
        by_force = -integrate_curve(depths, forces) + path[-1].potential_energy
        rows.append(
            {
                "case": number,
                "tabor_parameter": round(tabor, 3),
                "depth_over_z0": round(depth, 3),
                "rms_over_z0": round(rms / Z0, 2),
                "yield_pressure_GPa": contact.hardness / 1e9,
                "stored_energy_J": f"{state.stored_energy:.5e}",
                "interaction_energy_J": f"{state.interaction_energy:.5e}",
                "loading_work_J": f"{state.loading_work:.5e}",
                "plastic_work_J": f"{path[-1].plastic_work:.5e}",
                "adhesive_loss_J": f"{path[-1].adhesive_loss:.5e}",
                "jumps": path[-1].jumps,
                "unloading_work_J": f"{found.unloading_work:.5e}",
                "by_force_J": f"{by_force:.5e}",
                "error_J": f"{found.error:.5e}",
            }
        )
        if number % 20 == 19:
            print(number + 1, flush=True)
            write_table("cohesive/cohesive_balance.csv", rows)
    write_table("cohesive/cohesive_balance.csv", rows)
    off = [abs(float(r["by_force_J"]) - float(r["unloading_work_J"])) for r in rows]
    within = [o <= float(r["error_J"]) for o, r in zip(off, rows, strict=True)]
    above = [
        r
        for r in rows
        if float(r["unloading_work_J"])
        > float(r["stored_energy_J"]) + max(float(r["interaction_energy_J"]), 0.0)
    ]
    print(f"within the error: {sum(within)} of {len(rows)}; W_u > E_el in {len(above)}")


if __name__ == "__main__":
    for name in sys.argv[1:]:
        {each.__name__: each for each in (grids, sticking, figure, joined, rough, balance)}[name]()
