r"""Adhesive impacts: waves below the grid by patches, beside direct solves that resolve them.

    python -m evidence.two_scales.adhesion

writes adhesion.csv, a row for each of 12 random surfaces of two materials, and of 20 of silica.
Both solves load to the same work, that of smooth elastic bodies at a random depth.
"""

from __future__ import annotations

import csv
import math
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from restitution import Body, Pair
from restitution.collision import Collision, collide
from restitution.contact.checks.edge import EdgeReachedError
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.models import COMPANION
from restitution.contact.patch.law import PatchAttraction
from restitution.contact.state import Array
from restitution.errors import CaseError, RestitutionError
from restitution.numerics.grid import Grid
from restitution.numerics.intervals import half_interval
from restitution.runs.loss_errors import carried
from restitution.surfaces import Surface, generate_surface
from restitution.surfaces.refine import coarsen
from restitution.surfaces.split import split
from restitution.theory import JKR

TABLE = Path(__file__).with_suffix(".csv")
CASES = (*range(12), *range(12, 52, 2))  # odd ones, of lactose, can take more than 20 minutes
NODES = 320
# The grid grows until the contact stays inside, and its cells shrink until twice as large ones
# resolve the law of the patches.
WIDER, WIDEST, FINER, FINEST = 1.25, 2.0, 0.9, 0.7
PER_WAVE, RESOLVED = 10, 0.29  # direct cells in the shortest wave, and in the cohesive zone
PATCH = 256  # direct cells along its edge
# Cells of the contact in those of the direct solve, and cells of the contact in the split.
FACTORS, CELLS = (8, 4, 2), 4
SURFACES = 8
MATERIALS = {"silica": (72e9, 0.17, 2200.0, 0.05), "lactose": (8e9, 0.3, 1500.0, 0.08)}


def draw(seed: int, wider: float, finer: float) -> tuple[str, Contact, float, float]:
    """Material, contact on cells that resolve it, longest and shortest wave (m).

    The edge of the grid is `wider` times as long as usual, and a cell `finer` times.
    """
    rng = np.random.default_rng(seed)
    name = list(MATERIALS)[seed % 2]
    E, nu, rho, w = MATERIALS[name]
    shortest = rng.uniform(6e-9, 20e-9)
    rms = 10 ** rng.uniform(-10, -9.3 + 0.6 * (shortest > 12e-9))
    law, flat = Cohesive(w), Body(math.inf, E, nu)
    h = min(shortest / PER_WAVE, RESOLVED * law.zone_length(Pair(flat, flat)))
    nodes = 8 * round(wider / finer * NODES / 8)
    grid = Grid((nodes, nodes), (finer * h, finer * h))
    rolloff = shortest * rng.uniform(1.5, 3.5)
    surface = generate_surface(
        grid, kind="self-affine", rms=rms, hurst=0.8, rolloff=rolloff, shortest=shortest, seed=seed
    )
    # The contact at the largest depth fills about half of the grid.
    radius = (0.2 * NODES * h) ** 2 / rng.uniform(1.0e-9, 3e-9)
    pair = Pair(Body(radius, E, nu, rho), flat)
    return name, Contact(pair, surface, adhesion=law), rolloff, shortest


def impact(contact: Contact, work: float, depth: float) -> Collision:
    """Load to `work` (J) near `depth` (m), and unload."""
    state = None
    for _ in range(12):
        new = solve(contact, depth, start=state)
        if new.loading_work >= work:
            break
        state, depth = new, depth * 1.15
    return collide(new)


def outcome(collision: Collision, work: float) -> Array:
    """Pull-off force (N), lost energy (J) and COR."""
    lost = collision.loading_work - collision.unloading_work
    return np.array([collision.pull_off_force, lost, math.sqrt(max(1 - lost / work, 0.0))])


def two_scales(direct: Contact, factor: int) -> Contact:
    """`direct` on cells `factor` times as large, with its waves below four cells in patches."""
    h = direct.grid.spacing[0]
    wavelength = CELLS * factor * h
    # A single patch around the contact: the edges of four would meet in its middle.
    long, patches = split(direct.surface, wavelength, PATCH, tiles=1)
    long = coarsen(long, factor)
    law = PatchAttraction(patches, wavelength, direct.adhesion)
    return replace(direct, surface=Surface(long.height, long.grid), adhesion=law)


def resolved(direct: Contact) -> tuple[Contact, int]:
    """The largest cells on which the law of the patches is resolved, as the program requires."""
    for factor in FACTORS:
        contact = two_scales(direct, factor)
        if contact.adhesion.resolves_range(contact):
            break
    return contact, factor


def error_of(
    contact: Contact, coarser: Contact, own: Collision, work: float, depth: float
) -> Array:
    """Error as that of a run: steps, larger cells, other surfaces, single patches, and sticking."""
    law, here = contact.adhesion, outcome(own, work)
    alone = [replace(law, patches=(patch,)) for patch in law.patches]
    others = [replace(law, place=place) for place in range(1, SURFACES)]
    values = [
        [outcome(impact(replace(contact, adhesion=other), work, depth), work) for other in laws]
        for laws in (alone, others)
    ]
    single, other = np.array(values[0]), np.array([here, *values[1]])
    steps = math.hypot(own.loading_work_error, own.unloading_work_error)
    pull_off = law.lost_in_jumps / law.work_of_adhesion * here[0]
    parts = [np.array([pull_off, steps, 0.0]), here - outcome(impact(coarser, work, depth), work)]
    if len(single) > 1:
        parts.append(half_interval(len(single)) * single.std(axis=0, ddof=1))
    half = half_interval(len(other)) * other.std(axis=0, ddof=1)
    parts.append(np.abs(here - other.mean(axis=0)) + half)
    error = np.sqrt(sum(part**2 for part in parts))
    ratio, change = 1 - here[1] / work, error[1] / work
    error[2] = max(error[2], carried(np.array([ratio]), np.array([change]))[0])
    return error


