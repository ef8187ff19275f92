"""The impacts of Kharaz, Gorham and Salman (2001) in LAMMPS, LIGGGHTS and YADE, beside the law.

Alumina spheres of 5 mm on a glass wall at 3.9 m/s (`oblique.py`), with a normal restitution of 1
and the E* and G* of the pair. All angles are run in one simulation of each contact model: spheres
that do not touch each other hit one wall. Writes oblique_codes.csv for the codes that are
installed.
"""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from evidence.oblique.oblique import FRICTION, PAIR, REBOUND, SPIN, TANGENTIAL, VELOCITY, elastic
from evidence.shared import write_table
from restitution.dem.pair import STIFFNESS_SHARE
from restitution.impacts.oblique import collide_obliquely
from restitution.theory import Hertz

ANGLES = sorted({*TANGENTIAL, *SPIN, *REBOUND})
RADIUS, DENSITY = PAIR.first.radius, PAIR.first.density
# Young's modulus and Poisson's ratio of two like bodies with the E* and G* of the pair.
_SHARE = 0.25 * PAIR.tangential_modulus / PAIR.contact_modulus
NU = (1 - 4 * _SHARE) / (1 - 2 * _SHARE)
E = 2 * (1 - NU**2) * PAIR.contact_modulus
CONTACT = (
    2
    * 1.4716
    * float(
        Hertz(PAIR.radius, PAIR.contact_modulus).indentation_from_energy(
            0.5 * PAIR.mass * VELOCITY**2
        )
    )
    / VELOCITY
)
STEP = CONTACT / 4000
STEPS = 8000  # time steps; the contact at the lowest normal velocity takes 1.15 times as long
LAMMPS = {
    "mindlin": "mindlin NULL",
    "mindlin_rescale": "mindlin_rescale NULL",
    "mindlin/force": "mindlin/force NULL",
    "mindlin_rescale/force": "mindlin_rescale/force NULL",
    "mindlin_rescale/force, 0.8": (
        f"mindlin_rescale/force {STIFFNESS_SHARE * 2 * PAIR.tangential_modulus}"
    ),
}
# Variables for programs of Debian, which need Debian's Python and MPI.
CLEAN = {
    "PATH": "/usr/bin:/bin",
    "LANG": "C.UTF-8",
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
}
Result = dict[float, tuple[float, float, float]]  # angle: v_t, v_n, spin after the impact


def spheres() -> list[tuple[float, float, float, float]]:
    """Place x, height z and velocities of the sphere of each angle."""
    return [
        (
            4 * RADIUS * k,
            RADIUS * (1 + 1e-9),
            VELOCITY * math.sin(math.radians(angle)),
            -VELOCITY * math.cos(math.radians(angle)),
        )
        for k, angle in enumerate(ANGLES, 1)
    ]


def run(command: list[str], text: str, name: str) -> tuple[str, str]:
    """The version line and the whole output of a program; empty if it is not installed."""
    environment = dict(os.environ) if command[0] == "lmp" else CLEAN
    if command[0] == "lmp":
        environment["LD_LIBRARY_PATH"] = str(Path(sys.executable).parents[1] / "lib")
    if shutil.which(command[0], path=environment["PATH"]) is None:
        return "", ""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / name).write_text(text)
        done = subprocess.run(
            command,
            cwd=folder,
            env={**environment, "HOME": folder},
            capture_output=True,
            text=True,
            check=False,
        )
        dumped = Path(folder) / "end.txt"
        said = done.stdout + done.stderr
        if not dumped.exists():
            raise SystemExit(said[-3000:])
        version = re.search(
            r"LAMMPS \(([^)]*)\)|LIGGGHTS-PUBLIC ([^,]*),|Welcome to Yade (\S+)", said
        )
        return (next(filter(None, version.groups())) if version else ""), dumped.read_text()


def numbers(text: str) -> Result:
    """Read the rows `id v_t v_n spin` of the last state."""
    lines = (line.strip() for line in text.splitlines())
    rows = [line.split() for line in lines if re.fullmatch(r"\d+( \S+){3}", line)]
    return {ANGLES[int(k) - 1]: tuple(map(float, values)) for k, *values in rows}


def lammps_text(model: str) -> str:
    """Input of LAMMPS with a tangential model."""
    lines = [
        "units si", "atom_style sphere", "atom_modify map array", "boundary f f f",
        "comm_modify vel yes", "newton off",
        f"region box block 0 {4 * RADIUS * (len(ANGLES) + 1)} {-4 * RADIUS} {4 * RADIUS} 0"
        f" {4 * RADIUS} units box",
        "create_box 1 box", "pair_style granular",
        f"variable model string 'hertz/material {E} 1.0 {NU} tangential {model} 1.0 {FRICTION}"
        " damping coeff_restitution'",
        "pair_coeff * * ${model}", "fix wall all wall/gran granular ${model} zplane 0.0 NULL",
        "fix move all nve/sphere", f"timestep {STEP}",
    ]  # fmt: skip
    for k, (x, z, v_t, v_n) in enumerate(spheres(), 1):
        lines += [
            f"create_atoms 1 single {x} 0 {z} units box",
            f"set atom {k} diameter {2 * RADIUS} density {DENSITY} vx {v_t} vz {v_n}",
        ]
    dump = "write_dump all custom end.txt id vx vz omegay modify format line '%d %.9g %.9g %.9g'"
    return "\n".join([*lines, "thermo 100000", f"run {STEPS}", dump]) + "\n"


