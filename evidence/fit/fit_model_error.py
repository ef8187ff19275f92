"""How far the error of a plasticity model moves a fitted yield strength or yield pressure.

`restitution fit` prints how a parameter changes if COR deviates by its full model error at every
velocity (P M in `fit.uncertainty`). Here the real deviations of COR from the finite-element
curves (`plasticity_models`) take the place of M, for each run of four or more neighbouring
depths of a curve. Of smooth bodies, COR at the loading work W depends on W/Y⁵ only; so
∂COR/∂ln Y = −5 ∂COR/∂ln W is used for all curves. The program prints, for each model, which share
of P M the real change is at most in 50 % and in 95 % of the runs.
"""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from restitution.case.models import plasticity_of
from restitution.contact.bodies import Body, Pair

MODELS = Path(__file__).parents[1] / "plasticity_models" / "models.csv"
FEWEST = 4  # smallest number of depths of a fit


def largest_difference(model, restitution, steepness):
    """Relative model error of a COR, at the steepness E* S/Y of the asperities (rms slope S)."""
    pair = Pair(Body(1e-3, 2e11, 0.3), Body(1e-3, 2e11, 0.3))
    strength = 1e-3 * pair.contact_modulus
    growing = model == "expanding-cavity"
    yields = {"yield_strength": strength} if growing else {"yield_pressure": 2.8 * strength}
    contact = SimpleNamespace(pair=pair, slope=steepness * strength / pair.contact_modulus)
    return plasticity_of(model, **yields).difference(contact, restitution)


def shares(model: str) -> list[float]:
    """The change of ln Y in each run of depths, as a share of the change by the full error."""
    curves = defaultdict(list)
    with open(MODELS, newline="") as file:
        for row in csv.DictReader(file):
            if row["model"] == model:
                curves[row["case"]].append(
                    [
                        float(row["loading_work_J_reference"]),
                        float(row["restitution_reference"]),
                        float(row["restitution"]),
                        float(row["rms_slope"]) / float(row["yield_strength_over_contact_modulus"]),
                    ]
                )
    found = []
    for curve in curves.values():
        work, true, e, steepness = np.array(sorted(curve)).T
        if e.size < FEWEST:
            continue
        error = e * [largest_difference(model, *pair) for pair in zip(e, steepness, strict=True)]
        slope = -5 * np.gradient(e, np.log(work))
        for first in range(e.size):
            for last in range(first + FEWEST, e.size + 1):
                J = slope[first:last]
                real, full = J @ (e - true)[first:last], np.abs(J) @ error[first:last]
                found.append(float(abs(real) / full))
    return found


if __name__ == "__main__":
    print("model,fits,median,share_95_percent")
    for name in ("equilibrium", "truncated", "expanding-cavity"):
        all_shares = shares(name)
        median, most = np.quantile(all_shares, [0.5, 0.95])
        print(f"{name},{len(all_shares)},{median:.2f},{most:.2f}")