def row_of(seed: int) -> dict[str, object]:
    wider = finer = 1.0
    while True:
        try:
            return row_on(seed, wider, finer)
        except EdgeReachedError as error:
            if (wider := wider * WIDER) > WIDEST:
                raise
            print(seed, error, flush=True)
        except CaseError as error:
            if (finer := finer * FINER) < FINEST:
                raise
            print(seed, error, flush=True)


def row_on(seed: int, wider: float, finer: float) -> dict[str, object]:
    name, direct, rolloff, shortest = draw(seed, wider, finer)
    pair, h = direct.pair, direct.grid.spacing[0]
    depth = (0.2 * NODES * h / finer) ** 2 / pair.radius
    began = time.process_time()
    collision = collide(solve(direct, depth))
    work = max(collision.loading_work, 1e-25)
    # An attraction may still do work at this depth: then the bodies go on to a work of nearly 0.
    if collision.loading_work <= 0:
        collision = impact(direct, work, depth)
    exact = outcome(collision, work)
    middle = time.process_time()
    coarse, factor = resolved(direct)
    # The gap of a patch at equilibrium counts as touching, so the depth is smaller.
    start = max(depth - 3 * float(direct.surface.height.std()), 0.3 * depth)
    own = impact(coarse, work, start)
    two = outcome(own, work)
    end = time.process_time()
    coarser = two_scales(direct, 2 * factor)
    coarser = replace(coarser, surface=replace(coarser.surface, provenance={COMPANION: True}))
    error = error_of(coarse, coarser, own, work, start)
    law = coarse.adhesion
    smooth = JKR(pair.radius, pair.contact_modulus, direct.adhesion.work_of_adhesion)
    radius = math.sqrt(pair.radius * law.length(pair) + 2 * pair.radius * law.reach)
    longest = min(rolloff, law.wavelength)
    mass = pair.mass or math.nan
    losses = exact[1], two[1], two[1] + error[1], two[1] - error[1]
    sticks = [math.sqrt(2 * max(lost, 0.0) / mass) for lost in losses]
    return {
        "case": seed,
        "material": name,
        "radius_um": f"{1e6 * pair.radius:.3g}",
        "rms_nm": f"{1e9 * direct.surface.height.std():.3g}",
        "shortest_nm": f"{1e9 * shortest:.3g}",
        "longest_in_patch_nm": f"{1e9 * longest:.3g}",
        "contact_radius_nm": f"{1e9 * radius:.3g}",
        "cell_nm": f"{1e9 * factor * h:.3g}",
        "separate": bool(longest < radius / 3),
        "smooth_nN": f"{1e9 * smooth.pull_off_force:.4g}",
        "direct_nN": f"{1e9 * exact[0]:.4g}",
        "patch_nN": f"{1e9 * two[0]:.4g}",
        "error_nN": f"{1e9 * error[0]:.3g}",
        "direct_sticking_mm_s": f"{1e3 * sticks[0]:.3g}",
        "patch_sticking_mm_s": f"{1e3 * sticks[1]:.3g}",
        "error_sticking_mm_s": f"{1e3 * max(sticks[2] - sticks[1], sticks[1] - sticks[3]):.3g}",
        "direct_cor": f"{exact[2]:.4f}",
        "patch_cor": f"{two[2]:.4f}",
        "error_cor": f"{error[2]:.4f}",
        "direct_s": f"{middle - began:.1f}",
        "patch_s": f"{end - middle:.1f}",
        "error_s": f"{time.process_time() - end:.1f}",
    }


def main() -> None:
    """Append the cases that the table lacks, or print those with the given seeds."""
    if seeds := [int(seed) for seed in sys.argv[1:]]:
        for seed in seeds:
            print(*row_of(seed).values(), flush=True)
        return
    rows = list(csv.DictReader(TABLE.read_text().splitlines())) if TABLE.exists() else []
    for seed in sorted(set(CASES) - {int(row["case"]) for row in rows}):
        try:
            rows.append({key: str(value) for key, value in row_of(seed).items()})
        except RestitutionError as error:
            print(seed, error, flush=True)
            continue
        print(*rows[-1].values(), flush=True)
        with open(TABLE, "w", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    off = np.array([abs(float(r["patch_nN"]) / float(r["direct_nN"]) - 1) for r in rows])
    apart = np.array([r["separate"] == "True" for r in rows])
    print(f"pull-off: median error {np.median(off):.3f}, where scales separate", end=" ")
    print(f"{np.median(off[apart]):.3f} ({apart.sum()} cases)")
    for unit in ("nN", "sticking_mm_s", "cor"):
        names = [f"{kind}_{unit}" for kind in ("direct", "patch", "error")]
        within = [abs(float(r[names[0]]) - float(r[names[1]])) <= float(r[names[2]]) for r in rows]
        print(f"{unit}: within the error in {sum(within)} of {len(rows)}")


if __name__ == "__main__":
    main()
