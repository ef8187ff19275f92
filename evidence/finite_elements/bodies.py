"""Compute impacts in which a sphere or a flat yields, and write data/bodies.csv.

    python bodies.py               # own code, all runs that are missing
    python bodies.py --calculix    # CalculiX, all impacts that are missing

Lengths are in units of the radius, forces in units of E* R², works in units of E* R³.
"""

from __future__ import annotations

import argparse
import csv
import tempfile
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

TABLE = Path(__file__).parent / "data" / "bodies.csv"
_R, _E, _NU = 500e-6, 210e9, 0.3
_KINEMATICS = {
    ("sphere", "small"): "hemisphere",
    ("sphere", "finite"): "finite-hemisphere",
    ("flat", "small"): "small",
    ("flat", "finite"): "finite",
}


@dataclass(frozen=True)
class Row:
    """One impact: what was computed, how, and its result.

    Args:
        code: "own" or "calculix".
        body: body that yields: "sphere" or "flat".
        strains: "small" or "finite".
        strength: yield strength over the contact modulus of the pair.
        omega: indentation over that of first yield.
        elements: elements over the contact radius at the largest depth of the mesh.
        use: "chosen" if a constant of `model_error` was chosen on it, "blind" or "check".
        contact_radius: contact radius over the radius; nan if not recorded.
        force: force over E* R².
        loading_work: work of loading over E* R³.
        unloading_work: work of unloading over E* R³.
        restitution: coefficient of restitution.
    """

    code: str
    body: str
    strains: str
    strength: float
    omega: float
    elements: float
    use: str
    contact_radius: float
    force: float
    loading_work: float
    unloading_work: float
    restitution: float


@dataclass(frozen=True)
class Run:
    """One mesh of the own code, and the depths from which it unloads."""

    body: str
    strains: str
    strength: float
    omegas: tuple[float, ...]
    elements: float
    use: str


RUNS = (
    Run("sphere", "small", 0.00108, (16, 32, 64), 50, "check"),
    Run("sphere", "small", 0.00108, (64, 128), 36, "check"),
    Run("sphere", "small", 0.00108, (256, 512, 1024), 50, "check"),
    Run("sphere", "small", 0.00433333, (16, 32, 64), 50, "check"),
    Run("sphere", "finite", 0.003, (256, 512), 100, "check"),
    Run("sphere", "small", 0.00108, (64, 128), 72, "check"),
    Run("sphere", "finite", 0.0005, (512, 1024), 72, "check"),
    Run("flat", "small", 0.001, (512, 1024), 36, "check"),
    Run("sphere", "finite", 0.00108, (16, 32, 64, 128), 36, "chosen"),
    Run("sphere", "finite", 0.00108, (256, 512, 1024), 50, "chosen"),
    Run("sphere", "finite", 0.003, (16, 32, 64, 128), 36, "chosen"),
    Run("sphere", "finite", 0.003, (256, 512, 1024), 50, "chosen"),
    Run("sphere", "finite", 0.02, (2, 4, 8, 16, 32), 30, "chosen"),
    Run("flat", "finite", 0.003, (256, 512), 30, "chosen"),
    Run("flat", "finite", 0.003, (1024,), 25, "blind"),
    Run("flat", "finite", 0.00108, (512, 1024), 72, "blind"),
    Run("flat", "finite", 0.02, (8, 16, 32), 30, "blind"),
    Run("sphere", "finite", 0.0005, (64, 128), 36, "blind"),
    Run("sphere", "finite", 0.0005, (256, 512, 1024), 36, "blind"),
    Run("sphere", "finite", 0.0018, (128, 256, 512), 36, "blind"),
)
# Body, strength, ω and finite strains of the impacts that CalculiX computes.
IMPACTS = (("sphere", 0.003, 256, True), ("flat", 0.003, 256, True))


def own(run: Run) -> list[Row]:
    """Solve one mesh with the own code."""
    from problem import Model, smooth_mesh
    from solve import run_range
    from works import loading_work, unloading_work

    modulus = _E / (1 - _NU**2)
    model = Model(_E, _NU, run.strength * modulus, radius=_R)
    spec = smooth_mesh(model, max(run.omegas), run.elements)
    if run.body == "sphere":
        spec = replace(spec, domain=_R, grading_far=1.15)
    low, start = 0.6 * min(run.omegas), min(run.omegas) / 30
    kinematics = _KINEMATICS[run.body, run.strains]
    result = run_range(model, spec, run.omegas, low, start, 0.1, 0.05, kinematics=kinematics)
    depth, force, area = (
        np.array(result["loading"][k]) for k in ("indentation_m", "force_N", "contact_area_m2")
    )
    work = loading_work(depth, force)
    rows = []
    for path in result["unloading"]:
        k = int(np.argmin(abs(np.array(result["omega"]) - path["omega"])))
        back = unloading_work(path["indentation_m"], path["force_N"])
        rows.append(
            Row(
                *("own", run.body, run.strains, run.strength, path["omega"], run.elements, run.use),
                float(np.sqrt(area[k] / np.pi) / _R),
                float(force[k] / (modulus * _R**2)),
                float(work[k] / (modulus * _R**3)),
                float(back / (modulus * _R**3)),
                float(np.sqrt(back / work[k])),
            )
        )
    return rows


def by_calculix(body: str, strength: float, omega: float, finite: bool) -> Row:
    """Solve one impact with CalculiX."""
    from calculix import Impact, solve, works

    impact = Impact(body, strength, omega, finite)
    with tempfile.TemporaryDirectory() as folder:
        curve = solve(impact, Path(folder), "impact")
    force, loading, unloading = works(curve)
    return Row(
        *("calculix", body, "finite" if finite else "small", strength, omega, impact.elements),
        *("check", float("nan")),
        *(force, loading, unloading),
        float(np.sqrt(unloading / loading)),
    )


def read() -> list[Row]:
    """Read the stored rows."""
    if not TABLE.exists():
        return []
    texts = ("code", "body", "strains", "use")
    with open(TABLE, newline="", encoding="utf-8") as file:
        return [
            Row(**{k: v if k in texts else float(v) for k, v in row.items()})
            for row in csv.DictReader(file)
        ]


def write(rows: list[Row]) -> None:
    """Write all rows with six digits, in order."""
    rows = sorted(rows, key=lambda r: (r.code, r.body, r.strains, r.strength, r.omega, r.elements))
    with open(TABLE, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(asdict(rows[0])), lineterminator="\n")
        table.writeheader()
        for row in rows:
            values = asdict(row).items()
            table.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in values})


def main() -> None:
    """Compute the missing rows of one code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--calculix", action="store_true", help="the impacts of CalculiX")
    rows = read()
    if parser.parse_args().calculix:
        others = [r for r in rows if r.code == "calculix"]
        known = {(r.body, r.strength, r.omega, r.strains == "finite") for r in others}
        for impact in IMPACTS:
            if impact not in known:
                rows.append(by_calculix(*impact))
                write(rows)
        return
    done = {(r.body, r.strains, r.strength, r.omega, r.elements) for r in rows if r.code == "own"}
    for run in RUNS:
        if (run.body, run.strains, run.strength, run.omegas[-1], run.elements) not in done:
            rows += own(run)
            write(rows)


if __name__ == "__main__":
    main()
