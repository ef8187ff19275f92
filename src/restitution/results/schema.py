"""Files of stored results, and the columns of their tables."""

from __future__ import annotations

from restitution.curve.columns import Column
from restitution.curve.oblique import MeanObliquePoint, ObliquePoint
from restitution.curve.point import MeanPoint, Point
from restitution.repeated.points import RepeatedImpact, RunInPoint

COLUMNS = Point.columns()
ALL_COLUMNS = MeanPoint.columns()
OBLIQUE_COLUMNS = ObliquePoint.columns()
ALL_OBLIQUE_COLUMNS = MeanObliquePoint.columns()
IMPACT_COLUMNS, RUN_IN_COLUMNS = RepeatedImpact.columns(), RunInPoint.columns()
SEQUENCE = Column("sequence", "sequence", "1", "number of the sequence of impacts, from 1", 1.0)
PERIODIC_FILE = "periodic.csv"  # the curve of a periodic contact, instead of curve.csv
OBLIQUE_FILE = "oblique.csv"
IMPACTS_FILE, COVERAGE_FILE = "impacts.csv", "coverage.csv"  # of repeated impacts
UNLOADING_COLUMNS = ("max_indentation_m", "indentation_m", "force_N")
STATUS = ("complete", "failed", "missing")  # possible states of a case in the table of a study
LOCK = ".restitution-lock"  # name of the lock file, held by the process that writes to a folder
