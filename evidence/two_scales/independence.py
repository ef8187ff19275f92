r"""Does COR depend on the split, the edge of the patches or the cells of the grid?

    python -m evidence.two_scales.independence

writes independence.csv: steel against steel, one surface with waves from 0.4 um and a roll-off at
3 um, all of which the direct solve carries. The error consists of the scatter between patches, of
waves that are not short beside the contact, and of the change of COR from the next split
(docs/two-scales.md).
"""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from restitution import Body, ConstantBound, Pair
from restitution.collision import collide
from restitution.contact.contact import Contact
from restitution.contact.patch.law import PatchRepulsion
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.numerics.grid import Grid
from restitution.numerics.intervals import half_interval
from restitution.surfaces import Surface, generate_surface
from restitution.surfaces.refine import coarsen
from restitution.surfaces.split import split

TABLE = Path(__file__).with_suffix(".csv")
NODES, CELL = 480, 0.1e-6
VELOCITIES = (0.05, 0.15, 0.4)
BODY = Body(500e-6, 231e9, 0.3, 7800.0)
PAIR = Pair(BODY, replace(BODY, radius=math.inf))


def cor(contact: Contact) -> np.ndarray:
    return np.array([collide(solve_at_velocity(contact, v)).restitution for v in VELOCITIES])


def main() -> None:
    grid = Grid((NODES, NODES), (CELL, CELL))
    waves = {"hurst": 0.8, "rolloff": 3e-6, "shortest": 0.4e-6}
    surface = generate_surface(grid, kind="self-affine", rms=60e-9, seed=7, **waves)
    direct = Contact(PAIR, surface, ConstantBound(3e9))
    rows = [{"way": "direct", **row(cor(direct))}]
    rows.append({"way": "left out on 0.4 um cells", **row(cor(coarse_of(surface, 4, None)))})
    print(rows, flush=True)
    for times in (4, 2):  # cells of the grid, in cells of the direct solve
        for cells in (4, 8, 16):
            for edges in (4, 2):
                wavelength = cells * 0.2e-6
                if wavelength < 2 * times * CELL:
                    continue
                nodes = round(edges * wavelength / CELL)
                long, patches = split(surface, wavelength, nodes, tiles=min(3, NODES // nodes))
                law = PatchRepulsion(patches, wavelength)
                contact = coarse_of(long, times, law)
                own = cor(contact)
                each = [cor(replace(contact, adhesion=replace(law, patches=(p,)))) for p in patches]
                area = contact_area(contact)
                factor = np.hypot(half_interval(len(patches)), nodes * CELL / np.sqrt(area))
                scatter = np.std(each, axis=0, ddof=1) * factor
                without = cor(replace(contact, adhesion=None))
                a = np.sqrt(real_area(contact) / math.pi)
                error = np.hypot(scatter, 0.25 * wavelength / a * np.abs(own - without))
                rows.append(
                    {
                        "way": f"{times * CELL * 1e6:.1f} um cells",
                        "split_um": f"{1e6 * wavelength:.1f}",
                        "patch_um": f"{1e6 * nodes * CELL:.1f}",
                        "patches": len(patches),
                        **row(own),
                        **{
                            f"error_{v:g}": f"{e:.4f}"
                            for v, e in zip(VELOCITIES, error, strict=True)
                        },
                    }
                )
                print(*rows[-1].values(), flush=True)
    add_changes(rows)
    with open(TABLE, "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[-1]), lineterminator="\n", restval="")
        writer.writeheader()
        writer.writerows(rows)


def add_changes(rows: list[dict[str, str]]) -> None:
    """Add the change of COR from the next longer split, or from the shorter one if none is."""
    split = [one for one in rows if one.get("split_um")]
    for one in split:
        wavelength, edges = float(one["split_um"]), float(one["patch_um"]) / float(one["split_um"])
        beside = {
            float(other["split_um"]): other
            for other in split
            if other["way"] == one["way"]
            and abs(float(other["patch_um"]) / float(other["split_um"]) - edges) < 0.1
        }
        other = beside.get(2 * wavelength) or beside.get(0.5 * wavelength)
        for v in VELOCITIES if other else ():
            change = float(other[f"cor_{v:g}"]) - float(one[f"cor_{v:g}"])
            one[f"error_{v:g}"] = f"{math.hypot(float(one[f'error_{v:g}']), change):.4f}"


def row(values: np.ndarray) -> dict[str, str]:
    return {f"cor_{v:g}": f"{e:.4f}" for v, e in zip(VELOCITIES, values, strict=True)}


def coarse_of(surface: Surface, times: int, law: PatchRepulsion | None) -> Contact:
    made = coarsen(surface, times)
    return Contact(PAIR, Surface(made.height, made.grid), ConstantBound(3e9), law)


def real_area(contact: Contact) -> np.ndarray:
    return np.array([solve_at_velocity(contact, v).contact_area for v in VELOCITIES])


def contact_area(contact: Contact) -> np.ndarray:
    states = [solve_at_velocity(contact, v) for v in VELOCITIES]
    return np.array([s.contact_nodes for s in states]) * contact.grid.cell_area


if __name__ == "__main__":
    main()
