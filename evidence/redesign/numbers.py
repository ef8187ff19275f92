"""Print numbers of runs, studies, laws, exports and fits, with all digits.

`python evidence/redesign/numbers.py PYTHON` runs the cases below with the program that PYTHON has
installed, in a temporary folder, and prints one line "name;value" for each number.
"""

from __future__ import annotations

import csv
import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

STEEL = """
[first]
radius = "200 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
density = "7800 kg/m^3"
yield_strength = "500 MPa"
"""
ROUGH = """
[roughness]
kind = "self-affine"
rms = "50 nm"
hurst = 0.8
rolloff = "5 um"
shortest = "0.8 um"
seed = 3
"""
GRID = '[grid]\nnodes = {nodes}\nspacing = "{spacing}"\n'
IMPACT = '[impact]\nvelocity = ["20 mm/s", "0.1 m/s", "0.4 m/s"]\n'
SOFT = """
[first]
radius = "20 um"
youngs_modulus = "{E}"
poissons_ratio = 0.3
density = "1200 kg/m^3"
"""
CASES = {
    "dry": STEEL
    + '[interface]\nyield_pressure = "1.4 GPa"\nfriction = 0.3\n'
    + ROUGH
    + GRID.format(nodes=160, spacing="0.2 um")
    + IMPACT
    + "[unloading]\ncurves = 3\n",
    "truncated": STEEL
    + '[interface]\nyield_pressure = "1.4 GPa"\nplasticity = "truncated"\n'
    + ROUGH
    + GRID.format(nodes=160, spacing="0.2 um")
    + IMPACT,
    "growing": STEEL
    + '[interface]\nyield_pressure = "2.8 Y"\n'
    + ROUGH
    + GRID.format(nodes=160, spacing="0.2 um")
    + IMPACT,
    "jkr": SOFT.format(E="50 MPa")
    + '[interface]\nyield_pressure = "elastic"\nwork_of_adhesion = "0.05 J/m^2"\nadhesion = "jkr"\n'
    + GRID.format(nodes=128, spacing="0.25 um")
    + '[indentation]\nvalues = ["0.3 um", "0.6 um"]\n',
    "cohesive": SOFT.format(E="2 GPa")
    + '[interface]\nyield_pressure = "100 MPa"\nwork_of_adhesion = "0.05 J/m^2"\n'
    'adhesion = "cohesive"\nequilibrium_separation = "5 nm"\n'
    + GRID.format(nodes=96, spacing="50 nm")
    + '[indentation]\nvalues = ["20 nm", "50 nm"]\n',
    "ensemble": STEEL
    + '[interface]\nyield_pressure = "1.4 GPa"\n'
    + ROUGH
    + "realisations = 3\n"
    + GRID.format(nodes=128, spacing="0.2 um")
    + IMPACT,
    "periodic": STEEL.replace('"200 um"', '"flat"')
    + '[second]\nradius = "flat"\nyoungs_modulus = "210 GPa"\npoissons_ratio = 0.3\n'
    '[interface]\nyield_pressure = "1.4 GPa"\n'
    + ROUGH.replace("50 nm", "20 nm")
    + GRID.format(nodes=96, spacing="0.1 um")
    + 'periodic = true\n[pressure]\nvalues = ["20 MPa", "200 MPa"]\n',
}

STUDY = CASES["dry"].split("[unloading]")[0] + '\n[sweep]\n"roughness.rms" = ["20 nm", "50 nm"]\n'
MIXTURE = """
[materials.steel]
material = "steel"
radius = ["100 um", "200 um"]

[walls.drum]
material = "aluminium"

[impact]
from = "0.05 m/s"
to = "0.5 m/s"
steps = 4

[grid]
nodes = 96
spacing = "0.5 um"
refine = 1
"""
MEASURED = "velocity_m_per_s,restitution,restitution_std\n" + "".join(
    f"{V},{e},0.01\n" for V, e in ((0.05, 0.87), (0.1, 0.8), (0.2, 0.73), (0.4, 0.66))
)
SMOOTH = (
    STEEL + '[interface]\nyield_pressure = "1.4 GPa"\n' + GRID.format(nodes=96, spacing="0.4 um")
)
OBLIQUE = CASES["dry"].replace("[impact]", '[impact]\nangle = ["20 deg", "50 deg"]')


