"""Force and e of two spheres in ESyS-Particle as packaged in Debian 12 (apt install esys-particle).

    python3 evidence/codes/in_esys.py

Two spheres of 1 m and 1 kg; the force at an overlap of 1 cm over Hertz's, and e at 1 m/s.
"""

import math
import os
import subprocess
import sys
import tempfile

VERSION = "2.3.5+dfsg2-6+b1"
E, NU, OVERLAP, R, V = 1e6, 0.25, 0.01, 0.5, 1.0
LAWS = {
    "HertzianElasticPrms": 'HertzianElasticPrms(name="law", E=E, nu=NU)',
    "HertzianViscoElasticPrms": 'HertzianViscoElasticPrms(name="law", A=A, E=E, nu=NU)',
    "HertzianViscoElasticFrictionPrms": (
        'HertzianViscoElasticFrictionPrms(name="law", A=A, E=E, nu=NU, dynamicMu=0.0, shearK=0.0)'
    ),
    "HertzMindlinPrms": (
        'HertzMindlinPrms(name="law", youngsModulus=E, poissonsRatio=NU, dynamicMu=0.0)'
    ),
    "HertzMindlinViscoPrms": (
        'HertzMindlinViscoPrms(name="law", youngsModulus=E, poissonsRatio=NU, dynamicMu=0.0, '
        "restitution=A)"
    ),
}
RUN = """
from esys.lsm import *
from esys.lsm.util import *
E, NU, A = {E!r}, {NU!r}, {A!r}
run = LsmMpi(numWorkerProcesses=1, mpiDimList=[1, 1, 1])
run.initNeighbourSearch(particleType="RotSphere", gridSpacing=5.0, verletDist=0.2)
run.setTimeStepSize({step!r})
run.setSpatialDomain(BoundingBox(Vec3(-20, -20, -20), Vec3(20, 20, 20)))
for k, (x, v) in enumerate((({gap!r} - 2.0, {V!r}), (0.0, 0.0))):
    sphere = RotSphere(id=k, posn=Vec3(x, 0, 0), radius=1.0, mass=1.0)
    sphere.setLinearVelocity(Vec3(v, 0, 0))
    run.createParticle(sphere)
run.createInteractionGroup({law})
run.setNumTimeSteps({steps})
for k in range({steps}):
    run.runTimeStep()
one, two = (sphere.getLinearVelocity().toList()[0] for sphere in run.getParticleList())
print("RESULT", one - two)
run.exit()
"""


def velocity(law, gap, V, step, steps, A=0.0):
    """The difference of the velocities after `steps`, from the start with V and the `gap`."""
    with tempfile.TemporaryDirectory() as place:
        text = RUN.format(E=E, NU=NU, A=A, gap=gap, V=V, step=step, steps=steps, law=LAWS[law])
        with open(f"{place}/run.py", "w") as file:
            file.write(text)
        root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        done = subprocess.run(
            ["mpirun", "--oversubscribe", "-np", "2", "/usr/bin/esysparticle", "run.py"],
            cwd=place,
            env={"PATH": "/usr/bin:/bin", "HOME": place} | root,
            capture_output=True,
            text=True,
            timeout=120,
        )
    said = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("RESULT")]
    return float(said[0]) if said else math.nan


installed = subprocess.run(
    ["dpkg-query", "-W", "-f", "${Version}", "esys-particle"], capture_output=True, text=True
).stdout
if installed != VERSION:
    sys.exit(f"esys-particle {VERSION} is needed, not {installed or 'none'}")
os.environ.clear()
print("RESULT esys-particle", installed)
modulus = E / (2 * (1 - NU**2))
hertz = 4 / 3 * modulus * math.sqrt(R) * OVERLAP**1.5
contact = 2.87 * (0.5**2 / (R * modulus**2 * V)) ** 0.2
step = 1e-3 * contact
for law in LAWS:
    A = 1.0 if law == "HertzMindlinViscoPrms" else 0.0
    # Both bodies of 1 kg move apart: the rate of the difference of velocities is twice the force.
    change = velocity(law, OVERLAP, 0.0, step, 1, A) or velocity(law, OVERLAP, 0.0, step, 2, A)
    print(f"RESULT {law}: force over Hertz's {abs(change) / (2 * step * hertz):.4f}", flush=True)
for e in (1.0, 0.8, 0.5, 0.2):
    back = [
        -velocity("HertzMindlinViscoPrms", -5.3 * V * contact / n, V, contact / n, 4 * n, e)
        for n in (100, 20)
    ]
    said = ", ".join(f"{x / V:.4f}" for x in back)
    print(f"RESULT HertzMindlinViscoPrms, {e}: {said} with 100 and 20 steps", flush=True)
