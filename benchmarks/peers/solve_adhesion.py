"""Load a rough sphere in steps with the package Adhesion; `solve_adhesion.py INPUT.npz`.

Prints a line of JSON per step. Lengths are in nm, forces in nN.
"""

import json
import sys
import time

import numpy as np
from Adhesion.Interactions.VdW82 import Lj82
from Adhesion.System.Systems import SmoothContactSystem
from ContactMechanics import FreeFFTElasticHalfSpace
from SurfaceTopography import Topography

given = dict(np.load(sys.argv[1]))
spacing, z0 = (float(given[name]) * 1e9 for name in ("spacing", "separation"))
size = tuple(n * spacing for n in given["gap"].shape)
half_space = FreeFFTElasticHalfSpace(given["gap"].shape, float(given["modulus"]) * 1e-9, size)
law = Lj82(float(given["work"]), z0)
system = SmoothContactSystem(half_space, law, Topography(-given["gap"] * 1e9, size))
nx, ny = given["gap"].shape
displacement = None
for depth in given["depths"] * 1e9:
    began = time.process_time()
    result = system.minimize_proxy(
        offset=depth - z0,
        initial_displacements=displacement,
        options={"ftol": 0.0, "gtol": float(given["tolerance"]), "maxiter": 10**5, "maxfun": 10**5},
    )
    seconds = time.process_time() - began
    displacement = system.disp.copy()
    _, slope, curvature = law.evaluate(system.gap, False, True, True)
    off = np.abs(system.force[:nx, :ny]) / spacing**2
    compliance = float(given["diagonal"]) * 1e18
    residual = float((off / (np.abs(curvature) + 1 / compliance)).max())
    row = {
        "depth": depth,
        "seconds": seconds,
        "energy": float(system.energy),
        "force": float(system.compute_normal_force()),
        "evaluations": int(result.nfev),
        "residual": residual / z0,
    }
    print(json.dumps(row), flush=True)
