"""Does `restitution fit` find the parameters that made the data? Twenty cases with 2 % noise.

Each case is random: sizes, elasticity, model of plasticity, roughness and velocities. Its data are
means over 16 other surfaces of the same kind (other seeds), on cells half as large as those of the
fit, with 2 % of normal noise at each velocity. The fit starts from a yield strength or
pressure and an rms roughness that are wrong by a factor of up to 3 either way.

Writes fit_blind.csv beside this file: a row for each parameter. `--summary` reads it again. The
method was developed on the seeds from 1000 on and 1 to 20; the seeds of the table had not been used
before.
"""

from __future__ import annotations

import argparse
import csv
import math
import multiprocessing
import os
from pathlib import Path

import numpy as np

TABLE = Path(__file__).with_suffix(".csv")
NOISE, VELOCITIES, SURFACES = 0.02, 12, 16
MODELS = {"yield_strength": 1.0, "yield_pressure": 2.8}  # over the yield strength


def draw(seed: int) -> tuple[dict[str, float], str]:
    """The true values of the free keys, and the text of the case with places for them."""
    from restitution.theory import FirstYield

    rng = np.random.default_rng(seed)
    nodes = int(rng.choice([72, 96]))
    key = str(rng.choice(list(MODELS)))
    R, E, nu = 10 ** rng.uniform(-4.3, -2.8), 10 ** rng.uniform(9.5, 11.4), rng.uniform(0.2, 0.4)
    E_star, mass = E / (2 * (1 - nu**2)), 2500 * 4 / 3 * math.pi * R**3 / 2
    Y = E_star * 10 ** rng.uniform(-2.6, -1.7)
    smooth = FirstYield(R / 2, E_star, 1.6 * Y)
    fastest = float(smooth.velocity(mass)) * 10 ** rng.uniform(0.7, 1.7)
    slowest = fastest / 10 ** rng.uniform(1.0, 1.6)
    deepest = float(smooth.indentation) * (fastest / float(smooth.velocity(mass))) ** 0.9
    spacing = rng.uniform(5.0, 6.0) * math.sqrt(R / 2 * deepest) / nodes
    rms = deepest * 10 ** rng.uniform(-1.4, -0.6)
    kind = str(rng.choice(["gaussian", "exponential"]))
    length = spacing * rng.uniform(6, 12)
    shortest = "" if kind == "gaussian" else f'shortest = "{4 * spacing:.6g} m"\n'
    return {f"interface.{key}": MODELS[key] * Y, "roughness.rms": rms}, (
        f'[first]\nradius = "{R:.6g} m"\nyoungs_modulus = "{E:.6g} Pa"\n'
        f'poissons_ratio = {nu:.4f}\ndensity = "2500 kg/m^3"\n'
        f'[interface]\n{key} = "%.6g Pa"\n'
        f'[roughness]\nkind = "{kind}"\nrms = "%.6g m"\ncorrelation_length = "{length:.6g} m"\n'
        f"{shortest}seed = %d\n"
        f'[grid]\nnodes = {nodes}\nspacing = "{spacing:.6g} m"\nrefine = %d\n'
        f'[impact]\nfrom = "{slowest:.6g} m/s"\nto = "{fastest:.6g} m/s"\nsteps = {VELOCITIES}\n'
    )


def exact(text: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Impact velocities (m/s) and the mean COR of `SURFACES` surfaces from `seed` on."""
    from restitution import solve_at_velocity
    from restitution.case.case_file import parse_case
    from restitution.runs.companions import curve_of

    found = []
    for number in range(SURFACES):
        case = parse_case(text % (seed + number, 2))
        contact, V = case.contact(Path()), np.array(case.depths())
        if not found:
            ends = [solve_at_velocity(contact, v).indentation for v in (V[0], V[-1])]
            depths = np.geomspace(0.8 * ends[0], 1.1 * ends[1], 20)
        # `curve_of` adds depths beyond both ends.
        found.append(curve_of(contact, depths, "path").at(0.5 * contact.pair.mass * V**2))
    return V, np.mean(found, axis=0)


def compute(seed: int) -> list[dict[str, object]]:
    """The rows of one case."""
    os.environ.setdefault("DUCC0_NUM_THREADS", "1")
    from restitution.fit.findings import findings, identifiable
    from restitution.fit.fit import fit
    from restitution.fit.measured import Measured

    truth, text = draw(seed)
    rng = np.random.default_rng([seed, 1])
    values = tuple(truth.values())
    V, restitution = exact(text.replace("%.6g", "{:.6g}").format(*values), 10**6 + 1000 * seed)
    noise = NOISE * restitution
    noisy = np.clip(restitution + noise * rng.standard_normal(V.size), 0, 1)
    measured = Measured(V, noisy, noise)
    guesses = [value * 3 ** rng.uniform(-1, 1) for value in values]
    found = fit(text % (*guesses, 10**6 + 1000 * seed + 500, 1), Path(), measured, list(truth))
    rows: list[dict[str, object]] = []
    for k, (key, true) in enumerate(truth.items()):
        half, ratio = found.uncertainty.halves[k], guesses[k] / true * found.factors[k]
        rows.append(
            {
                "case": seed,
                "key": key,
                "true": float(f"{true:.6g}"),
                "first_guess": float(f"{guesses[k]:.6g}"),
                "fitted_over_true": round(ratio, 4),
                "interval_factor": round(math.exp(half), 4),
                "by_model_error": round(float(found.uncertainty.by_model[k]), 4),
                "identifiable": identifiable(found, k),
                "unique": not any("not unique" in sentence for sentence in findings(found)),
                "held": abs(math.log(ratio)) <= half,
                "resolved": int(found.resolved.sum()),
                "rms_residual": round(float((found.residuals**2).mean() ** 0.5), 5),
                "lowest_restitution": round(min(restitution), 4),
                "highest_restitution": round(max(restitution), 4),
            }
        )
    return rows


def summarise() -> None:
    """Print how many cases held."""
    with open(TABLE, newline="") as file:
        rows = list(csv.DictReader(file))
    cases = sorted({int(row["case"]) for row in rows})
    held = [all(r["held"] == "True" for r in rows if int(r["case"]) == case) for case in cases]
    known = [row for row in rows if row["identifiable"] == "True"]
    print(f"{sum(held)} of {len(cases)} cases: every parameter within its 95 % interval")
    print(f"{len(known)} of {len(rows)} parameters identifiable")
    for key in ("interface.yield", "roughness.rms"):
        of = [row for row in rows if row["key"].startswith(key)]
        off = np.median([abs(math.log(float(row["fitted_over_true"]))) for row in of])
        wide = np.median([float(row["interval_factor"]) for row in of])
        print(f"{key}…: median error {100 * math.expm1(off):.0f} %, interval factor {wide:.2f}")


def main() -> None:
    """Run the cases, or read their table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--summary", action="store_true")
    parser.add_argument("--first", type=int, default=21)
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--table", type=Path, default=TABLE)
    given = parser.parse_args()
    if not given.summary:
        seeds = range(given.first, given.first + given.cases)
        with (
            multiprocessing.get_context("spawn").Pool(given.workers) as pool,
            open(given.table, "w", newline="") as file,
        ):
            writer = None
            for rows in pool.imap(compute, seeds):
                if writer is None:
                    writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
                    writer.writeheader()
                writer.writerows(rows)
                file.flush()
    if given.table == TABLE:
        summarise()


if __name__ == "__main__":
    main()
