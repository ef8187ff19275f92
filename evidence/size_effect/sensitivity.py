"""d ln COR/d ln hardness at equal loading work, of random contacts with a size effect."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from random_cases import LENGTHS, contact, resolved

import restitution as rs
from restitution.errors import DomainError

TABLE = Path(__file__).with_name("sensitivity.csv")
FACTOR, CASES = 0.85, 24


def rows():
    count = seed = 0
    while count < CASES:
        case, depth = contact(np.random.default_rng(seed), LENGTHS[seed % 3 + 1])
        depths = depth * np.geomspace(0.25, 0.9, 5)
        softer = replace(case, plasticity=case.plasticity.scaled(FACTOR))
        seed += 1
        try:
            if not resolved(rs.solve(case, 0.4 * depth)):
                continue
            own, other = (
                [rs.collide(rs.solve(one, float(d))) for d in depths] for one in (case, softer)
            )
        except DomainError:
            continue
        count += 1
        work = np.log([impact.loading_work for impact in other])
        e = [impact.restitution for impact in other]
        for impact in own[1:4]:
            at = math.log(impact.loading_work)
            if work[0] < at < work[-1]:
                change = math.log(float(np.interp(at, work, e)) / impact.restitution)
                yield {
                    "seed": seed - 1,
                    "model": type(case.plasticity).__name__,
                    "restitution": f"{impact.restitution:.4f}",
                    "sensitivity": f"{abs(change / math.log(FACTOR)):.3f}",
                }


def main():
    with TABLE.open("w", newline="") as file:
        writer = csv.DictWriter(
            file, ("seed", "model", "restitution", "sensitivity"), lineterminator="\n"
        )
        writer.writeheader()
        writer.writerows(rows())


main()