def rows(folder: Path, name: str = "curve.csv") -> list[dict[str, str]]:
    with open(folder / name, newline="") as file:
        return list(csv.DictReader(file))


def table(
    name: str, folder: Path, columns: str, file: str = "curve.csv"
) -> Iterator[tuple[str, str]]:
    """Values of `columns` in the first and last row."""
    stored = rows(folder, file)
    for column in columns.split():
        yield f"{name}: {column}, first", stored[0][column]
        yield f"{name}: {column}, last", stored[-1][column]


def numbers(call: Callable[..., str], at: Path) -> Iterator[tuple[str, str]]:
    """All numbers, from runs in the folder `at`."""
    for name, text in CASES.items():
        (at / f"{name}.toml").write_text(text)
        call("run", f"{name}.toml", "-o", name)
    yield from table(
        "dry", at / "dry", "restitution total_error force_N loading_work_J model_error"
    )
    for name in ("truncated", "growing"):
        yield from table(name, at / name, "restitution total_error force_N")
    yield from table("jkr", at / "jkr", "restitution pull_off_force_N force_N stored_energy_J")
    yield from table(
        "cohesive", at / "cohesive", "restitution pull_off_force_N pull_off_error_N force_N"
    )
    yield from table("ensemble", at / "ensemble", "restitution total_error")
    yield from table("periodic", at / "periodic", "mean_gap_m stored_energy_J", "periodic.csv")
    (at / "oblique.toml").write_text(OBLIQUE)
    call("run", "oblique.toml", "-o", "oblique")
    yield from table(
        "oblique", at / "oblique", "tangential_restitution rebound_angle_rad", "oblique.csv"
    )
    call("converge", "truncated.toml", "-o", "convergence", "--grids", "2")
    yield from table("convergence", at / "convergence", "restitution discretisation_error")
    call("fit-law", "dry", "-o", "law")
    law = json.loads((at / "law" / "law.json").read_text())
    for fit in law["laws"]:
        yield f"law: {fit['name']}, rms", repr(fit["rms"])
    call("export", "law", "--to", "lammps", "-o", "lammps", "--velocity", "0.1 m/s")
    text = "".join(file.read_text() for file in sorted((at / "lammps").iterdir()))
    damping = re.findall(r"pair_coeff .*", text)[0]
    yield "export: pair_coeff of LAMMPS", damping
    (at / "study.toml").write_text(STUDY)
    call("study", "study.toml", "-o", "study", "--workers", "1")
    yield from table("study", at / "study", "restitution total_error", "table.csv")
    (at / "mixture.toml").write_text(MIXTURE)
    call("mixture", "mixture.toml", "-o", "mixture", "--workers", "1")
    for path in sorted((at / "mixture").rglob("law.json"))[:3]:
        points = json.loads(path.read_text())["points"]
        yield (
            f"mixture: {path.parent.name}, e at the highest velocity",
            repr(points[-1]["restitution"]),
        )
    (at / "fit.toml").write_text(SMOOTH + IMPACT)
    (at / "measured.csv").write_text(MEASURED)
    call("fit", "measured.csv", "--case", "fit.toml", "--free", "yield_pressure", "-o", "fit")
    fitted = json.loads((at / "fit" / "fit.json").read_text())
    (key,) = (
        fitted["parameters"][:1]
        if isinstance(fitted["parameters"], list)
        else [fitted["parameters"]]
    )
    yield "fit: yield pressure and interval", json.dumps(key)
    call("reproduce", "--quick", "--workers", "1", "-o", "paper")
    for path in sorted((at / "paper").rglob("table.csv")):
        name = f"reproduce: {path.parent.relative_to(at / 'paper')}, restitution, last"
        yield name, rows(path.parent, path.name)[-1]["restitution"]


def main(python: str) -> None:
    with tempfile.TemporaryDirectory() as folder:

        def call(*arguments: str) -> str:
            done = subprocess.run(
                [python, "-m", "restitution", *arguments],
                cwd=folder,
                capture_output=True,
                text=True,
            )
            if done.returncode:
                raise SystemExit(f"{arguments}: {done.stdout}{done.stderr}")
            return done.stdout

        for name, value in numbers(call, Path(folder)):
            print(f"{name};{value}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
