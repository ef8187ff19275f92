"""Calibration: find parameters of a case from measured restitution, the inverse of a run."""