def liggghts_text(model: str) -> str:
    """Input of LIGGGHTS with a tangential model."""
    lines = [
        "units si", "atom_style granular", "atom_modify map array", "boundary f f f",
        "communicate single vel yes", "newton off", "hard_particles yes",
        f"region box block 0 {4 * RADIUS * (len(ANGLES) + 1)} {-4 * RADIUS} {4 * RADIUS} {-RADIUS}"
        f" {4 * RADIUS} units box",
        "create_box 1 box", f"neighbor {0.1 * RADIUS} bin", "neigh_modify delay 0",
        f"fix m1 all property/global youngsModulus peratomtype {E}",
        f"fix m2 all property/global poissonsRatio peratomtype {NU}",
        "fix m3 all property/global coefficientRestitution peratomtypepair 1 1.0",
        f"fix m4 all property/global coefficientFriction peratomtypepair 1 {FRICTION}",
        f"pair_style gran model hertz tangential {model}", "pair_coeff * *",
        f"fix wall all wall/gran model hertz tangential {model} primitive type 1 zplane 0.0",
        "fix move all nve/sphere", f"timestep {STEP}",
    ]  # fmt: skip
    for k, (x, z, v_t, v_n) in enumerate(spheres(), 1):
        lines += [
            f"create_atoms 1 single {x} 0 {z} units box",
            f"set atom {k} diameter {2 * RADIUS} density {DENSITY}",
            f"group one_{k} id {k}",
            f"velocity one_{k} set {v_t} 0 {v_n} units box",
        ]
    dump = "dump last all custom 1 end.txt id vx vz omegay"
    form = 'dump_modify last format "%d %.9g %.9g %.9g"'
    return "\n".join([*lines, "thermo 100000", f"run {STEPS}", dump, form, "run 0", ""])


def yade_text(share: float) -> str:
    """Script of YADE with MindlinPhys and a `share` of its tangential stiffness."""
    return f"""
from math import atan
from yade import utils
material = O.materials.append(FrictMat(young={E}, poisson={NU}, density={DENSITY},
                                       frictionAngle=atan({FRICTION})))
O.bodies.append(utils.wall(0.0, axis=2, material=material))
for x, z, v_t, v_n in {spheres()}:
    b = O.bodies.append(utils.sphere((x, 0, z), {RADIUS}, material=material))
    O.bodies[b].state.vel = (v_t, 0, v_n)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_MindlinPhys()],
        [Law2_ScGeom_MindlinPhys_Mindlin()],
    ),
    PyRunner(iterPeriod=1, initRun=True, command="soften()"),
    NewtonIntegrator(damping=0, gravity=(0, 0, 0)),
]
def soften():
    for contact in O.interactions:
        if contact.isReal and contact.iterMadeReal == O.iter:
            contact.phys.kso *= {share}


O.dt = {STEP}
O.run(int({STEPS} * 1.5), True)  # contacts with a wall are softer in YADE
with open("end.txt", "w") as file:
    for k, b in enumerate((O.bodies[i] for i in range(1, len(O.bodies))), 1):
        file.write("%d %.9g %.9g %.9g\\n" % (k, b.state.vel[0], b.state.vel[2], b.state.angVel[1]))
"""


def results() -> dict[str, Result]:
    """The results of the law and of every model that can be run, by name."""
    law = elastic()
    found = {}
    for angle in ANGLES:
        one = collide_obliquely(law, VELOCITY, math.radians(angle), FRICTION)
        V_t, V_n = (VELOCITY * f(math.radians(angle)) for f in (math.sin, math.cos))
        v_t, v_n = one.tangential_restitution * V_t, one.normal_restitution * V_n
        found[angle] = (v_t, v_n, one.spins[0])
    every = {"law": found}
    for name, model in LAMMPS.items():
        version, text = run(["lmp", "-in", "in.txt", "-log", "none"], lammps_text(model), "in.txt")
        if text:
            every[f"LAMMPS {version.split(' - ')[0].replace(' ', '')} {name}"] = numbers(text)
    for model in ("history",):
        command = ["liggghts", "-in", "in.txt", "-log", "none"]
        version, text = run(command, liggghts_text(model), "in.txt")
        if text:
            every[f"LIGGGHTS {version} {model}"] = numbers(text)
    for name, share in (("Mindlin", 1.0), ("Mindlin, 0.8", STIFFNESS_SHARE)):
        version, text = run(["yade", "-n", "-x", "-j1", "in.py"], yade_text(share), "in.py")
        if text:
            every[f"YADE {version} {name}"] = numbers(text)
    return every


def main() -> None:
    """Write oblique_codes.csv, and print e_t at the measured angles."""
    every, rows = results(), []
    for name, found in every.items():
        for angle, (v_t, v_n, spin) in found.items():
            V_t, V_n = (VELOCITY * f(math.radians(angle)) for f in (math.sin, math.cos))
            rows.append(
                {
                    "code": name,
                    "angle_deg": angle,
                    "normal_restitution": f"{v_n / V_n:.5f}",
                    "tangential_restitution": f"{v_t / V_t:.5f}",
                    "spin_rad_per_s": f"{spin:.3f}",
                    "rebound_angle_deg": f"{math.degrees(math.atan2(v_t, v_n)):.4f}",
                }
            )
    write_table("oblique/oblique_codes.csv", rows)
    print("| angle (deg) | measured | " + " | ".join(every) + " |")
    for angle, measured in TANGENTIAL.items():
        V_t = VELOCITY * math.sin(math.radians(angle))
        values = " | ".join(f"{found[angle][0] / V_t:.4f}" for found in every.values())
        print(f"| {angle:.4g} | {measured:.4f} | {values} |")


if __name__ == "__main__":
    main()
