#!/bin/sh
# Scan readers: lengths in NanoFocus files, and the heights of Wyko text with an integer `Mult`.
# A good guess: a scan of 8 x 9 um is read as 8 x 9 um, and 2 waves of 500 nm as 1 um.
# Exits with a status other than 0 if the readers change.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/v"
"$folder/v/bin/pip" -q install "SurfaceTopography==1.27.1" 2>/dev/null
cd "$folder"
"$folder/v/bin/python" -W ignore - <<'P'
import struct, sys
import numpy as np
import SurfaceTopography as st

print("SurfaceTopography", st.__version__)
# NanoFocus: 16 x 12 pixels of 500 x 750 nm, heights from 2 to 4 um.
head = bytearray(3468)
struct.pack_into("<2d", head, 16, 2.0, 4.0)
struct.pack_into("<2I2d", head, 1368, 16, 12, 500.0, 750.0)
open("a.nms", "wb").write(bytes(head) + np.arange(1, 193, dtype="<u2").tobytes())
read = st.IO.open_topography("a.nms", format="nms").topography().to_unit("um")
print("NanoFocus: expected 8 x 9 um, read as %g x %g um" % tuple(read.physical_sizes))
wide = abs(read.physical_sizes[0] / 8e6 - 1) < 1e-9

# Wyko text: 4 x 3 pixels of 1 um; one line for each x; 2 waves of 500 nm at the highest pixel.
lines = ["Wyko ASCII Data File Format 0\t0\t1", "X Size\t4", "Y Size\t3",
         "Block Name\tType\tLength\tValue", "Wavelength\t7\t4\t500", "Aspect\t7\t4\t1",
         "Pixel_size\t7\t4\t0.001", "Mult\t6\t2\t1", "RAW_DATA\t3\t48",
         "0\t0\t0", "0\t2\t0", "0\t0\t0", "0\t0\t0"]
open("a.asc", "w").write("\n".join(lines) + "\n")
read = st.IO.open_topography("a.asc", format="asc").topography().to_unit("nm")
print("Wyko text: expected 4 x 3 pixels and 1000 nm, read as %d x %d pixels and %g nm"
      % (*read.nb_grid_pts, np.ptp(read.heights())))
waves = read.nb_grid_pts == (3, 4) and abs(np.ptp(read.heights()) - 2.0) < 1e-9
sys.exit(0 if wide and waves else 1)
P
