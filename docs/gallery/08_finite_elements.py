"""
Validation against finite elements
==================================

This figure compares COR of three models of plasticity with COR of two reference computations:
axisymmetric finite elements (smooth spheres and spheres with waves), and a rough contact in 3D. The
data are from ``evidence/plasticity_models``. If a yield strength is given, the program uses the
model ``expanding-cavity``.
"""

import csv
from collections import defaultdict
from pathlib import Path

import matplotlib.pyplot as plt


def table():
    """The rows of models.csv, in the current folder or a folder above it."""
    here = Path.cwd().resolve()
    root = next(folder for folder in (here, *here.parents) if (folder / "evidence").is_dir())
    with open(root / "evidence" / "plasticity_models" / "models.csv") as file:
        return list(csv.DictReader(file))


points = defaultdict(list)
for row in table():
    points[row["model"]].append((float(row["restitution_reference"]), float(row["restitution"])))

fig, ax = plt.subplots(layout="constrained")
for marker, (model, pairs) in zip("^so", sorted(points.items(), reverse=True), strict=True):
    ax.plot(*zip(*pairs, strict=True), marker, ms=4, mfc="none", label=model)
ax.plot([0, 1], [0, 1], "k", lw=0.8, label="equal")
ax.set(xlabel="COR of the reference", ylabel="COR of the model", xlim=(0.3, 1.03), ylim=(0.2, 1.03))
ax.legend()
plt.show()
