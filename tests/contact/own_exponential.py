"""An adhesion law in one file: the universal binding curve (Rose, Smith and Ferrante 1983)."""

from dataclasses import dataclass

import numpy as np

import restitution as rs


@dataclass(frozen=True)
class Exponential(rs.CohesiveLaw):
    """The energy −w (1 + s) exp(−s) with s = (g − z₀)/d, of the range d (m)."""

    work_of_adhesion: float
    equilibrium_separation: float
    reach: float

    label = "exponential"

    @property
    def gap_of_largest_traction(self):
        return self.equilibrium_separation + self.reach

    def _scaled(self, gap):
        return (np.asarray(gap) - self.equilibrium_separation) / self.reach

    def energy(self, gap):
        s = self._scaled(gap)
        return -self.work_of_adhesion * (1 + s) * np.exp(-s)

    def traction(self, gap):
        s = self._scaled(gap)
        return self.work_of_adhesion / self.reach * s * np.exp(-s)

    def stiffness(self, gap):
        s = self._scaled(gap)
        return self.work_of_adhesion / self.reach**2 * (1 - s) * np.exp(-s)
