"""Largest fall of the force in a step of 4 % of the depth, of the contacts of random_cases.csv.

Appends one row for each case to monotone.csv; a second call resumes.
"""

import csv
import sys
from pathlib import Path

import numpy as np
from random_cases import DEPTHS, TABLE, contact, resolved

import restitution as rs

OWN = Path(__file__).with_name("monotone.csv")


def row(case):
    bodies, _ = contact(np.random.default_rng(int(case["seed"])), 1e-6 * float(case["h_um"]))
    depths = 1e-9 * float(case["depth_nm"]) * np.geomspace(0.1, 1, DEPTHS)
    states = [rs.solve(bodies, float(depth)) for depth in depths]
    force = np.array([state.force for state in states])
    step = np.diff(force) / np.maximum(force[:-1], 1e-300)
    good = np.array([resolved(state) for state in states[1:]], dtype=bool)
    return {
        "seed": case["seed"],
        "resolved_steps": int(good.sum()),
        "least_resolved": f"{step[good].min(initial=1.0):.3g}",
        "least_unresolved": f"{step[~good].min(initial=1.0):.3g}",
    }


def main():
    known = sum(1 for _ in OWN.open()) - 1 if OWN.exists() else 0
    for case in list(csv.DictReader(TABLE.open()))[known : int(sys.argv[1])]:
        values = row(case)
        new = not OWN.exists()
        with OWN.open("a", newline="") as file:
            writer = csv.DictWriter(file, values, lineterminator="\n")
            if new:
                writer.writeheader()
            writer.writerow(values)


main()
