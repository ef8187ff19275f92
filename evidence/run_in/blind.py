"""Blind check: the stated error of COR at coverage 1 and 3, for random cases.

The reference has other places, four times as many of them, and cells half as large.
"""

import math
import sys
import warnings
from pathlib import Path

import numpy as np

from restitution import Body, Pair, run
from restitution.repeated.run_in import nominal_area

sys.path.insert(0, str(Path(__file__).parents[1]))
from shared import write_table

CASES, PLACES = 20, 12
COVERAGES = [1, 3]


def random_case(number: int) -> dict:
    random = np.random.default_rng(9000 + number)
    radius = 10 ** random.uniform(-4.3, -3)
    speed = 10 ** random.uniform(-1.7, -0.5)
    strength = 10 ** random.uniform(8.4, 9.1)
    ball = Body(radius, 210e9, 0.3, 7850)
    pair = Pair(ball, Body(math.inf, 210e9, 0.3) if random.random() < 0.5 else ball)
    area = nominal_area(pair, 2.8 * strength, speed)
    spacing = math.sqrt(area / math.pi) / random.uniform(10, 16)
    waves = {"kind": "gaussian", "correlation_length": f"{random.uniform(5, 10) * spacing} m"}
    if random.random() < 0.4:
        waves = {
            "kind": "self-affine",
            "hurst": float(random.uniform(0.5, 0.9)),
            "shortest": f"{random.uniform(5, 8) * spacing} m",
            "rolloff": f"{random.uniform(15, 30) * spacing} m",
        }
    key, value = "yield_pressure", 2.8 * strength
    if random.random() < 0.3:
        key, value = "yield_strength", strength
    steel = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
    first = {"radius": f"{radius} m", **steel}
    return {
        "first": first,
        "second": first if pair.second is ball else {"radius": "flat", **steel},
        "interface": {key: f"{value} Pa", "work_of_adhesion": "0 J/m^2"},
        "roughness": {**waves, "rms": f"{random.uniform(0.1, 0.5) * spacing} m", "seed": number},
        "grid": {"nodes": 96, "spacing": f"{spacing} m"},
        "impact": {"velocity": f"{speed} m/s"},
        "impacts": {"coverage": COVERAGES, "places": PLACES, "seed": number},
    }


def reference_of(case: dict) -> dict:
    return {
        **case,
        "total_error": False,
        "grid": {**case["grid"], "refine": 2},
        "impacts": {
            **case["impacts"],
            "places": 4 * PLACES,
            "seed": case["impacts"]["seed"] + 5000,
        },
    }


def main() -> None:
    warnings.simplefilter("ignore")
    rows = []
    number, done = 0, 0
    while done < CASES:
        number += 1
        case = random_case(number)
        try:
            own, other = run(case).run_in, run(reference_of(case)).run_in
        except Exception as error:
            print(number, "left out:", error, flush=True)
            continue
        done += 1
        for one, reference in zip(own, other, strict=True):
            off = one.restitution - reference.restitution
            rows.append(
                {
                    "case": number,
                    "coverage": round(one.coverage),
                    "velocity_m_per_s": one.velocity,
                    "impacts": one.impacts,
                    "restitution": round(one.restitution, 4),
                    "reference": round(reference.restitution, 4),
                    "stated_error": round(one.total_error, 4),
                    "difference": round(off, 4),
                    "holds": abs(off) <= one.total_error,
                }
            )
            print(rows[-1], flush=True)
        write_table("run_in/blind.csv", rows)
    after = [row for row in rows if row["coverage"]]
    held = sum(row["holds"] for row in after)
    print(f"holds for {held} of {len(after)} values at coverage 1 and 3", flush=True)


if __name__ == "__main__":
    main()
