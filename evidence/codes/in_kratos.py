# needs KratosMultiphysics==10.4 KratosDEMApplication==10.4
"""e of two spheres (R 1 mm, E 70 GPa, ν 0.25) at 1 m/s in Kratos DEM, by its laws and settings."""

import json
import math
import os
import tempfile
from importlib.metadata import version
from pathlib import Path

import KratosMultiphysics as Kratos
from KratosMultiphysics.DEMApplication.DEM_analysis_stage import DEMAnalysisStage

R, E, NU, DENSITY = 1e-3, 70e9, 0.25, 2500.0
HERTZ = "DEM_D_Hertz_viscous_Coulomb"
MASS = 2 / 3 * math.pi * R**3 * DENSITY
MODULUS = E / (2 * (1 - NU**2))


def rebound(e, V=1.0, steps=100, law=HERTZ, search=1, scheme="Symplectic_Euler", cohesion=0.0):
    os.chdir(tempfile.mkdtemp())
    time = 2.87 * (MASS**2 / (R / 2 * MODULUS**2 * V)) ** 0.2
    step = time / steps
    text = "Begin Properties 0\nEnd Properties\nBegin Nodes\n"
    text += f"1 0 0 {R + 5.3 * V * step:.15g}\n2 0 0 {-R}\nEnd Nodes\n"
    text += "Begin Elements SphericParticle3D\n1 0 1\n2 0 2\nEnd Elements\n"
    text += f"Begin NodalData RADIUS\n1 0 {R}\n2 0 {R}\nEnd NodalData\n"
    Path("cDEM.mdpa").write_text(text)
    material = {"PARTICLE_DENSITY": DENSITY, "YOUNG_MODULUS": E, "POISSON_RATIO": NU}
    contact = {
        "COEFFICIENT_OF_RESTITUTION": e,
        "STATIC_FRICTION": 0.3,
        "DYNAMIC_FRICTION": 0.3,
        "FRICTION_DECAY": 500.0,
        "PARTICLE_COHESION": cohesion,
        "DEM_DISCONTINUUM_CONSTITUTIVE_LAW_NAME": law,
        "DEM_ROLLING_FRICTION_MODEL_NAME": "DEMRollingFrictionModelConstantTorque",
        "ROLLING_FRICTION": 0.0,
        "ROLLING_FRICTION_WITH_WALLS": 0.0,
    }
    relation = {"material_names_list": ["m", "m"], "material_ids_list": [1, 1]}
    Path("MaterialsDEM.json").write_text(json.dumps({
        "materials": [{"material_name": "m", "material_id": 1, "Variables": material}],
        "material_relations": [relation | {"Variables": contact}],
        "material_assignation_table": [["SpheresPart", "m"]],
    }))  # fmt: skip
    parameters = {
        "problem_name": "c",
        "do_print_results_option": False,
        "post_gid_option": False,
        "dem_inlet_option": False,
        "GravityZ": 0.0,
        "solver_settings": {"strategy": "sphere_strategy"},
        "TranslationalIntegrationScheme": scheme,
        "MaxTimeStep": step,
        "FinalTime": 4 * time,
        "NeighbourSearchFrequency": search,
    }

    class Stage(DEMAnalysisStage):
        def Initialize(self):  # noqa: N802, a name of Kratos
            super().Initialize()
            for node in self.spheres_model_part.Nodes:
                node.SetSolutionStepValue(Kratos.VELOCITY_Z, -V if node.Id == 1 else 0.0)

    model = Kratos.Model()
    stage = Stage(model, Kratos.Parameters(json.dumps(parameters)))
    stage.Initialize()
    stage.RunSolutionLoop()
    v = [node.GetSolutionStepValue(Kratos.VELOCITY_Z) for node in model["SpheresPart"].Nodes]
    return (v[0] - v[1]) / V


def say(what, value):
    print(f"RESULT {what}: {value:.4f}", flush=True)


print("RESULT KratosDEMApplication", version("KratosDEMApplication"))
for e in (1.0, 0.5, 0.2):
    say(f"Hertz, e {e}, search at every step", rebound(e))
for e in (1.0, 0.5):
    say(f"Hertz, e {e}, search every 50 steps (the default)", rebound(e, search=50))
for steps in (10, 50):
    say(f"Hertz, e 0.5, {steps} steps per contact", rebound(0.5, steps=steps))
for scheme in ("Forward_Euler", "Taylor_Scheme", "Velocity_Verlet"):
    say(f"Hertz, e 1, {scheme}, 50 steps per contact", rebound(1.0, steps=50, scheme=scheme))
for name in ("DEM_D_Linear_viscous_Coulomb", "DEM_D_Linear_Simple_Coulomb"):
    say(f"{name}, e 0.5", rebound(0.5, law=name))
for w in (0.0, 5.0):
    say(
        f"{HERTZ}_JKR, e 1, 0.02 m/s, PARTICLE_COHESION {w}",
        rebound(1.0, 0.02, law=HERTZ + "_JKR", cohesion=w),
    )
    say(
        f"{HERTZ}_DMT, e 1, 0.02 m/s, PARTICLE_COHESION {w}",
        rebound(1.0, 0.02, law=HERTZ + "_DMT", cohesion=w),
    )
