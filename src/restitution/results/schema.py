"""Files of stored results, and the columns of their tables."""

from __future__ import annotations

from restitution.curve.oblique import MeanObliquePoint, ObliquePoint
from restitution.curve.point import MeanPoint, Point

COLUMNS = Point.columns()
ALL_COLUMNS = MeanPoint.columns()
OBLIQUE_COLUMNS = ObliquePoint.columns()
ALL_OBLIQUE_COLUMNS = MeanObliquePoint.columns()
PERIODIC_FILE = "periodic.csv"  # the curve of a periodic contact, instead of curve.csv
OBLIQUE_FILE = "oblique.csv"
UNLOADING_COLUMNS = ("max_indentation_m", "indentation_m", "force_N")
STATUS = ("complete", "failed", "missing")  # possible states of a case in the table of a study
LOCK = ".restitution-lock"  # name of the lock file, held by the process that writes to a folder
