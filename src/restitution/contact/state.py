"""One state of a contact: what a solve returns and the next step starts from.

Nothing here changes after it is made. Fields hold what was solved for; force, area, energies and
maps are properties of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact

Array = NDArray[np.float64]
Box = tuple[slice, slice]


@dataclass(frozen=True)
class State:
    """A contact in equilibrium at one indentation.

    `pressure` (Pa) and `plastic_displacement` (m, the surface is left lower by it) have the shape
    of the grid. `box` is the part of the grid that was solved on; pressure is zero outside it, and
    `box_displacement` (m) is the elastic displacement inside it. `plastic_work` (J) is what
    yielding has dissipated so far, known within `plastic_work_error`. `residual` is the largest
    violation of the contact conditions over the indentation, `convolutions` what the solve cost.
    """

    contact: Contact
    indentation: float
    pressure: Array
    plastic_displacement: Array
    box: Box
    box_displacement: Array
    plastic_work: float
    adhesive_work: float
    work_error: float
    residual: float
    convolutions: int
    pulled_force: float | None = None
    virgin: bool = True

    @property
    def force(self) -> float:
        """Normal force F = Σ p hx hy, N."""
        return float(self.pressure[self.box].sum()) * self.contact.grid.cell_area

    @property
    def contact_nodes(self) -> int:
        """Number of nodes that carry pressure."""
        return int(np.count_nonzero(self.pressure[self.box]))

    @property
    def contact_area(self) -> float:
        """Real contact area, nodes in contact times hx hy, m²."""
        return self.contact_nodes * self.contact.grid.cell_area

    @property
    def stored_energy(self) -> float:
        """Elastic energy E_el = ½ Σ p u hx hy, J."""
        p = self.pressure[self.box]
        return (
            0.5
            * float(np.einsum("ij,ij->", p, self.box_displacement))
            * self.contact.grid.cell_area
        )

    @property
    def plastic_volume(self) -> float:
        """Volume V_p = Σ u_p hx hy by which yielding has lowered the surface, m³."""
        return float(self.plastic_displacement.sum()) * self.contact.grid.cell_area

    @property
    def loading_work(self) -> float:
        """Work done on the bodies so far, W = E_el + plastic work, J."""
        return self.stored_energy + self.plastic_work - self.adhesive_work

    @property
    def separation_indentation(self) -> float:
        """Indentation at which the bodies part on unloading: min(h₀ + u_p), m (no adhesion)."""
        return float((self.contact.gap + self.plastic_displacement).min())

    def patch_sizes(self) -> NDArray[np.int64]:
        """Nodes in each contact patch (nodes joined by an edge), largest first."""
        from scipy.ndimage import label

        labels, count = label(self.pressure[self.box] != 0)
        sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
        return np.sort(sizes)[::-1]
