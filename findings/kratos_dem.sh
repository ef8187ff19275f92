#!/bin/sh
# Kratos DEM 10.4: two spheres of 1 mm (E 70 GPa, ν 0.25) meet at 1 m/s with e = 1, by Hertz, with
# 100 time steps per contact.
# A good guess: they rebound at 1 m/s with the default settings.
# Seen: with the default NeighbourSearchFrequency (50 steps) the contact begins too late, and they
# rebound at 1.65 m/s, with no warning; with 1 they rebound at 1.000 m/s.
# Exits with a status other than 0 if this changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/v"
"$folder/v/bin/pip" -q install KratosMultiphysics==10.4 KratosDEMApplication==10.4 2>/dev/null
cd "$folder"
cat > run.py <<'P'
import json, sys
from importlib.metadata import version
from pathlib import Path
import KratosMultiphysics as Kratos
from KratosMultiphysics.DEMApplication.DEM_analysis_stage import DEMAnalysisStage

step = 5.98e-8
Path("cDEM.mdpa").write_text(f"""Begin Properties 0
End Properties
Begin Nodes
1 0 0 {1e-3 + 5.3 * step:.15g}
2 0 0 -1e-3
End Nodes
Begin Elements SphericParticle3D
1 0 1
2 0 2
End Elements
Begin NodalData RADIUS
1 0 1e-3
2 0 1e-3
End NodalData
""")
contact = {"COEFFICIENT_OF_RESTITUTION": 1.0, "STATIC_FRICTION": 0.3, "DYNAMIC_FRICTION": 0.3,
           "FRICTION_DECAY": 500.0, "ROLLING_FRICTION": 0.0, "ROLLING_FRICTION_WITH_WALLS": 0.0,
           "DEM_DISCONTINUUM_CONSTITUTIVE_LAW_NAME": "DEM_D_Hertz_viscous_Coulomb",
           "DEM_ROLLING_FRICTION_MODEL_NAME": "DEMRollingFrictionModelConstantTorque"}
material = {"PARTICLE_DENSITY": 2500.0, "YOUNG_MODULUS": 70e9, "POISSON_RATIO": 0.25}
Path("MaterialsDEM.json").write_text(json.dumps({
    "materials": [{"material_name": "m", "material_id": 1, "Variables": material}],
    "material_relations": [{"material_names_list": ["m", "m"], "material_ids_list": [1, 1],
                            "Variables": contact}],
    "material_assignation_table": [["SpheresPart", "m"]]}))
settings = {"problem_name": "c", "do_print_results_option": False, "post_gid_option": False,
            "dem_inlet_option": False, "GravityZ": 0.0, "MaxTimeStep": step, "FinalTime": 400 * step,
            "solver_settings": {"strategy": "sphere_strategy"}}
if sys.argv[1:]:
    settings["NeighbourSearchFrequency"] = int(sys.argv[1])


class Stage(DEMAnalysisStage):
    def Initialize(self):
        super().Initialize()
        for node in self.spheres_model_part.Nodes:
            node.SetSolutionStepValue(Kratos.VELOCITY_Z, -1.0 if node.Id == 1 else 0.0)


model = Kratos.Model()
stage = Stage(model, Kratos.Parameters(json.dumps(settings)))
stage.Initialize()
stage.RunSolutionLoop()
v = [node.GetSolutionStepValue(Kratos.VELOCITY_Z) for node in model["SpheresPart"].Nodes]
print("RESULT", version("KratosDEMApplication"), v[0] - v[1])
P
result() {
    OMP_NUM_THREADS=1 v/bin/python run.py "$@" > log 2>&1
    sed -n 's/^RESULT //p' log
}
default=$(result)
every=$(result 1)
echo "KratosDEMApplication, rebound in m/s, expected 1"
echo "default settings:     $default"
echo "search at every step: $every"
python3 - "$default" "$every" <<'P'
import sys
default, every = (float(text.split()[1]) for text in sys.argv[1:])
sys.exit(not (abs(default - 1.65) < 0.01 and abs(every - 1) < 1e-3))
P
