r"""Adhesive impacts: waves below the grid by patches, beside direct solves that resolve them.

    python -m evidence.two_scales.adhesion

writes adhesion.csv, a row for each of 12 random surfaces of two materials. Both solves load to the
same work, that of smooth elastic bodies at a random depth.
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
from restitution.collision import collide
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.patch.law import PatchAttraction
from restitution.numerics.grid import Grid
from restitution.numerics.intervals import half_interval
from restitution.surfaces import Surface, generate_surface
from restitution.surfaces.refine import coarsen
from restitution.surfaces.split import split
from restitution.theory import JKR

TABLE = Path(__file__).with_suffix(".csv")
CASES, NODES, COARSER, PER_WAVE = 12, 320, 8, 10
MATERIALS = {"silica": (72e9, 0.17, 2200.0, 0.05), "lactose": (8e9, 0.3, 1500.0, 0.08)}


def draw(seed: int) -> tuple[str, Contact, float]:
    rng = np.random.default_rng(seed)
    name = list(MATERIALS)[seed % 2]
    E, nu, rho, w = MATERIALS[name]
    shortest = rng.uniform(6e-9, 20e-9)
    rms = 10 ** rng.uniform(-10, -9.3 + 0.6 * (shortest > 12e-9))
    h = shortest / PER_WAVE
    grid = Grid((NODES, NODES), (h, h))
    rolloff = shortest * rng.uniform(1.5, 3.5)
    surface = generate_surface(
        grid, kind="self-affine", rms=rms, hurst=0.8, rolloff=rolloff, shortest=shortest, seed=seed
    )
    # The contact at the largest depth fills about half of the grid.
    radius = (0.2 * NODES * h) ** 2 / rng.uniform(1.0e-9, 3e-9)
    sphere = Body(radius, E, nu, rho)
    pair = Pair(sphere, Body(math.inf, E, nu))
    return name, Contact(pair, surface, adhesion=Cohesive(w)), rolloff


def impact(contact: Contact, work: float, depth: float) -> tuple[float, float, float]:
    """Pull-off force (N), lost energy (J) and COR after loading to `work` (J) near `depth` (m)."""
    state = None
    for _ in range(12):
        new = solve(contact, depth, start=state)
        if new.loading_work >= work:
            break
        state, depth = new, depth * 1.15
    collision = collide(new)
    lost = collision.loading_work - collision.unloading_work
    return collision.pull_off_force, lost, math.sqrt(max(1 - lost / work, 0.0))


def row_of(seed: int) -> dict[str, object]:
    name, direct, rolloff = draw(seed)
    pair, h = direct.pair, direct.grid.spacing[0]
    depth = (0.2 * NODES * h) ** 2 / pair.radius
    began = time.process_time()
    state = solve(direct, depth)
    collision = collide(state)
    work = max(collision.loading_work, 1e-25)
    lost = collision.loading_work - collision.unloading_work
    exact = collision.pull_off_force, lost, math.sqrt(max(1 - lost / work, 0.0))
    middle = time.process_time()
    wavelength = 4 * COARSER * h
    nodes = min(NODES // 2, 4 * round(wavelength / h))
    long, patches = split(direct.surface, wavelength, nodes)
    surface = Surface(coarsen(long, COARSER).height, coarsen(long, COARSER).grid)
    law = PatchAttraction(patches, wavelength, direct.adhesion)
    coarse = replace(direct, surface=surface, adhesion=law)
    # The gap of a patch at equilibrium counts as touching, so the depth is smaller.
    start = max(depth - 3 * float(direct.surface.height.std()), 0.3 * depth)
    two = impact(coarse, work, start)
    end = time.process_time()
    each = np.array(
        [impact(replace(coarse, adhesion=replace(law, patches=(p,))), work, start) for p in patches]
    )
    smooth = JKR(pair.radius, pair.contact_modulus, direct.adhesion.work_of_adhesion)
    radius = math.sqrt(
        pair.radius * coarse.adhesion.length(pair) + 2 * pair.radius * coarse.adhesion.reach
    )
    edge = nodes * h
    factor = math.hypot(half_interval(len(patches)), edge / (math.sqrt(math.pi) * radius))
    error = each.std(axis=0, ddof=1) * factor
    longest = min(rolloff, wavelength)
    mass = pair.mass or math.nan
    sticks = [math.sqrt(2 * max(v, 0.0) / mass) for v in (exact[1], two[1], two[1] + error[1])]
    return {
        "case": seed,
        "material": name,
        "radius_um": f"{1e6 * pair.radius:.3g}",
        "rms_nm": f"{1e9 * direct.surface.height.std():.3g}",
        "shortest_nm": f"{1e9 * PER_WAVE * h:.3g}",
        "longest_in_patch_nm": f"{1e9 * longest:.3g}",
        "contact_radius_nm": f"{1e9 * radius:.3g}",
        "separate": bool(longest < radius / 3),
        "smooth_nN": f"{1e9 * smooth.pull_off_force:.4g}",
        "direct_nN": f"{1e9 * exact[0]:.4g}",
        "patch_nN": f"{1e9 * two[0]:.4g}",
        "error_nN": f"{1e9 * math.hypot(error[0], 0.02 * two[0]):.3g}",
        "direct_sticking_mm_s": f"{1e3 * sticks[0]:.3g}",
        "patch_sticking_mm_s": f"{1e3 * sticks[1]:.3g}",
        "error_sticking_mm_s": f"{1e3 * (sticks[2] - sticks[1]):.3g}",
        "direct_cor": f"{exact[2]:.4f}",
        "patch_cor": f"{two[2]:.4f}",
        "error_cor": f"{math.hypot(error[2], 0.002):.4f}",
        "direct_s": f"{middle - began:.1f}",
        "patch_s": f"{end - middle:.1f}",
    }


def main() -> None:
    rows = []
    for seed in range(int(sys.argv[1]) if len(sys.argv) > 1 else CASES):
        try:
            rows.append(row_of(seed))
        except Exception as error:
            print(seed, type(error).__name__, error, flush=True)
            continue
        print(*rows[-1].values(), flush=True)
        with open(TABLE, "w", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    off = [abs(float(r["patch_nN"]) / float(r["direct_nN"]) - 1) for r in rows]
    apart = [o for o, r in zip(off, rows, strict=True) if r["separate"]]
    print(
        "median error of the pull-off:", np.median(off), "where scales separate:", np.median(apart)
    )


if __name__ == "__main__":
    main()
