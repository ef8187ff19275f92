"""A model of plasticity in one file: the bodies are softer outside a hard spot."""

from dataclasses import dataclass

import numpy as np

import restitution as rs


@dataclass(frozen=True)
class SoftOutside(rs.Plasticity):
    """The pressure is at most `hard` (Pa) within `radius` (m) of the origin, else `soft` (Pa)."""

    hard: float
    soft: float
    radius: float

    label = "soft-outside"
    strengths = ("hard", "soft")

    @property
    def hardness(self):
        return self.hard

    def first_yield_pressure(self, pair):
        return self.soft

    def describe(self):
        return f"yields at {self.soft:.3g} Pa around a hard spot"

    def bound(self, contact, indentation, residual):
        r = np.hypot(*np.meshgrid(contact.grid.x, contact.grid.y, indexing="ij"))
        return np.where(r < self.radius, self.hard, self.soft), 0
