#!/bin/sh
# Containers of contact.engineering: the `height_scale` of a measurement whose file has its own scale.
# contact.engineering stores there the scale that it found in the file.
# A good guess: heights of 100 counts of 0.5 nm are read as 50 nm, from the file as from the container.
# Exits with a status other than 0 if the reader changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/v"
"$folder/v/bin/pip" -q install "SurfaceTopography==1.27.1" 2>/dev/null
cd "$folder"
"$folder/v/bin/python" -W ignore - <<'P'
import sys, zipfile
import numpy as np
import SurfaceTopography as st
from SurfaceTopography.Container.IO import read_container

print("SurfaceTopography", st.__version__)
# SDF (ISO 25178-71) in text: 4 x 3 points of 1 um, counts from 0 to 100, Zscale 0.5 nm.
head = ["aISO-1.0", "ManufacID = test", "CreateDate = 010120260000", "ModDate = 010120260000",
        "NumPoints = 4", "NumProfiles = 3", "Xscale = 1e-6", "Yscale = 1e-6", "Zscale = 5e-10",
        "Zresolution = -1", "Compression = 0", "DataType = 6", "CheckType = 0", "*"]
rows = ["0 10 20 30", "40 50 60 70", "80 90 95 100", "*"]
open("a.sdf", "w").write("\n".join(head + rows) + "\n")
channel = st.IO.open_topography("a.sdf")
alone = np.ptp(channel.topography().to_unit("nm").heights())
scale = channel.channels[0].height_scale_factor
meta = f"""surfaces:
- name: one
  topographies:
  - name: a.sdf
    data_source: 0
    datafile: {{original: a.sdf}}
    height_scale: {scale}
    size: [4.0e-6, 3.0e-6]
    unit: m
"""
with zipfile.ZipFile("a.zip", "w") as packed:
    packed.writestr("meta.yml", meta)
    packed.write("a.sdf")
(surface,) = read_container("a.zip")
inside = np.ptp(next(iter(surface)).to_unit("nm").heights())
print("own scale %g m; expected 50 nm, read as %g nm from the file, %g nm from the container"
      % (scale, alone, inside))
sys.exit(0 if abs(alone - 50) < 1e-9 and abs(inside / (50 * scale) - 1) < 1e-9 else 1)
P
